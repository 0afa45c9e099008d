"""What a second date does for a map that is flown over at a third.

three_dates.py PILOTAGE CUT_FLIGHT_FRAMES --work DIR [--frames 200] [--footprint-m 50,67] [--chips]

A building site (real/p3): the maps are of 2022-05-31 and 2022-03-30, the frames of 2022-12-14 and 2024-02-01, which took no
part in either. Printed is what `match` finds by each map: of the later date with all features, with those that the
earlier one does not contradict (stable), with as many by --features-per-mpx alone, with three times as many; of the earlier
date; and by the maps of both dates together (`match --also-map`). *Half* are maps of half the features, so that two take as
much room as one. Tables for docs/methods/several-maps.md. PILOTAGE_DATA names the folder of the imagery."""

import argparse
import csv
import os
import pathlib
import re
import sys

sys.path.append(str(pathlib.Path(__file__).resolve().parents[1] / "tests/accept"))  # helpers shared with the tests
from acceptance import need_gdal  # noqa: E402
from match_flights import CAMERA, cut, fly  # noqa: E402
from whole_map import make_whole_map  # noqa: E402

need_gdal()
from fit_matchability import as_raster  # noqa: E402

GSD_M = 0.6  # a pixel of the pictures
FEATURES_PER_MPX = 20000
EARLIER, LATER = "2022-03-30", "2022-05-31"
FLOWN = ("2022-12-14", "2024-02-01")
RIGHT_WITHIN_M = 5


def rasters_of(work):
    folder = pathlib.Path(os.environ["PILOTAGE_DATA"]) / "real/p3"
    return {date: as_raster(folder / f"p3_{date}.png", work / f"{date}.tif", no_data="0") for date in (EARLIER, LATER, *FLOWN)}


def fixes_of(pilotage, path, folder, *options):
    """Rows of fixes.csv, one for each frame."""
    fly(pilotage, path, folder, *options)
    with open(folder / "fixes.csv", newline="") as stream:
        return list(csv.DictReader(stream))


def tally(rows):
    """Frames that are right, and false."""
    errors_m = [float(row["error_m"]) for row in rows if row["lat_deg"]]
    right = sum(error_m <= RIGHT_WITHIN_M for error_m in errors_m)
    return right, len(errors_m) - right


def measure(options, rasters, footprint_m):
    folders = {date: cut(options.tool, rasters[date], options.work / f"flown_{date}_{footprint_m}", frames=options.frames,
                         footprint_m=footprint_m, also=rasters[LATER]) for date in FLOWN}
    chips = ("--chips",) if options.chips else ()
    maps, sizes = {}, {}

    def build(name, date, *args):
        path = options.work / f"{name}_{footprint_m}.gpkg"
        said = make_whole_map(options.pilotage, rasters[date], path, (footprint_m,), CAMERA, ("--gsd-m", GSD_M), (*args, *chips))
        maps[name] = path
        sizes[name] = int(re.search(r"(\d+) descriptors", said).group(1)), path.stat().st_size / 1e6

    stable = ("--keep-features", "stable", "--second-epoch", rasters[EARLIER])
    build("later", LATER)
    build("later, stable", LATER, *stable)
    build("later, as many", LATER, "--features-per-mpx", round(FEATURES_PER_MPX * sizes["later, stable"][0] / sizes["later"][0]))
    build("later, three times as many", LATER, "--features-per-mpx", 3 * FEATURES_PER_MPX)
    build("earlier", EARLIER)
    for name, date in (("later, half", LATER), ("earlier, half", EARLIER)):
        build(name, date, "--features-per-mpx", FEATURES_PER_MPX // 2)

    def row(name, features, megabytes, answers):
        cells = [f"{right}, {false}" for right, false in answers]
        print(f"| {footprint_m} m, {name} | {features:,} | {megabytes:.2f} MB | {' | '.join(cells)} |", flush=True)

    for name, path in maps.items():
        row(name, *sizes[name], [tally(fixes_of(options.pilotage, path, folders[date])) for date in FLOWN])
    for later, earlier in (("later", "earlier"), ("later, half", "earlier, half")):
        answers = [tally(fixes_of(options.pilotage, maps[later], folders[date], "--also-map", maps[earlier])) for date in FLOWN]
        row(f"{later} and {earlier} together", sizes[later][0] + sizes[earlier][0], sizes[later][1] + sizes[earlier][1],
            answers)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("pilotage")
    parser.add_argument("tool", metavar="CUT_FLIGHT_FRAMES")
    parser.add_argument("--work", type=pathlib.Path, required=True)
    parser.add_argument("--frames", type=int, default=200)
    parser.add_argument("--footprint-m", default="50,67")
    parser.add_argument("--chips", action="store_true")
    given = parser.parse_args()
    given.work.mkdir(parents=True, exist_ok=True)
    pictures = rasters_of(given.work)
    for width in given.footprint_m.split(","):
        measure(given, pictures, int(width))
