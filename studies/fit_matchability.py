"""Fits the default model of P(correct fix) to pairs of dates, and holds it against the port.

fit_matchability.py PILOTAGE --work DIR [--date 2026-11-21] [-o default_model.json]

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

sys.path.append(str(pathlib.Path(__file__).resolve().parents[1] / "tests/accept"))  # helpers shared with the tests
from acceptance import need_gdal, run  # noqa: E402

gdal = need_gdal()
import numpy as np  # noqa: E402
from osgeo import osr  # noqa: E402

COARSE = ("abudhabi", "beihai", "bercy", "bordeaux", "chongqing", "cupertino", "hongkong", "milano", "mumbai", "norcia",
          "pisa", "saclay_e")
FINE = ("levir_test_113_0256", "levir_test_7_0256_0512", "levir_train_36_0512_0512", "levir_train_386_0512_0768",
        "levir_train_412_0512_0768", "CS3")
GSD_M = 0.6
SEARCH_PX = 58  # 35 m
SIZES_PX = {"coarse": (72, 84, 111), "fine": (72, 84, 97, 111, 128), "port": (84, 111, 166, 222)}
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


def write_gray(gray, path):
    height, width = gray.shape
    raster = gdal.GetDriverByName("GTiff").Create(str(path), width, height, 1, gdal.GDT_Byte)
    place = osr.SpatialReference()
    place.ImportFromEPSG(32633)
    raster.SetProjection(place.ExportToWkt())
    raster.SetGeoTransform((500000, GSD_M, 0, 5000000, 0, -GSD_M))
    raster.GetRasterBand(1).WriteArray(gray)


def cross_season_pair(data, work, name):
    """A pair of pairs/mmim, the second picture brought onto the first by its transform: [x y 1] T, pixels from 1."""
    paths = [work / f"{name}_{date}.tif" for date in (1, 2)]
    if all(path.exists() for path in paths):
        return paths
    with open(data / "pairs/mmim/transform_moving_to_fixed.csv", newline="", encoding="utf-8") as stream:
        row = next(row for row in csv.DictReader(stream) if row["pair"].endswith(name))
    moving_to_fixed = np.array([[float(row[f"t{i}{j}"]) for j in range(3)] for i in range(3)])
    fixed, moving = (gdal.Open(str(data / f"pairs/mmim/{name}{letter}.png")).ReadAsArray().astype(float)
                     for letter in "ab")
    fixed, moving = (picture if picture.ndim == 2 else np.tensordot((0.299, 0.587, 0.114), picture[:3], 1)
                     for picture in (fixed, moving))
    rows, columns = np.indices(fixed.shape)
    at = np.stack([columns + 1, rows + 1, np.ones(fixed.shape)], -1) @ np.linalg.inv(moving_to_fixed)
    x, y = at[..., 0] / at[..., 2] - 1, at[..., 1] / at[..., 2] - 1
    known = (x >= 0) & (y >= 0) & (x < moving.shape[1] - 1) & (y < moving.shape[0] - 1)
    left, top = (np.floor(np.where(known, value, 0)).astype(int) for value in (x, y))
    a, b = np.where(known, x, 0) - left, np.where(known, y, 0) - top
    warped = ((1 - b) * ((1 - a) * moving[top, left] + a * moving[top, left + 1]) +
              b * ((1 - a) * moving[top + 1, left] + a * moving[top + 1, left + 1]))
    # The largest part that both show, by cutting off the worst side.
    box = [0, fixed.shape[0], 0, fixed.shape[1]]
    while not known[box[0]:box[1], box[2]:box[3]].all():
        part = known[box[0]:box[1], box[2]:box[3]]
        worst = int(np.argmin([part[0].mean(), part[-1].mean(), part[:, 0].mean(), part[:, -1].mean()]))
        box[worst] += (1, -1, 1, -1)[worst]
    for picture, path in ((fixed, paths[0]), (warped, paths[1])):
        write_gray(np.rint(picture[box[0]:box[1], box[2]:box[3]]).astype(np.uint8), path)
    return paths


def pair(data, work, place):
    if place.startswith("CS"):
        return cross_season_pair(data, work, place)
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
        register = ("--second-epoch", other) if place == "port" else ()
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


def predicted(folder, matcher):
    """P and outcome of each judged tile of an evaluation, by the formula of docs/methods/matchability.md."""
    with open(folder / "evaluation.json", encoding="utf-8") as stream:
        judged = json.load(stream)
    side_px = round(judged["footprint_m"] / judged["gsd_m"])
    with open(folder / "evaluation.csv", newline="", encoding="utf-8") as stream:
        rows = [row for row in csv.DictReader(stream) if row["outcome"] != "not_covered"]

    def column(name):
        return np.array([float(row[name] or 0) for row in rows])

    def term(name, x):
        of = matcher[name]
        return of["coefficient"] * np.minimum(x - of["mean"], 3 * of["spread"])

    z = (matcher["intercept"] + matcher["area_coefficient"] * 2 * np.log(side_px - 32) +
         term("vote_contrast", np.log((column("map_features") + 2) / (column("vote_noise") + 0.3))) +
         term("gray_contrast", np.log(np.sqrt(np.maximum(column("frieden_deficit"), 0)) + 0.01)))
    p = np.where(column("map_features") < 20, 0, 1 / (1 + np.exp(-z)))
    return p, np.array([row["outcome"] == "correct" for row in rows], float)


def quality(p, y):
    """AUC, Brier skill and calibration error (ten bins of equal count)."""
    order = np.argsort(p, kind="stable")
    ranks = np.empty(len(p))
    ranks[order] = np.arange(1, len(p) + 1)
    right = y.sum()
    auc = (ranks[y > 0].sum() - right * (right + 1) / 2) / max(right * (len(y) - right), 1)
    error = sum(len(part) * abs(p[part].mean() - y[part].mean()) for part in np.array_split(order, 10)) / len(y)
    return auc, 1 - ((p - y)**2).mean() / max(y.mean() * (1 - y.mean()), 1e-9), error


def leave_one_place_out(options, folders):
    """Each coarse place predicted by a model of the other coarse ones."""
    for chips in (False, True):
        of_size = {size_px: ([], []) for size_px in SIZES_PX["coarse"]}
        for place in COARSE:
            others = [entry for entry in folders if entry.endswith("_chips") == chips and
                      entry.split("=")[0] in COARSE and entry.split("=")[0] != place]
            model = options.work / "left_out.json"
            run(options.pilotage, "calibrate", *others, "-o", model, "--overwrite", "-q")
            matcher = json.loads(model.read_text())["matchers"][0]
            for size_px, (ps, ys) in of_size.items():
                folder = options.work / f"{place}_{size_px}{'_chips' if chips else ''}"
                if folder.exists():
                    p, y = predicted(folder, matcher)
                    ps.append(p)
                    ys.append(y)
        for name, parts in [*of_size.items(), ("all", [sum((of_size[size][i] for size in of_size), []) for i in (0, 1)])]:
            p, y = (np.concatenate(part) for part in parts)
            auc, skill, error = quality(p, y)
            print(f"leave one place out, {'chips' if chips else 'features'}, {name} px: {len(y)} tiles, {y.mean():.2f} found, "
                  f"AUC {auc:.3f}, skill {skill:.3f}, calibration error {error:.3f}", flush=True)


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
    folders = list(all_folders(options, options.work))
    print(run(options.pilotage, "calibrate", *folders, "--anchors", ",".join(FINE), "--date",
              options.date, "-o", model, "--overwrite"))
    leave_one_place_out(options, folders)
    for chips in (False, True):
        for size_px in SIZES_PX["port"]:
            tell(evaluate(options, options.work, "port", size_px, chips, ("--model", model)))


if __name__ == "__main__":
    command_line()
