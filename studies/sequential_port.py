"""What `match --sequential` gives over the port ten months later, beside frames that are matched each by itself.

sequential_port.py PILOTAGE CUT_FLIGHT_FRAMES --work DIR [--flights 4] [--frames 60] [--footprint-m 80] [--gsd-m 0.45]

Flights to and fro over what both pictures show, with the priors of one drifting inertial system (--ins-grade,
--start-sigma-m). Prints a table for docs/methods/match.md. With --shift-m the priors are off by so much besides, in one
direction for all frames of a flight: no frame has its ground in the window, and every fix is false; --rates are then the
values of --max-false-fix-rate that are asked for. True places are those of registered_truth.py; PILOTAGE_DATA names the
folder of the imagery."""

import argparse
import json
import os
import pathlib
import sys

import numpy as np

sys.path.append(str(pathlib.Path(__file__).resolve().parents[1] / "tests/accept"))  # helpers shared with the tests
from acceptance import need_gdal, run  # noqa: E402
from match_flights import fly, whole_map  # noqa: E402
from registered_truth import correct_truth  # noqa: E402

gdal = need_gdal()
from osgeo import osr  # noqa: E402

ACROSS = (0.25, 0.77)  # of the raster: where both pictures show ground, and a frame's width more
DOWN = (0.35, 0.65)
SPACING = 0.05


def serpentine(raster, offset):
    """A route (GeoJSON) in lines to and fro over the middle of the raster."""
    dataset = gdal.Open(str(raster))
    geodetic = osr.SpatialReference()
    geodetic.ImportFromEPSG(4326)
    geodetic.SetAxisMappingStrategy(osr.OAMS_TRADITIONAL_GIS_ORDER)
    transform = osr.CoordinateTransformation(dataset.GetSpatialRef(), geodetic)
    line = []
    for down in np.arange(DOWN[0] + offset, DOWN[1], SPACING):
        for across in ACROSS if len(line) % 4 == 0 else ACROSS[::-1]:
            x, y = gdal.ApplyGeoTransform(dataset.GetGeoTransform(), across * dataset.RasterXSize, down * dataset.RasterYSize)
            line.append(list(transform.TransformPoint(x, y)[:2]))
    geometry = {"type": "LineString", "coordinates": line}
    feature = {"type": "Feature", "properties": {"name": "to and fro"}, "geometry": geometry}
    return {"type": "FeatureCollection", "features": [feature]}


def flights(options, first, second):
    """Folders of frames."""
    for seed in range(1, options.flights + 1):
        folder = options.work / f"flight_{options.footprint_m:g}_{options.shift_m:g}_{options.frames}_{seed}"
        if not (folder / "frames.csv").exists():
            route = options.work / f"route_{seed}.geojson"
            route.write_text(json.dumps(serpentine(first, SPACING * (seed - 1) / options.flights)))
            run(options.cut_flight_frames, second, "-o", folder, "--frames", options.frames, "--footprint-m",
                options.footprint_m, "--also", first, "--seed", seed, "--route", route, "--min-valid", 0.95,
                "--prior-drifts", "--prior-shift-m",
                options.shift_m, "--ins-grade", options.ins_grade, "--ins-start-sigma-m", options.start_sigma_m)
            correct_truth(folder, second, first)
        yield folder


def sum_of(told):
    """The answers to several flights as one."""
    def count(name):
        return sum(t["sequence"][name] for t in told if "sequence" in t)

    return {"frames": sum(t["frames"] for t in told), "accepted": sum(t["accepted"] for t in told),
            "correct": sum(t["correct_fixes"]["count"] for t in told), "ms": np.median([t["median_ms"] for t in told]),
            "nees": np.average([t["nees_correct"]["mean"] or 0 for t in told],
                               weights=[max(1, t["nees_correct"]["count"]) for t in told]),
            **{name: count(name) for name in ("narrowed", "confirmed", "gate_refusals", "resets")}}


def measure(options):
    data = pathlib.Path(os.environ["PILOTAGE_DATA"])
    first, second = data / "port/port_2019-08.tif", data / "port/port_2020-07_registered.tif"
    map_path = options.work / f"port_{options.footprint_m:g}_{options.gsd_m:g}.gpkg"
    if not map_path.exists():
        whole_map(options.pilotage, first, map_path, options.footprint_m, options.gsd_m,
                  ("--chips", "--chip-gsd-m", max(0.9, options.gsd_m)))
    folders = list(flights(options, first, second))
    print("| chips | rate asked for | | frames | fixes | correct | by confirmation | narrowed | against the track | given up | "
          "NEES | ms |\n|---|---|---|---|---|---|---|---|---|---|---|---|", flush=True)
    for chips in ((), ("--no-chips",)):
        for rate in options.rates:
            for how in ((), ("--sequential", "--ins-grade", options.ins_grade)):
                told = [fly(options.pilotage, map_path, folder, "--threads", 1, "--max-false-fix-rate", rate, *chips, *how)
                        for folder in folders]
                s = sum_of(told)
                print(f"| {'no' if chips else 'yes'} | {rate} | {'in sequence' if how else 'each by itself'} | {s['frames']} | "
                      f"{s['accepted']} | {s['correct']} | {s['confirmed']} | {s['narrowed']} | {s['gate_refusals']} | "
                      f"{s['resets']} | {s['nees']:.2f} | {s['ms']:.0f} |", flush=True)


def command_line():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("pilotage")
    parser.add_argument("cut_flight_frames")
    parser.add_argument("--work", type=pathlib.Path, required=True, help="keeps maps and frames here")
    parser.add_argument("--flights", type=int, default=4)
    parser.add_argument("--frames", type=int, default=60, help="of each flight")
    parser.add_argument("--footprint-m", type=float, default=80)
    parser.add_argument("--gsd-m", type=float, default=0.45)
    parser.add_argument("--ins-grade", default="tactical")
    parser.add_argument("--start-sigma-m", type=float, default=25)
    parser.add_argument("--shift-m", type=float, default=0)
    parser.add_argument("--rates", type=float, nargs="+", default=[0.001])
    options = parser.parse_args()
    options.work.mkdir(parents=True, exist_ok=True)
    measure(options)


if __name__ == "__main__":
    command_line()
