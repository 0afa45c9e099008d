"""Whether the planned P of random routes over a real port lies in what simulated flights say.

simulate_port.py PILOTAGE $PILOTAGE_DATA [HOW_MANY [FLIGHTS [FIXES_RENDERED_FLIGHTS]]]

Routes of three to five legs of 250 m and more between points drawn with a fixed seed inside the imagery of 2019, low
flight with a hobby's inertial system and a limit of 40 m, so that P is not near 1. Each is prepared, and flown FLIGHTS
times with fixes drawn by P, in the conditions that the plan reckons with. With FIXES_RENDERED_FLIGHTS it is also flown so many times with frames that are
rendered from the imagery of 2020 and matched."""

import json
import math
import pathlib
import random
import subprocess
import sys
import tempfile

import numpy
from osgeo import gdal, osr

gdal.UseExceptions()
MISSION = {"camera": {"hfov_deg": 60, "width_px": 640, "height_px": 480}, "ins": {"grade": "consumer"}, "agl_m": 70,
           "speed_mps": 15, "max_error_m": 40}
REACH_M = 110  # of imagery around each point: footprint, and what the drift may add
LEAST_LEG_M = 250


def routes(imagery):
    """Endless lists of points, longitude and latitude."""
    data = gdal.Open(str(imagery))
    place = data.GetGeoTransform()
    wgs84 = osr.SpatialReference()
    wgs84.ImportFromEPSG(4326)
    wgs84.SetAxisMappingStrategy(osr.OAMS_TRADITIONAL_GIS_ORDER)
    grid = data.GetSpatialRef()
    grid.SetAxisMappingStrategy(osr.OAMS_TRADITIONAL_GIS_ORDER)
    to_wgs84 = osr.CoordinateTransformation(grid, wgs84)
    # Metres per entry: 10; 0 where any of the ground within REACH_M is missing.
    mask = data.GetRasterBand(1).GetMaskBand().ReadAsArray()[::round(10 / place[1]), ::round(10 / place[1])] > 0
    reach = math.ceil(REACH_M / 10)
    inside = numpy.zeros_like(mask)
    inside[reach:-reach, reach:-reach] = numpy.lib.stride_tricks.sliding_window_view(
        mask, (2 * reach + 1, 2 * reach + 1)).all(axis=(2, 3))
    draw = random.Random(29)

    def over_imagery(a, b):
        steps = max(2, round(math.dist(a, b) / 10))
        return all(inside[round(a[1] + (b[1] - a[1]) * i / steps), round(a[0] + (b[0] - a[0]) * i / steps)] for i in range(steps + 1))

    step_m = round(10 / place[1]) * place[1]
    while True:
        cells = []
        legs = draw.randint(3, 5)
        while len(cells) <= legs:
            cell = (draw.uniform(0, mask.shape[1] - 1), draw.uniform(0, mask.shape[0] - 1))
            if inside[round(cell[1]), round(cell[0])] if not cells else (
                    step_m * math.dist(cells[-1], cell) >= LEAST_LEG_M and over_imagery(cells[-1], cell)):
                cells.append(cell)
        points = [(place[0] + x * step_m, place[3] - y * step_m) for x, y in cells]
        yield [to_wgs84.TransformPoint(*point)[:2] for point in points]


def run(*arguments):
    done = subprocess.run([str(argument) for argument in arguments], capture_output=True, text=True)
    if done.returncode not in (0, 3):
        raise SystemExit(f"{' '.join(map(str, arguments))}: {done.stderr}")
    return done


def share(found):
    return f"{found['share']:.3f} [{found['low']:.3f}, {found['high']:.3f}]"


def holds(found, planned):
    return found["low"] <= planned <= found["high"]


def fly(program, folder, *options):
    run(program, "simulate", folder / "out", "-q", "--overwrite", "-o", folder / "simulation.json", *options)
    return json.loads((folder / "simulation.json").read_text())


def main(program, data, how_many=20, flights=1000, rendered=0):
    imagery = pathlib.Path(data) / "port/port_2019-08.tif"
    other = pathlib.Path(data) / "port/port_2020-07_registered.tif"
    inside = {"drawn": 0, "rendered": 0}
    differences = []
    rendered_right = rendered_tries = 0
    drawn = routes(imagery)
    for number in range(1, how_many + 1):
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            (folder / "route.geojson").write_text(json.dumps(
                {"type": "Feature", "properties": {}, "geometry": {"type": "LineString", "coordinates": next(drawn)}}))
            (folder / "mission.json").write_text(json.dumps({"imagery": [str(imagery)], "route": "route.geojson", **MISSION}))
            run(program, "prepare", folder / "mission.json", "-q", "-o", folder / "out")
            found = fly(program, folder, "--flights", flights)
            planned = found["planned_p"]
            inside["drawn"] += holds(found["within"], planned)
            differences.append(found["within"]["share"] - planned)
            line = f"{number:2} planned {planned:.3f}, drawn {share(found['within'])}"
            if rendered:
                matched = fly(program, folder, "--fixes", "rendered", "--world", other, "--flights", rendered)
                inside["rendered"] += holds(matched["within"], planned)
                rendered_right += matched["fixes"]["right"]
                rendered_tries += matched["fixes"]["tries"] - matched["fixes"]["not_stored"] - matched["fixes"]["off_line"]
                line += f", rendered {share(matched['within'])}, false {matched['fixes']['false_taken']}"
            print(line, flush=True)
    for what, count in inside.items():
        if what != "rendered" or rendered:
            print(f"planned P inside the interval, {what}: {count} of {how_many}")
    print(f"mean of drawn less planned: {sum(differences) / how_many:+.3f}")
    if rendered:
        print(f"rendered: {rendered_right} right fixes of {rendered_tries} tries less those over ground not stored that gave none")


if __name__ == "__main__":
    if len(sys.argv) not in (3, 4, 5, 6):
        raise SystemExit(__doc__)
    main(pathlib.Path(sys.argv[1]).resolve(), sys.argv[2], *map(int, sys.argv[3:]))
