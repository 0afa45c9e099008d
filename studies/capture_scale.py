"""What `capture` costs by the number of frames: 12-megapixel JPEGs drawn from the sample's imagery, at one overlap. Run by
hand; judges nothing.

capture_scale.py PILOTAGE CUT_FLIGHT_FRAMES [COUNT...] --work DIR      default: 50 100 200 400

Frames of 400 m x 300 m at random places of a part of the imagery as large as their number asks, drawn at 1000 x 750 px
and enlarged to 4000 x 3000: as much to decode and to find features in as a camera's, though softer. What is in DIR already
is not drawn again. Prints wall time, CPU time and the largest resident size of each run, and the exponent between runs."""

import argparse
import math
import os
import pathlib
import resource
import subprocess
import sys
import time

sys.path.append(str(pathlib.Path(__file__).resolve().parents[1] / "tests/accept"))  # helpers shared with the tests
from acceptance import need_gdal, run  # noqa: E402

gdal = need_gdal()

SAMPLE = pathlib.Path(__file__).resolve().parents[1] / "maps/sample/ortho.tif"
GSD_M = 0.5
FRAME_M2 = 400 * 300
OVERLAPPING = 8  # frames over one place, on average
CAMERA = ("--camera-hfov-deg", "60", "--camera-width-px", "4000", "--camera-height-px", "3000", "--leave-out")


def draw(cut_flight_frames, folder, count):
    if (folder / "done").exists():
        return
    folder.mkdir(parents=True, exist_ok=True)
    whole = gdal.Open(str(SAMPLE))
    share = min(1, math.sqrt(count * FRAME_M2 / OVERLAPPING / (whole.RasterXSize * whole.RasterYSize * GSD_M**2)))
    size = [int(share * side) for side in (whole.RasterXSize, whole.RasterYSize)]
    gdal.Translate(str(folder / "part.tif"), whole, srcWin=[0, 0, *size])
    run(cut_flight_frames, folder / "part.tif", "--frames", count, "--footprint-m", 400, "--width-px", 1000, "--height-px", 750,
        "--prior-offset-m", 3, "--prior-sigma-m", 2, "-o", folder / "small")
    table = (folder / "small/frames.csv").read_text().splitlines()
    for line in table[1:]:
        name = line.split(",")[0]
        options = gdal.TranslateOptions(format="JPEG", width=4000, height=3000, resampleAlg="cubic",
                                        creationOptions=["QUALITY=92"])
        large = pathlib.Path(name).with_suffix(".jpg").name
        gdal.Translate(str(folder / large), str(folder / "small" / name), options=options)
        (folder / (large + ".aux.xml")).unlink(missing_ok=True)
    lines = [table[0]] + [pathlib.Path(line.split(",")[0]).with_suffix(".jpg").name + line[line.index(","):] for line in table[1:]]
    (folder / "frames.csv").write_text("\n".join(lines) + "\n")
    (folder / "done").touch()


def measure(pilotage, folder):
    """Wall seconds, CPU seconds, largest resident size in GiB, and what the run said."""
    command = [str(pilotage), "capture", str(folder / "frames.csv"), *CAMERA, "-o", str(folder / "map.tif"), "--overwrite", "-q"]
    start = time.monotonic()
    with open(folder / "said.txt", "w", encoding="utf-8") as said:
        process = subprocess.Popen(command, stdout=said)
        _, status, usage = os.wait4(process.pid, 0)
    if status != 0:
        sys.exit(f"{' '.join(command)}: ended with {status}")
    return time.monotonic() - start, usage.ru_utime + usage.ru_stime, usage.ru_maxrss / 2**20, (folder / "said.txt").read_text()


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("pilotage", type=pathlib.Path)
    parser.add_argument("cut_flight_frames", type=pathlib.Path)
    parser.add_argument("--work", type=pathlib.Path, required=True)
    parser.add_argument("counts", type=int, nargs="*", default=[50, 100, 200, 400])
    given = parser.parse_args()
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    before = None
    for count in given.counts:
        folder = given.work / str(count)
        draw(given.cut_flight_frames, folder, count)
        wall_s, cpu_s, gib, said = measure(given.pilotage, folder)
        exponent = f", as the number to the power {math.log(wall_s / before[1]) / math.log(count / before[0]):.2f}" if before else ""
        print(f"{count} frames: {wall_s:.0f} s, {cpu_s:.0f} s of CPU, {gib:.2f} GiB{exponent}", flush=True)
        print("  " + "\n  ".join(said.splitlines()[:3]), flush=True)
        before = (count, wall_s)


if __name__ == "__main__":
    main()
