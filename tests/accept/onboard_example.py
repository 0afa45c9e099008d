"""The example program of docs/examples/onboard, built against an installed onboard library and run on a map: it gives a
fix on ground of the map, and a reason elsewhere.

onboard_example.py PILOTAGE SOURCE_FOLDER CUT_FLIGHT_FRAMES INSTALLED GENERATOR CXX LAUNCHER SANITIZERS"""

import csv
import math
import re
import sys

from acceptance import SKIP, check, main, run
from library_user import SHARED, Toolchain, build_example, has_shared
from whole_map import make_whole_map

CAMERA = (73.7, 800, 450)  # degrees, pixels
FOOTPRINT_M = 180
REACH_M = 8  # the two dates agree to a pixel of 0.5 m


def cut_frames(cut, source, work, count):
    """Frames of the sample's second date, as rows of frames.csv."""
    folder = work / "frames"
    hfov_deg, width_px, height_px = CAMERA
    run(cut, source / "maps/sample/ortho_second_epoch.tif", "--hfov-deg", hfov_deg, "--width-px", width_px,
        "--height-px", height_px, "--footprint-m", FOOTPRINT_M, "--frames", count, "--format", "pgm", "--prior-offset-m",
        30, "--prior-sigma-m", 15, "-o", folder)
    with open(folder / "frames.csv", newline="") as stream:
        return [dict(row, file=folder / row["file"]) for row in csv.DictReader(stream)]


def fly(example, map_path, row, lon_deg, lat_deg):
    """Exit code and words of the example with a frame and a prior position."""
    belief = [row[key] for key in ("height_agl_m", "yaw_deg", "pitch_deg", "roll_deg")]
    return run(example, map_path, row["file"], lon_deg, lat_deg, row["prior_sigma_m"], *belief, "nan", expect=None)


def error_m(row, words):
    lat_deg, lon_deg = (float(x) for x in re.search(r"latitude (\S+) longitude (\S+)", words).groups())
    true_lon_deg, true_lat_deg = float(row["true_nadir_lon_deg"]), float(row["true_nadir_lat_deg"])
    return math.hypot((lat_deg - true_lat_deg) * 111320,
                      (lon_deg - true_lon_deg) * 111320 * math.cos(math.radians(true_lat_deg)))


def check_fix(row, words):
    off_m = error_m(row, words)
    check(off_m < REACH_M, f"{row['file'].name}: fix {off_m:.1f} m off\n{words}")
    check("NavSatFix status 0" in words and "source 2 flags 0" in words, words)
    e7 = [int(x) for x in re.search(r"lat (\S+) lon (\S+) alt_ell", words).groups()]
    degrees = [float(x) for x in re.search(r"latitude (\S+) longitude (\S+)", words).groups()]
    check(all(abs(a - b * 1e7) <= 1 for a, b in zip(e7, degrees)), words)


def check_refusal(words):
    check("NavSatFix status -1 latitude nan longitude nan" in words and "source 2 flags 1 lat 2147483647" in words, words)


def test(pilotage, source, work, rest):
    cut, installed, *tools = rest
    if not (source / "maps/sample/ortho_second_epoch.tif").exists():
        print("skipped: the sample mission's imagery is not made: cmake --build … --target sample_mission")
        sys.exit(SKIP)
    prefix = f"{installed}/onboard"
    example = build_example(Toolchain(*tools), source, "onboard", prefix, work / "example")
    map_path = work / "map.gpkg"
    make_whole_map(pilotage, source / "maps/sample/ortho.tif", map_path, (FOOTPRINT_M,), CAMERA)
    rows = cut_frames(cut, source, work, 10)
    fixes = 0
    for row in rows:
        code, words = fly(example, map_path, row, row["prior_lon_deg"], row["prior_lat_deg"])
        check(code in (0, 3), words)
        check_fix(row, words) if code == 0 else check_refusal(words)
        fixes += code == 0
    check(fixes >= 4, f"{fixes} of {len(rows)} frames of the map's ground got a fix\n{words}")

    if has_shared(prefix):
        shared = build_example(Toolchain(*tools), source, "onboard", prefix, work / "shared_example", SHARED)
        check("libpilotage_onboard.so.0" in run("readelf", "-d", shared), "the example loads no libpilotage_onboard.so.0")
        for row in rows:
            place = row["prior_lon_deg"], row["prior_lat_deg"]
            check(fly(shared, map_path, row, *place) == fly(example, map_path, row, *place), f"{row['file'].name}: not as static")

    code, words = fly(example, map_path, rows[0], 10.0, 50.0)
    check(code == 3 and "no_map" in words, words)
    check_refusal(words)
    code, words = fly(example, map_path, rows[0], "nan", 50.0)
    check(code == 3 and "bad_prior" in words, words)
    short = work / "short.pgm"
    short.write_bytes(b"P5\n800 450\n255\n" + bytes(100))
    code, words = run(example, map_path, short, *[0] * 7, "nan", expect=None)
    check(code == 1 and "short.pgm" in words, words)
    code, words = run(example, map_path, rows[0]["file"], *[0] * 7, "nan", "", expect=None)
    check(code == 1 and "public_key is empty" in words, words)
    run(example, expect=2)
    print(f"{fixes} of {len(rows)} fixes")


main(test)
