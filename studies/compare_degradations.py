"""Which degraded copies tell best where another date is found: AUC of degraded_peak_margin for sets of options.

compare_degradations.py PILOTAGE DATA [--only sentinel2|port]

Date 1 is the map and is scored; the tiles of date 2 are looked for in it by normalised cross-correlation within the
search radius. Found means within 1.5 px (sentinel2, 10 m, tiles of 32 px, search ±48 px) or 6 px (port at 0.6 m, tiles
of 96 and 128 px, search ±64 px) of the truth, which for the port is the median shift of NEIGHBOURS blocks of 114 m
around (registered_truth.py). Prints, for each set: AUC, its interval, that of its difference from the defaults, the
median margin, and the share of tiles with a margin above 0, to set beside the share that is found. Intervals are 2.5
and 97.5 % of a bootstrap over places (sentinel2) or over blocks of 4 × 4 tiles (port)."""

import csv
import pathlib
import sys
import tempfile

import numpy as np

sys.path.append(str(pathlib.Path(__file__).resolve().parents[1] / "tests/accept"))  # helpers shared with the tests
from acceptance import need_gdal, run  # noqa: E402
from estimate_degradation import MIN_VALID, averaged, read_gray, shifts_of_port  # noqa: E402
from registered_truth import NEIGHBOURS, find  # noqa: E402

gdal = need_gdal()

SETS = {
    "defaults": {},
    "texture 0.4": {"texture-redrawn": 0.4},
    "texture 0.8": {"texture-redrawn": 0.8},
    "texture 0.95": {"texture-redrawn": 0.95},
    "texture 0.65, 6 px": {"texture-scale-px": 6},
    "texture 0.95, 6 px": {"texture-redrawn": 0.95, "texture-scale-px": 6},
    "texture 0.95, 12 px": {"texture-redrawn": 0.95, "texture-scale-px": 12},
    "texture 0.75, 8 px": {"texture-redrawn": 0.75, "texture-scale-px": 8},
    "texture 0.65, slope 1": {"texture-slope": 1},
    "texture 0.75, 3 px, slope 1.5": {"texture-redrawn": 0.75, "texture-slope": 1.5},
    "texture 0.95, 4.5 px, slope 1.5": {"texture-redrawn": 0.95, "texture-scale-px": 4.5, "texture-slope": 1.5},
    "gamma 0.5": {"gamma": 0.5},
    "illumination 0.4": {"illumination": 0.4},
    "objects": {"objects-per-mpx": 800, "object-size-px": 12},
    "shadow": {"shadow": 0.5, "shadow-share": 0.1},
    "haze": {"haze": 0.2},
    "water": {"water": 1},
    "parallax": {"parallax-px": 2},
    "all new": {"objects-per-mpx": 800, "object-size-px": 12, "shadow": 0.5, "shadow-share": 0.1, "haze": 0.2,
                "water": 1, "parallax-px": 2},
    "all new, texture 0.95, 6 px": {"objects-per-mpx": 800, "object-size-px": 12, "shadow": 0.5, "shadow-share": 0.1,
                                    "haze": 0.2, "water": 1, "parallax-px": 2, "texture-redrawn": 0.95,
                                    "texture-scale-px": 6},
}


def auc(scores, found):
    order = np.argsort(scores, kind="stable")
    values = scores[order]
    ranks = np.empty(len(scores))
    _, start, count = np.unique(values, return_index=True, return_counts=True)
    ranks[order] = np.repeat(start + (count + 1) / 2, count)
    n = found.sum()
    return (ranks[found].sum() - n * (n + 1) / 2) / (n * (len(found) - n)) if 0 < n < len(found) else np.nan


def drawn_aucs(scores, found, groups):
    """AUC of groups drawn with replacement; the draws depend on the groups alone, so that two sets can be set off."""
    random = np.random.default_rng(1)
    members = [np.flatnonzero(groups == g) for g in np.unique(groups)]
    values = []
    for _ in range(500):
        index = np.concatenate([members[i] for i in random.integers(0, len(members), len(members))])
        values.append(auc(scores[index], found[index]))
    return np.array(values)


def scored(pilotage, picture, work, tile_px, radius_px, options):
    flags = [f"--degradation-{name}={value}" for name, value in options.items()]
    run(pilotage, "score", picture, "--measures", "degraded", "--tile-size-px", tile_px, "--stride-px", tile_px // 2,
        "--search-radius-px", radius_px, "-o", work / "scores.tif", "--table", work / "tiles.csv", "--overwrite", "-q",
        *flags)
    with open(work / "tiles.csv", newline="") as stream:
        return {(int(row["column"]), int(row["row"])): float(row["degraded_peak_margin"])
                for row in csv.DictReader(stream) if row["degraded_peak_margin"]}


def found_tiles(first, second, valid, tile_px, radius_px, tolerance_px, expected):
    """Tile (column, row) → whether date 2's tile lies where it should in date 1."""
    result = {}
    step = tile_px // 2
    for row in range((first.shape[0] - tile_px) // step + 1):
        for col in range((first.shape[1] - tile_px) // step + 1):
            y, x = row * step, col * step
            down, right = expected(y + tile_px / 2, x + tile_px / 2)
            top, left = y + down, x + right  # of the tile's ground in date 2
            if y < radius_px or x < radius_px or min(top, left) < 0:
                continue
            if max(top, y + radius_px) + tile_px > first.shape[0] or max(left, x + radius_px) + tile_px > first.shape[1]:
                continue
            around = np.s_[y - radius_px:y + tile_px + radius_px, x - radius_px:x + tile_px + radius_px]
            tile = second[top:top + tile_px, left:left + tile_px]
            if valid[around].mean() < MIN_VALID or tile.std() < 1e-3:
                continue
            dx, dy, _ = find(tile, first[around])
            result[col, row] = np.hypot(dx, dy) <= tolerance_px
    return result


def compare(pilotage, name, pictures, work, tile_px, radius_px, tolerance_px, expected_of):
    """pictures: list of (map file, date 1, date 2, valid); prints a table."""
    truths = [found_tiles(one, two, valid, tile_px, radius_px, tolerance_px, expected_of)
              for _, one, two, valid in pictures]
    total = [found for truth in truths for found in truth.values()]
    print(f"{name}, tile {tile_px} px: {len(total)} tiles, {100 * np.mean(total):.0f} % found", flush=True)
    of_defaults = None
    for label, options in SETS.items():
        values, found, groups = [], [], []
        for index, ((path, *_), truth) in enumerate(zip(pictures, truths)):
            margins = scored(pilotage, path, work, tile_px, radius_px, options)
            for (col, row), right in truth.items():
                if (col, row) in margins:
                    values.append(margins[col, row])
                    found.append(right)
                    groups.append(index if len(pictures) > 1 else 1000 * (row // 4) + col // 4)
        values, found, groups = np.array(values), np.array(found, bool), np.array(groups)
        draws = drawn_aucs(values, found, groups)
        of_defaults = draws if of_defaults is None else of_defaults
        low, high = np.nanquantile(draws, [0.025, 0.975])
        worse, better = np.nanquantile(draws - of_defaults, [0.025, 0.975])
        print(f"| {label} | {auc(values, found):.3f} | {low:.3f} … {high:.3f} | {worse:+.3f} … {better:+.3f} | "
              f"{np.median(values):.3f} | {100 * np.mean(values > 0):.0f} % |", flush=True)


def sentinel2(pilotage, data, work):
    pictures = []
    for path in sorted((data / "twodate/sentinel2").glob("*_1.png")):
        one, two = (read_gray(p)[0] for p in (path, path.with_name(path.name.replace("_1", "_2"))))
        rows, cols = (min(sizes) for sizes in zip(one.shape, two.shape))
        map_file = work / (path.stem + ".tif")  # some place or other: only its pixels count
        gdal.Translate(str(map_file), str(path), outputSRS="EPSG:32631", outputBounds=[
            500000, 5000000, 500000 + 10 * one.shape[1], 5000000 - 10 * one.shape[0]])
        pictures.append((map_file, one[:rows, :cols], two[:rows, :cols], np.ones((rows, cols), bool)))
    compare(pilotage, "sentinel2", pictures, work, 32, 48, 1.5, lambda y, x: (0, 0))


def port(pilotage, data, work):
    places, shifts = shifts_of_port(data / "port")
    half = work / "port.tif"
    gdal.Translate(str(half), str(data / "port/port_2019-08.tif"), widthPct=50, heightPct=50, resampleAlg="average")
    second, valid_2, _ = read_gray(data / "port/port_2020-07_registered.tif")
    one, valid, _ = read_gray(half)
    two = averaged(second, 2)
    rows, cols = (min(sizes) for sizes in zip(one.shape, two.shape))
    valid = valid[:rows, :cols] & (averaged(valid_2.astype(float), 2)[:rows, :cols] == 1)

    def expected(y, x):
        near = np.argsort(np.hypot(*(places - (2 * y, 2 * x)).T), kind="stable")[:NEIGHBOURS]
        return (int(round(v / 2)) for v in np.median(shifts[near], 0))

    for tile_px in (96, 128):
        compare(pilotage, "port", [(half, one[:rows, :cols], two[:rows, :cols], valid)], work, tile_px, 64, 6,
                expected)


def main():
    arguments = sys.argv[1:]
    only = None
    if "--only" in arguments:
        at = arguments.index("--only")
        only = arguments[at + 1]
        del arguments[at:at + 2]
    if len(arguments) != 2:
        raise SystemExit(__doc__)
    with tempfile.TemporaryDirectory(prefix="pilotage_degradations_") as work:
        for test in (sentinel2, port):
            if only in (None, test.__name__):
                test(pathlib.Path(arguments[0]), pathlib.Path(arguments[1]), pathlib.Path(work))


if __name__ == "__main__":
    main()
