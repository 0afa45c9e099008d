"""What heights that are steeper, flatter or wrong do to rendered flights of the sample mission.

wrong_heights.py PILOTAGE SAMPLE [--work FOLDER] [--flights N] [--seed S] [--only ROW...] [--threads N]

The sample's elevation model is scaled about the place of take-off (map and world alike), or the world's alone is changed while the map keeps its own: by normal errors of
2 and 5 m that are smooth over 60 and 100 m, or by a constant: the aircraft, which holds its height above sea level, then flies lower than
planned, and its altimeter says so. Frames show the sample's second date. Each row is prepared where its map differs, and flown N times; printed are flights within the limit,
right and false fixes, frames answered by a place outside the gate, the NEES of right fixes, and how the fixes lean."""

import argparse
import json
import pathlib
import shutil
import subprocess

import numpy
from osgeo import gdal, osr

gdal.UseExceptions()

# Name: scale of all heights; standard deviation, length and constant of what is added to the world's alone; what the matcher is told of it.
ROWS = {"x0": (0, 0, 0, 0), "x0.5": (0.5, 0, 0, 0), "x1": (1, 0, 0, 0), "x2": (2, 0, 0, 0), "x4": (4, 0, 0, 0),
        "off-2m": (1, 2, 60, 0), "off-5m": (1, 5, 100, 0), "off-5m-told": (1, 5, 100, 0, "--match-elevation-sigma-m", 5), "higher-5m": (1, 0, 0, 5), "higher-10m": (1, 0, 0, 10),
        "higher-30m": (1, 0, 0, 30)}


def smooth(shape, pixel_m, length_m, draw):
    """Normal with standard deviation 1, correlated over `length_m` (Gaussian), by its spectrum."""
    rows, cols = shape
    frequency = numpy.hypot(numpy.fft.fftfreq(rows)[:, None], numpy.fft.rfftfreq(cols)[None, :]) / pixel_m
    field = numpy.fft.irfft2(numpy.fft.rfft2(draw.standard_normal(shape)) * numpy.exp(-((numpy.pi * frequency * length_m) ** 2) / 2), shape)
    return (field - field.mean()) / field.std()


def write_like(source, path, heights):
    made = gdal.GetDriverByName("GTiff").Create(str(path), source.RasterXSize, source.RasterYSize, 1, gdal.GDT_Float32)
    made.SetGeoTransform(source.GetGeoTransform())
    made.SetProjection(source.GetProjection())
    made.GetRasterBand(1).WriteArray(heights.astype(numpy.float32))


def pixel_of(source, place):
    wgs84 = osr.SpatialReference()
    wgs84.ImportFromEPSG(4326)
    wgs84.SetAxisMappingStrategy(osr.OAMS_TRADITIONAL_GIS_ORDER)
    grid = source.GetSpatialRef()
    grid.SetAxisMappingStrategy(osr.OAMS_TRADITIONAL_GIS_ORDER)
    x, y, _ = osr.CoordinateTransformation(wgs84, grid).TransformPoint(place[1], place[0])
    left, width, _, top, _, height = source.GetGeoTransform()
    return int((y - top) / height), int((x - left) / width)


def run(*arguments):
    done = subprocess.run([str(argument) for argument in arguments], capture_output=True, text=True)
    if done.returncode not in (0, 3):
        raise SystemExit(f"{' '.join(map(str, arguments))}: {done.stderr}")
    return done


def fly(name, asked):
    scale, sigma_m, length_m, constant_m, *told = ROWS[name]
    source = gdal.Open(str(asked.sample / "elevation.tif"))
    heights = source.ReadAsArray().astype(float)
    pixel_m = source.GetGeoTransform()[1]
    mission = asked.work / f"sample-x{scale:g}"
    if not (mission / "out" / "map.gpkg").exists():
        shutil.rmtree(mission, ignore_errors=True)
        shutil.copytree(asked.sample, mission, ignore=shutil.ignore_patterns("frames", "country"))
        home_m = heights[pixel_of(source, json.loads((asked.sample / "route.plan").read_text())["mission"]["plannedHomePosition"])]
        write_like(source, mission / "elevation.tif", home_m + scale * (heights - home_m))
        run(asked.program, "prepare", mission / "mission.json", "-o", mission / "out", "-q")
    options = []
    if sigma_m or constant_m:
        world = asked.work / f"world-{name}.tif"
        added = sigma_m * smooth(heights.shape, pixel_m, length_m, numpy.random.default_rng(11)) if sigma_m else 0
        write_like(source, world, heights + added + constant_m)
        options = ["--world-elevation", world, *told]
    result = asked.work / f"{name}-{asked.seed}.json"
    done = run(asked.program, "simulate", mission / "out", "--fixes", "rendered", "--world", asked.sample / "ortho_second_epoch.tif",
               "--flights", asked.flights, "--seed", asked.seed, "--threads", asked.threads, "--overwrite", "-o", result, *options)
    flown = json.loads(result.read_text())
    matches = flown["rendered"]["matches"]
    within, right, false, lean = flown["within"], matches["correct_fixes"], matches["false_fixes"], matches["lean"]
    lean_text = f"{100 * lean['height_share']['median']:+.1f} %" if lean else "–"
    if lean and lean["judged"]:
        lean_text += f", {lean['east_m']['median']:+.1f} E {lean['north_m']['median']:+.1f} N m"
    warned = [line for line in done.stderr.splitlines() if "warning: the fixes lean" in line or "warning: the places" in line]
    print(f"| {name} | {within['flights']} of {within['of']} | {right['count']} of {right['of']} ({100 * right['count'] / max(1, right['of']):.0f} %) "
          f"| {false['count']} of {false['of']} | {matches['refused'].get('outside_gate', 0)} | {matches['nees_correct']['mean'] or float('nan'):.2f} "
          f"| {matches['median_error_m'] or float('nan'):.2f}, {matches['p95_error_m'] or float('nan'):.2f} m | {lean_text}{'; warned' if warned else ''} |", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=pathlib.Path)
    parser.add_argument("sample", type=pathlib.Path)
    parser.add_argument("--work", type=pathlib.Path, default=pathlib.Path("wrong-heights"))
    parser.add_argument("--flights", type=int, default=10)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--threads", type=int, default=0)
    parser.add_argument("--only", nargs="*", choices=ROWS, default=list(ROWS))
    asked = parser.parse_args()
    asked.sample = asked.sample.resolve()
    asked.work.mkdir(parents=True, exist_ok=True)
    print("| row | within | right of frames | false of fixes | outside_gate | NEES of right | error, median, 95 % | lean |\n|---|---|---|---|---|---|---|---|")
    for name in asked.only:
        fly(name, asked)


if __name__ == "__main__":
    main()
