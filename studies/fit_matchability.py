"""Fits the default model of P(correct fix) to pairs of dates, and holds it against the port.

fit_matchability.py PILOTAGE --work DIR [--date 2026-11-21] [-o default_model.json]

For each place and size of tile: `pilotage score REFERENCE --evaluate OTHER`, with chips and without; then `pilotage
calibrate`: with each choice of inputs of TERMS, of which the one with the best log score on places left out is taken.
Everything is kept in DIR, and what is there is not done again. PILOTAGE_DATA names the folder of the imagery.
Sentinel-2 places are taken as rasters of 0.6 m/px: what counts is how ground looks in pixels. The anchors, which set
how often fixes succeed and how that differs from place to place, are pairs whose pixels are about as fine as that. The
port takes no part in this: it evaluates."""

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

# Of the twelve places those from which the descriptor was not learned (learn_ground_pattern.py).
COARSE = ("beihai", "cupertino", "hongkong", "mumbai", "pisa", "saclay_e")
FINE = ("levir_test_113_0256", "levir_test_7_0256_0512", "levir_train_36_0512_0512", "levir_train_386_0512_0768",
        "levir_train_412_0512_0768", "CS3", "OO1", "OO3", "OO4", "OO6")
# Pairs of real/, by the name of their place: those of one site and other dates share its level. Pictures of the map and
# of the flight; fixes within so many metres are correct, by what its README says of the truth.
REAL = {"hathaway": (("hathaway/hathaway_1.png", "hathaway/hathaway_2.png", 3),
                     ("hathaway/hathawaynorth_1.png", "hathaway/hathawaynorth_2.png", 3)),
        "mexico4": (("mexico4/mexico4_1.png", "mexico4/mexico4_2.png", 6),),
        "libya": (("libya/libya_1.png", "libya/libya_2.png", 6),),
        "joplin": (("joplin/joplin_1.tif", "joplin/joplin_2.tif", 3),),
        "p3": tuple(("p3/p3_2022-03-30.png", f"p3/p3_{later}.png", 3)
                    for later in ("2022-05-31", "2022-12-14", "2024-02-01"))}
# Inputs of P that are tried, the fewest first; that is taken unless another is better by more than chance (choose_terms).
TERMS = ("map_features:3,fine_contrast:3", "map_features:3", "map_features:3,gray_contrast:3",
         "map_features:3,gray_contrast:0.5", "map_features:3,vote_noise:3,fine_contrast:3")
GSD_M = 0.6
SEARCH_PX = 58  # 35 m
SIZES_PX = {"coarse": (72, 84, 111), "fine": (72, 84, 111, 128), "real": (84, 111, 140), "port": (84, 111, 166, 222)}
MEASURES = {"coarse": "correct_fix", "fine": "correct_fix", "real": "correct_fix",
            "port": "gray_variance,frieden_entropy,uniqueness,degraded,correct_fix"}
TILES = {"coarse": 60, "fine": 80, "real": 60, "port": 600}


def as_raster(picture, path, no_data="none"):
    """A picture without a place as a raster of GSD_M per pixel; `no_data`: the value of what is no ground."""
    if not path.exists():
        source = gdal.Open(str(picture))
        east, north = GSD_M * source.RasterXSize, GSD_M * source.RasterYSize
        bands = [1, 2, 3] if source.RasterCount >= 3 else [1]
        gdal.Translate(str(path), source, outputSRS="EPSG:32633", bandList=bands, noData=no_data,
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


def registered_pair(data, work, name):
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
    if place.startswith(("CS", "OO")):
        return registered_pair(data, work, place)
    if place == "port":
        return data / "port/port_2019-08.tif", data / "port/port_2020-07_registered.tif"
    folder = "sentinel2" if place in COARSE else "highres"
    return tuple(as_raster(data / f"twodate/{folder}/{place}_{date}.png", work / f"{place}_{date}.tif")
                 for date in (1, 2))


def evaluate(options, folder, kind, rasters, size_px, chips, more=()):
    """The folder of an evaluation; `rasters`: of the map and of the flight."""
    folder = folder.with_name(folder.name + f"_{size_px}{'_chips' if chips else ''}")
    if not (folder / "evaluation.json").exists():
        folder.mkdir(exist_ok=True)
        reference, other = rasters
        run(options.pilotage, "score", reference, "--gsd-m", GSD_M, "--tile-size-px", size_px, "--stride-px",
            max(8, size_px // 4), "--search-radius-px", SEARCH_PX, "--measures",
            MEASURES[kind], "--matcher",
            "features_and_chips" if chips else "features", "--evaluate", other, "--evaluate-max-tiles",
            TILES[kind], "--evaluate-resamples", 400 if kind == "port" else 0, *(("--evaluate-chips",) if chips else ()),
            *more, "--table", folder / "tiles.csv", "-o", folder / "scores.tif", "--overwrite", "-q")
    return folder


def registered(other):
    """Corrects the truth where dates disagree; without the ties on shadows the port has fixes that pass for false."""
    return "--second-epoch", other, "--registration-ties-shadows", "follow"


def fits(raster, size_px):
    source = gdal.Open(str(raster))
    return min(source.RasterXSize, source.RasterYSize) >= size_px + 2 * SEARCH_PX


def all_folders(options, work):
    """PLACE=FOLDER of each evaluation that the model is fitted to."""
    for place in COARSE + FINE:
        kind = "coarse" if place in COARSE else "fine"
        rasters = pair(options.data, work, place)
        for size_px in SIZES_PX[kind]:
            if not fits(rasters[0], size_px):
                continue
            for chips in (False, True):
                more = registered(rasters[1]) if kind == "fine" else ()
                yield f"{place}={evaluate(options, work / place, kind, rasters, size_px, chips, more)}"
    for place, pairs in REAL.items():
        for *pictures, tolerance_m in pairs:
            names = [pathlib.Path(picture).stem for picture in pictures]
            rasters = [as_raster(options.data / "real" / picture, work / f"{name}.tif", 0)
                       for name, picture in zip(names, pictures)]
            for size_px in SIZES_PX["real"]:
                for chips in (False, True):
                    folder = evaluate(options, work / "_".join(names), "real", rasters, size_px, chips,
                                      ("--evaluate-tolerance-m", tolerance_m))
                    yield f"{place}={folder}"


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


def calibrated(options, folders, terms, model):
    """What `calibrate` says of the folders with these inputs, as JSON."""
    anchors = ",".join(FINE + tuple(REAL))
    return json.loads(run(options.pilotage, "calibrate", *folders, "--anchors", anchors, "--terms", terms, "--date",
                          options.date, "-o", model, "--overwrite", "--json", "-q", streams="stdout"))


def choose_terms(options, folders):
    """The inputs of both matchers. The log score of each place is that of models fitted without it; what the choice
    itself is worth is the log score of each place with the inputs that are best on all others."""
    scores = {}
    for terms in TERMS:
        said = calibrated(options, folders, terms, options.work / "tried.json")
        wrong = [term["input"] for matcher in said["model"]["matchers"] for term in matcher["terms"]
                 if (term["coefficient"] < 0) != (term["input"] == "vote_noise")]
        if wrong:  # fewer features, less contrast or more noise would make a fix more likely: a trait of these places
            print(f"{terms}: refused, {', '.join(wrong)} point the wrong way", flush=True)
            continue
        for matcher, reliability in said["reliability"].items():
            per_place = {place["place"]: place["log_score"] for place in reliability["places"]}
            scores.setdefault(matcher, {})[terms] = per_place
            numbers = ", ".join(f"{where} AUC {reliability[where]['auc']['value']:.3f}, calibration error "
                                f"{reliability[where]['calibration_error']['value']:.3f}" for where in ("inside", "across"))
            print(f"{matcher}, {terms}: {numbers}, log score across {np.mean(list(per_place.values())):.4f}", flush=True)
    better = []  # than the first, place by place, over both matchers
    allowed = list(scores["features"])
    for terms in allowed:
        gains = np.concatenate([np.array([of[allowed[0]][place] - of[terms][place] for place in of[terms]])
                                for of in scores.values()])
        better.append(gains.mean() / max(gains.std() / np.sqrt(len(gains)), 1e-12) if terms != allowed[0] else 0)
    for matcher, of in scores.items():
        nested = [of[min(of, key=lambda terms: sum(of[terms][p] for p in of[terms] if p != place))][place]
                  for place in of[allowed[0]]]
        print(f"{matcher}: log score across with the inputs chosen on the other places: {np.mean(nested):.4f}")
    chosen = allowed[int(np.argmax(better))] if max(better) > 2 else allowed[0]
    print(f"chosen: {chosen}", flush=True)
    return chosen


def tell_places(said):
    for matcher, reliability in said["reliability"].items():
        for place in reliability["places"]:
            print(f"{matcher}, {place['place']}: {place['correct']} of {place['tiles']} found "
                  f"({place['correct'] / place['tiles']:.2f}), predicted without it {place['p']:.2f} "
                  f"(80 %: {place['p_low']:.2f} … {place['p_high']:.2f})")


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
    terms = choose_terms(options, folders)
    said = calibrated(options, folders, terms, model)
    tell_places(said)
    print(json.dumps({matcher["matcher"]: matcher["level"] for matcher in said["model"]["matchers"]}, indent=1))
    rasters = pair(options.data, options.work, "port")
    for chips in (False, True):
        for size_px in SIZES_PX["port"]:
            tell(evaluate(options, options.work / "port", "port", rasters, size_px, chips,
                          (*registered(rasters[1]), "--model", model)))


if __name__ == "__main__":
    command_line()
