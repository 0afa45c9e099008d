"""A map of all the ground of a raster, by the ordinary commands, for measuring the matcher.

whole_map.py PILOTAGE RASTER -o MAP.gpkg [--footprint-m 154,80] [--hfov-deg 60 --width-px 640 --height-px 480]
             [--gsd-m M] [--build="--features-per-mpx 30000"] [--keep FOLDER]

The route is a line across the middle of the raster with a corridor as wide as the raster, flown once at each height
that gives a footprint of the stated width; every tile with ground is stored. What it runs, for a raster 1200 m high and
one footprint of 154 m (h = 133 m):

  pilotage tile --imagery RASTER --route route.geojson --height-reference agl --speed-mps 20 --camera-hfov-deg 60
           --camera-width-px 640 --camera-height-px 480 --max-error-m 60 --corridor-half-width-m 800 -o plan.json
  pilotage score plan.json --measures gray_variance --min-valid-fraction 0.01 -o scores.tif --table tiles.csv
  pilotage select plan.json --table tiles.csv -o selection.json
  pilotage build plan.json --table tiles.csv --selection selection.json -o MAP.gpkg

Without a margin among its measures, `select` takes each tile that was scored. Footprints of several widths become one
map with a level for each: `tile` splits heights into bands of equal ratio, so the route also climbs and sinks to where
the middles of the bands are the heights that were asked for."""

import argparse
import json
import math
import pathlib
import shlex
import tempfile

from acceptance import Failed, check, need_gdal, run

SPEED_MPS = 20
CLIMB = 0.02  # share of the raster's width


def heights_for(footprints_m, hfov_deg):
    """Heights of the route, lowest first, for levels whose middle heights show these widths."""
    per_metre = 2 * math.tan(math.radians(hfov_deg) / 2)
    wanted = sorted(footprint / per_metre for footprint in footprints_m)
    if len(wanted) == 1:
        return wanted
    ratio = (wanted[-1] / wanted[0])**(1 / (len(wanted) - 1))
    check(all(abs(wanted[i] / (wanted[0] * ratio**i) - 1) < 0.02 for i in range(len(wanted))) and
          len(wanted) >= math.log2(ratio) * len(wanted) > len(wanted) - 1,
          f"footprints {footprints_m}: levels have equal ratios, of at most 2 and not much less")
    edges = [wanted[0] * ratio**(i - 0.5) for i in range(len(wanted) + 1)]
    return [edges[0]] + wanted[1:-1] + [edges[-1]]


def route_over(raster, heights_m):
    """GeoJSON of a line to and fro across the middle of the raster, and half the length of its diagonal in metres."""
    gdal = need_gdal()
    from osgeo import osr
    dataset = gdal.Open(str(raster))
    place = dataset.GetGeoTransform()
    ground = dataset.GetSpatialRef()
    geodetic = osr.SpatialReference()
    geodetic.ImportFromEPSG(4326)
    geodetic.SetAxisMappingStrategy(osr.OAMS_TRADITIONAL_GIS_ORDER)
    transform = osr.CoordinateTransformation(ground, geodetic)

    def position(across, down=0.5):
        x, y = gdal.ApplyGeoTransform(place, across * dataset.RasterXSize, down * dataset.RasterYSize)
        return transform.TransformPoint(x, y)[:2]

    def metres(a, b):
        north = (b[1] - a[1]) * 111320
        return math.hypot(north, (b[0] - a[0]) * 111320 * math.cos(math.radians(a[1])))

    line = []
    for i, height in enumerate(heights_m):
        ends = (CLIMB, 1 - CLIMB) if i % 2 == 0 else (1 - 2 * CLIMB, 2 * CLIMB)
        line += [[*position(across), height] for across in ends]
    diagonal_m = metres(position(0, 0), position(1, 1))
    feature = {"type": "Feature", "properties": {"name": "all of it"},
               "geometry": {"type": "LineString", "coordinates": line}}
    return {"type": "FeatureCollection", "features": [feature]}, diagonal_m / 2


def make_whole_map(pilotage, raster, output, footprints_m=(154,), camera=(60, 640, 480), tile_args=(), build_args=(),
                   keep=None):
    """`camera`: horizontal field of view in degrees, width and height in pixels. The files between the commands are
    written to the folder `keep`, if one is named. Returns what the commands said."""
    hfov_deg, width_px, height_px = camera
    heights_m = heights_for(footprints_m, hfov_deg)
    route, half_diagonal_m = route_over(raster, heights_m)
    with tempfile.TemporaryDirectory(prefix="pilotage_map_") as folder:
        work = pathlib.Path(keep or folder)
        work.mkdir(parents=True, exist_ok=True)
        (work / "route.geojson").write_text(json.dumps(route))
        said = run(pilotage, "tile", "--imagery", raster, "--route", work / "route.geojson", "--height-reference", "agl",
                   "--speed-mps", SPEED_MPS, "--camera-hfov-deg", hfov_deg, "--camera-width-px", width_px,
                   "--camera-height-px", height_px, "--max-error-m", 60, "--min-agl-m", 1, "--corridor-half-width-m",
                   math.ceil(half_diagonal_m), "--allow-uncovered", *tile_args, "--overwrite",
                   "-o", work / "plan.json")
        said += run(pilotage, "score", work / "plan.json", "--measures", "gray_variance", "--min-valid-fraction", 0.01,
                    "--overwrite", "-o", work / "scores.tif", "--table", work / "tiles.csv")
        said += run(pilotage, "select", work / "plan.json", "--table", work / "tiles.csv", "--overwrite",
                    "-o", work / "selection.json")
        said += run(pilotage, "build", work / "plan.json", "--table", work / "tiles.csv", "--selection",
                    work / "selection.json", *build_args, "--overwrite", "-o", output)
    return said


def command_line():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("pilotage")
    parser.add_argument("raster")
    parser.add_argument("-o", "--output", required=True)
    parser.add_argument("--footprint-m", default="154", help="widths, joined by commas")
    parser.add_argument("--hfov-deg", type=float, default=60)
    parser.add_argument("--width-px", type=int, default=640)
    parser.add_argument("--height-px", type=int, default=480)
    parser.add_argument("--gsd-m", type=float, help="of the map; chosen by `tile` if not given")
    parser.add_argument("--build", default="", help="further options of `pilotage build`, as one text")
    parser.add_argument("--keep", help="folder for plan.json, tiles.csv and selection.json")
    options = parser.parse_args()
    tile_args = ["--gsd-m", options.gsd_m] if options.gsd_m else []
    try:
        print(make_whole_map(options.pilotage, pathlib.Path(options.raster).absolute(), options.output,
                             [float(width) for width in options.footprint_m.split(",")],
                             (options.hfov_deg, options.width_px, options.height_px), tile_args,
                             shlex.split(options.build), options.keep), end="")
    except Failed as failure:
        raise SystemExit(str(failure)) from None


if __name__ == "__main__":
    command_line()
