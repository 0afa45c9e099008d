"""The node of docs/examples/ros2, compiled against stand-ins of ROS 2's headers: what it publishes of frames of the sample's second
date, held against the program's own match.

ros2_example.py PILOTAGE SOURCE_FOLDER CUT_FLIGHT_FRAMES INSTALLED GENERATOR CXX LAUNCHER SANITIZERS"""

import csv
import json
import math
import subprocess
import sys

from acceptance import SKIP, check, main, run
from library_user import Toolchain
from whole_map import make_whole_map

CAMERA = (73.7, 800, 450)  # degrees, pixels
FOOTPRINT_M = 180


def test(pilotage, source, work, rest):
    cut, installed, *tools = rest
    if not (source / "maps/sample/ortho_second_epoch.tif").exists():
        print("skipped: the sample mission's imagery is not made: cmake --build … --target sample_mission")
        sys.exit(SKIP)
    run("cmake", "-S", source / "tests/accept/ros2", "-B", work / "node", f"-DCMAKE_PREFIX_PATH={installed}/onboard", *Toolchain(*tools).options)
    run("cmake", "--build", work / "node")
    map_path = work / "map.gpkg"
    make_whole_map(pilotage, source / "maps/sample/ortho.tif", map_path, (FOOTPRINT_M,), CAMERA)
    hfov_deg, width_px, height_px = CAMERA
    run(cut, source / "maps/sample/ortho_second_epoch.tif", "--hfov-deg", hfov_deg, "--width-px", width_px, "--height-px", height_px,
        "--footprint-m", FOOTPRINT_M, "--frames", 8, "--format", "pgm", "--prior-offset-m", 10, "--prior-sigma-m", 12, "-o", work / "frames")
    with open(work / "frames/frames.csv", newline="") as stream:
        rows = list(csv.DictReader(stream))

    def line(row, without="nothing"):
        return " ".join([without, str(work / "frames" / row["file"]), *(row[name] for name in (
            "prior_lon_deg", "prior_lat_deg", "prior_sigma_m", "height_agl_m", "yaw_deg", "pitch_deg", "roll_deg"))])

    def fly(lines):
        done = subprocess.run([work / "node/drive_node", map_path], input="\n".join(lines) + "\n", capture_output=True, text=True)
        check(done.returncode == 0, done.stdout + done.stderr)
        return [json.loads(text) for text in done.stdout.splitlines()]

    fixes = 0
    for row, said in zip(rows, fly([line(row) for row in rows])):
        given = [float(row[name]) for name in ("yaw_deg", "pitch_deg", "roll_deg")]
        check(max(abs((a - b + 180) % 360 - 180) for a, b in zip(said["attitude"], given)) < 1e-5, f"{said['attitude']} of {given}")
        fix = said["fix"]
        check((fix["stamp"], fix["frame"]) == ([1900000000, 250000000], "base_link"), str(fix))
        if fix["status"] < 0:
            check(said["level"] == 1 and "aux" not in said and not said["message"].startswith("fix"), str(said))
            continue
        fixes += 1
        check(said["level"] == 0 and said["message"].startswith("fix: ") and said["values"] == 4, str(said))
        aux = said["aux"]
        off_m = math.hypot((fix["lat"] - float(row["true_nadir_lat_deg"])) * 111320,
                           (fix["lon"] - float(row["true_nadir_lon_deg"])) * 111320 * math.cos(math.radians(fix["lat"])))
        check(off_m < max(8, 4 * aux["eph"]), f"{off_m} m off, {aux}")
        check(fix["type"] == 3 and fix["altitude"] == 170 and fix["east_m2"] <= aux["eph"]**2 + 1e-3, str(said))
        check((aux["lon"], aux["lat"]) == (fix["lon"], fix["lat"]), str(said))
        check((aux["sample"], aux["timestamp"]) == (1900000000250000, 1900000000500000), "µs of exposure and of now")
        check((aux["id"], aux["source"], aux["alt"], aux["epv"], aux["resets"]) == (3, 2, 138.5, 4, 0), str(aux))
    check(fixes >= 4, f"{fixes} fixes of {len(rows)}")

    for without, said in zip(("attitude", "late", "color", "range"), fly([line(rows[0], word) for word in ("attitude", "late", "color", "range")])):
        reason = {"attitude": "no attitude", "late": "no prior position", "color": "a picture in bgr8", "range": "no range"}[without]
        check("fix" not in said and said["level"] == 2 and said["message"].startswith(f"not tried: {reason}"), f"without {without}: {said}")
    done = subprocess.run([work / "node/drive_node"], input=line(rows[0]) + "\n", capture_output=True, text=True)
    check(done.returncode == 1 and "parameter map" in done.stdout, done.stdout)


main(test)
