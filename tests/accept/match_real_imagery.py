"""The matcher on real imagery with truth: a port at two dates ten months apart, one frame of a drone over a satellite
map, and frames over maps of other places.

match_real_imagery.py PILOTAGE SOURCE_FOLDER CUT_FLIGHT_FRAMES

PILOTAGE_MATCH_FRAMES=500 measures with more frames than the 150 of a test."""

import csv
import math
import os
import shutil
import sys

from acceptance import SKIP, check, main, need_gdal, real_data, run
from match_flights import check_none, check_rates, cut, fly, move_priors, tell, whole_map
from registered_truth import correct_truth
from whole_map import make_whole_map

gdal = need_gdal()

FRAMES = int(os.environ.get("PILOTAGE_MATCH_FRAMES", "150"))
QUERY_PX = (4004, 2662)
QUERY_GSD_M = 0.064
QUERY_HFOV_DEG = 60  # not known; a narrower or wider lens sees the same flat ground


def over_the_port(pilotage, data, tool, work):
    first, second = data / "port/port_2019-08.tif", data / "port/port_2020-07_registered.tif"
    map_path = whole_map(pilotage, first, work / "port.gpkg", 154, 0.6, ("--chips",))
    here = cut(tool, second, work / "port", frames=FRAMES, footprint_m=154, also=first)
    tell("port, 154 m wide, truth of the other picture", fly(pilotage, map_path, here))
    correct_truth(here, second, first)
    check_rates("port, 154 m wide, features and chips", fly(pilotage, map_path, here), 0.92, 0.01)
    check_rates("port, 154 m wide, features alone", fly(pilotage, map_path, here, "--no-chips"), 0.91, 0.01)
    shifted = cut(tool, second, work / "shifted", frames=FRAMES, footprint_m=154, also=first, prior_shift_m=400, seed=2)
    check_none("port, priors 400 m off", fly(pilotage, map_path, shifted), FRAMES // 100)
    fine_map = whole_map(pilotage, first, work / "port_80.gpkg", 80, 0.45, ("--chips", "--chip-gsd-m", 0.9))
    fine = cut(tool, second, work / "port_80", frames=FRAMES, footprint_m=80, also=first, seed=3)
    correct_truth(fine, second, first)
    check_rates("port, 80 m wide, features and chips", fly(pilotage, fine_map, fine), 0.7, 0.02)
    check_rates("port, 80 m wide, features alone", fly(pilotage, fine_map, fine, "--no-chips"), 0.66, 0.02)
    return map_path, here


def frames_from_elsewhere(pilotage, data, tool, map_path, here, work):
    for name, raster in (("autzen", "autzen/autzen.tif"), ("zanzibar", "zanzibar/zanzibar_z20.tif")):
        # Zanzibar's picture is 600 m by 300 m.
        folder = cut(tool, data / raster, work / name, frames=FRAMES, footprint_m=154, seed=4)
        move_priors(folder, here)
        check_none(f"{name} over the port's map", fly(pilotage, map_path, folder), FRAMES // 100)


def satellite_map(data, work):
    """The two tiles with their corners in a text file, as one dataset."""
    parts = []
    with open(data / "moscow/map/map_metadata.txt") as stream:
        for row in csv.DictReader(stream, delimiter=" "):
            parts.append(work / (row["filename"] + ".vrt"))
            run("gdal_translate", "-q", "-of", "VRT", "-a_srs", "EPSG:4326", "-a_ullr", row["top_left_lon"],
                row["top_left_lat"], row["bottom_right_lon"], row["bottom_right_lat"],
                data / "moscow/map" / row["filename"], parts[-1])
    run("gdalbuildvrt", "-q", work / "moscow.vrt", *parts)
    # A raster, because a VRT may name files of its own folder only.
    run("gdal_translate", "-q", "-co", "TILED=YES", work / "moscow.vrt", work / "moscow.tif")
    return work / "moscow.tif"


def moscow(pilotage, data, work):
    map_path = work / "moscow.gpkg"
    width_m = QUERY_PX[0] * QUERY_GSD_M
    make_whole_map(pilotage, satellite_map(data, work), map_path, (width_m,), (QUERY_HFOV_DEG, *QUERY_PX))
    lon_deg, lat_deg = 38.246245, 55.542349
    height_m = width_m / 2 / math.tan(math.radians(QUERY_HFOV_DEG / 2))
    per_metre_lon = 1 / (111320 * math.cos(math.radians(lat_deg)))
    belief = ["--prior-sigma-m", 30, "--height-agl-m", height_m, "--yaw-deg", 0, "--pitch-deg", 0, "--roll-deg", 0]
    # North up was measured on the picture, not logged by a drone.
    belief += ["--yaw-sigma-deg", 2]
    camera = ["--camera-hfov-deg", QUERY_HFOV_DEG, "--camera-width-px", QUERY_PX[0], "--camera-height-px", QUERY_PX[1]]
    found = 0
    for east, north in ((42, 42), (-42, 42), (-42, -42), (42, -42), (60, 0), (0, -60)):
        prior = ["--prior-lon-deg", lon_deg + east * per_metre_lon, "--prior-lat-deg", lat_deg + north / 111320]
        told = run(pilotage, "match", map_path, data / "moscow/queries/0.jpg", *prior, *belief, *camera,
                   "--true-lon-deg", lon_deg, "--true-lat-deg", lat_deg)
        lines = told.splitlines()
        print(f"moscow 0.jpg, prior {east} m east, {north} m north: {lines[0]}",
              *[line for line in lines if line.startswith("error")], flush=True)
        if lines[0].startswith("fix"):
            error_m = float([line for line in lines if line.startswith("error")][0].split()[-2])
            check(error_m <= 5, f"moscow: {error_m} m off")
            found += 1
        picture = data / "moscow/queries/1.png"
        size = gdal.Open(str(picture))
        elsewhere = ["--camera-hfov-deg", QUERY_HFOV_DEG, "--camera-width-px", size.RasterXSize, "--camera-height-px",
                     size.RasterYSize, "--allow-other-camera"]
        told = run(pilotage, "match", map_path, picture, *prior, *belief, *elsewhere)
        check(not told.startswith("fix"), f"moscow: a frame from elsewhere is accepted\n{told}")
    check(found >= 5, f"moscow: {found} of 6 priors 60 m off gave a fix")


def test(pilotage, source, work, rest):
    data = real_data(source)
    if not shutil.which("gdalbuildvrt"):
        print("skipped: gdalbuildvrt is not installed: apt-get install gdal-bin")
        sys.exit(SKIP)
    tool = rest[0]
    map_path, here = over_the_port(pilotage, data, tool, work)
    frames_from_elsewhere(pilotage, data, tool, map_path, here, work)
    moscow(pilotage, data, work)


main(test)
