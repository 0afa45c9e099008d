"""The example program of docs/examples/prep, built against an installed library and run on a part of the sample
mission's imagery: it makes the map that the command line makes, and tells the scores that stand in tiles.csv.

prep_example.py PILOTAGE SOURCE_FOLDER INSTALLED GENERATOR CXX LAUNCHER SANITIZERS"""

import csv
import io
import json
import sys

from acceptance import SKIP, check, main, need_gdal, run
from library_user import SHARED, Toolchain, build_example, has_shared

CORNER_PX, SIDE_PX = (1200, 1200), 1400
AGL_M, SPEED_MPS = 100, 18


def make_mission(source, work):
    """A part of the sample's imagery, and a line across it."""
    gdal = need_gdal()
    from osgeo import osr
    ortho = gdal.Translate(str(work / "ortho.tif"), str(source / "maps/sample/ortho.tif"),
                           srcWin=[*CORNER_PX, SIDE_PX, SIDE_PX])
    geodetic = osr.SpatialReference()
    geodetic.ImportFromEPSG(4326)
    geodetic.SetAxisMappingStrategy(osr.OAMS_TRADITIONAL_GIS_ORDER)
    transform = osr.CoordinateTransformation(ortho.GetSpatialRef(), geodetic)
    line = [transform.TransformPoint(*gdal.ApplyGeoTransform(ortho.GetGeoTransform(), share * SIDE_PX, 0.5 * SIDE_PX))[:2]
            for share in (0.3, 0.7)]
    (work / "route.geojson").write_text(json.dumps({"type": "Feature", "properties": {}, "geometry": {
        "type": "LineString", "coordinates": line}}))


def check_told(words, table):
    """The example's lines are the tiles of the map, with the P of tiles.csv."""
    told = {row["tile_id"]: row["p_correct_fix"] for row in csv.DictReader(io.StringIO(words))}
    with open(table, newline="") as stream:
        measured = {row["tile_id"]: row["p_correct_fix"] for row in csv.DictReader(stream)}
    check(len(told) >= 4, words)
    for tile, p in told.items():
        check(abs(float(p) - float(measured[tile])) <= 5e-7, f"tile {tile}: {p}, in tiles.csv {measured[tile]}")


def check_outputs(folder, expected):
    for name in ("map.gpkg", "tiles.csv", "scores.tif", "plan.json"):
        check((folder / name).read_bytes() == (expected / name).read_bytes(), f"{folder / name} is not as {expected / name}")


def test(pilotage, source, work, rest):
    installed, *tools = rest
    if not (source / "maps/sample/ortho.tif").exists():
        print("skipped: the sample mission's imagery is not made (target sample_mission)")
        sys.exit(SKIP)
    make_mission(source, work)
    camera = source / "maps/sample/camera.yaml"
    run(pilotage, "prepare", "--imagery", work / "ortho.tif", "--route", work / "route.geojson", "--camera", camera,
        "--agl-m", AGL_M, "--speed-mps", SPEED_MPS, "--ins-grade", "tactical", "--max-error-m", 60, "-o", work / "cli")
    mission = (work / "ortho.tif", work / "route.geojson", camera, AGL_M, SPEED_MPS)

    prefix = f"{installed}/everything"
    example = build_example(Toolchain(*tools), source, "prep", prefix, work / "example")
    check_told(run(example, *mission, work / "out", streams="stdout"), work / "out/tiles.csv")
    check_outputs(work / "out", work / "cli")
    if has_shared(prefix):
        shared = build_example(Toolchain(*tools), source, "prep", prefix, work / "shared_example", SHARED)
        check("libpilotage_prep.so.0" in run("readelf", "-d", shared), "the example does not load libpilotage_prep.so.0")
        run(shared, *mission, work / "shared")
        check_outputs(work / "shared", work / "cli")

    again = run(example, *mission, work / "out", expect=1)
    check("exists already" in again, again)
    wrong = run(example, *mission[:4], -1, work / "other", expect=2)
    check("speed_mps" in wrong, wrong)
    run(example, expect=2)


main(test)
