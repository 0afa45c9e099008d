"""How many frames find their place, by width on the ground and GSD of the map, over the port ten months later.

footprint_curve.py PILOTAGE CUT_FLIGHT_FRAMES [--frames 120] [--work DIR]

Prints a table for docs/methods/match.md. True places are those of registered_truth.py; PILOTAGE_DATA names the folder
of the imagery."""

import argparse
import os
import pathlib
import sys
import tempfile

sys.path.append(str(pathlib.Path(__file__).resolve().parents[1] / "tests/accept"))  # helpers shared with the tests
from match_flights import cut, fly, whole_map  # noqa: E402
from registered_truth import correct_truth  # noqa: E402

FOOTPRINTS_M = (154, 115, 80, 60)
GSDS_M = (0.3, 0.45, 0.6, 0.9, 1.2)


def cell(told):
    rate = told["correct_fixes"]
    return f"{100 * rate['rate']:.0f} ({100 * rate['low']:.0f} … {100 * rate['high']:.0f}), {told['false_fixes']['count']}"


def measure(options, work):
    data = pathlib.Path(os.environ["PILOTAGE_DATA"])
    first, second = data / "port/port_2019-08.tif", data / "port/port_2020-07_registered.tif"
    print("| width on the ground | GSD of the map | features alone | features and chips |\n|---|---|---|---|", flush=True)
    for footprint_m in FOOTPRINTS_M:
        frames = cut(options.cut_flight_frames, second, work / f"frames_{footprint_m}", frames=options.frames,
                     footprint_m=footprint_m, also=first, seed=footprint_m)
        correct_truth(frames, second, first)
        for gsd_m in GSDS_M:
            chips = ("--chips",)
            map_path = whole_map(options.pilotage, first, work / f"{footprint_m}_{gsd_m}.gpkg", footprint_m, gsd_m, chips)
            alone, both = fly(options.pilotage, map_path, frames, "--no-chips"), fly(options.pilotage, map_path, frames)
            print(f"| {footprint_m} m | {gsd_m} m | {cell(alone)} | {cell(both)} |", flush=True)


def command_line():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("pilotage")
    parser.add_argument("cut_flight_frames")
    parser.add_argument("--frames", type=int, default=120)
    parser.add_argument("--work", type=pathlib.Path, help="keeps maps and frames here")
    options = parser.parse_args()
    if options.work:
        measure(options, options.work)
    else:
        with tempfile.TemporaryDirectory(prefix="pilotage_curve_") as folder:
            measure(options, pathlib.Path(folder))


if __name__ == "__main__":
    command_line()
