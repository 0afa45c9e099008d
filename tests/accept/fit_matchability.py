"""Fits the default model of P(correct fix) to pairs of dates, and holds it against the port.

fit_matchability.py PILOTAGE [--work DIR] [--date 2026-11-21] [-o default_model.json]

For each place and size of tile: `pilotage score REFERENCE --evaluate OTHER`, with chips and without; then `pilotage
calibrate`. Everything is kept in DIR, and what is there is not done again. PILOTAGE_DATA names the folder of the
imagery. Sentinel-2 places are taken as rasters of 0.6 m/px: what counts is how ground looks in pixels. The anchors,
which set how often fixes succeed, are pairs whose pixels are about as fine as that."""

import argparse
import csv
import json
import os
import pathlib
import sys

from acceptance import need_gdal, run

gdal = need_gdal()

COARSE = ("abudhabi", "beihai", "bercy", "bordeaux", "chongqing", "cupertino", "hongkong", "milano", "mumbai", "norcia",
          "pisa", "saclay_e")
FINE = ("levir_test_113_0256", "levir_test_7_0256_0512", "levir_train_36_0512_0512", "levir_train_386_0512_0768",
        "levir_train_412_0512_0768")
GSD_M = 0.6
SEARCH_PX = 58  # 35 m
SIZES_PX = {"coarse": (72, 84, 111), "fine": (84, 111), "port": (84, 111, 166, 222)}
MEASURES = {"coarse": "correct_fix", "fine": "correct_fix",
            "port": "gray_variance,frieden_entropy,uniqueness,degraded,correct_fix"}
TILES = {"coarse": 60, "fine": 100, "port": 600}


def as_raster(picture, path):
    """A picture without a place as a raster of GSD_M per pixel."""
    if not path.exists():
        source = gdal.Open(str(picture))
        east, north = GSD_M * source.RasterXSize, GSD_M * source.RasterYSize
        bands = [1, 2, 3] if source.RasterCount >= 3 else [1]
        gdal.Translate(str(path), source, outputSRS="EPSG:32633", bandList=bands, noData="none",
                       outputBounds=[500000, 5000000, 500000 + east, 5000000 - north])
    return path


def pair(data, work, place):
    if place == "port":
        return data / "port/port_2019-08.tif", data / "port/port_2020-07_registered.tif"
    folder = "sentinel2" if place in COARSE else "highres"
    return tuple(as_raster(data / f"twodate/{folder}/{place}_{date}.png", work / f"{place}_{date}.tif")
                 for date in (1, 2))


def evaluate(options, work, place, size_px, chips, more=()):
    """The folder of an evaluation."""
    kind = "coarse" if place in COARSE else "fine" if place in FINE else "port"
    folder = work / f"{place}_{size_px}{'_chips' if chips else ''}"
    if not (folder / "evaluation.json").exists():
        folder.mkdir(exist_ok=True)
        reference, other = pair(options.data, work, place)
        register = ("--evaluate-registered",) if place == "port" else ()
        run(options.pilotage, "score", reference, "--gsd-m", GSD_M, "--tile-size-px", size_px, "--stride-px",
            max(8, size_px // 4), "--search-radius-px", SEARCH_PX, "--measures",
            MEASURES[kind], "--matcher",
            "features_and_chips" if chips else "features", "--evaluate", other, "--evaluate-max-tiles",
            TILES[kind], "--evaluate-resamples", 400 if kind == "port" else 0, *(("--evaluate-chips",) if chips else ()),
            *register, *more, "--table", folder / "tiles.csv", "-o", folder / "scores.tif", "--overwrite", "-q")
    return folder


def all_folders(options, work):
    for place in COARSE + FINE:
        for size_px in SIZES_PX["coarse" if place in COARSE else "fine"]:
            source = gdal.Open(str(pair(options.data, work, place)[0]))
            if min(source.RasterXSize, source.RasterYSize) < size_px + 2 * SEARCH_PX:
                continue
            for chips in (False, True):
                yield f"{place}={evaluate(options, work, place, size_px, chips)}"


def tell(folder):
    """One line for each judged predictor of an evaluation."""
    with open(folder / "evaluation.json", encoding="utf-8") as stream:
        judged = json.load(stream)
    rate = judged["correct_fixes"]
    print(f"{folder.name}: correct {rate['count']} of {rate['of']}, false {judged['false_fixes']['count']}")
    for predictor in judged["predictors"]:
        words = [f"{key} {predictor[key]['value']:.3f} ({predictor[key]['low']:.3f} … {predictor[key]['high']:.3f})"
                 for key in ("auc", "brier_skill", "calibration_error") if key in predictor]
        print(f"  {predictor['name']}: " + ", ".join(words))
    sys.stdout.flush()


def command_line():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("pilotage")
    parser.add_argument("--work", type=pathlib.Path, required=True)
    parser.add_argument("--date", default="")
    parser.add_argument("-o", "--output", type=pathlib.Path)
    options = parser.parse_args()
    options.data = pathlib.Path(os.environ["PILOTAGE_DATA"])
    options.work.mkdir(exist_ok=True)
    model = options.output or options.work / "model.json"
    print(run(options.pilotage, "calibrate", *all_folders(options, options.work), "--anchors", ",".join(FINE), "--date",
              options.date, "-o", model, "--overwrite"))
    for chips in (False, True):
        for size_px in SIZES_PX["port"]:
            tell(evaluate(options, options.work, "port", size_px, chips, ("--model", model)))


if __name__ == "__main__":
    command_line()
