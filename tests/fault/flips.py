"""A signed map of the small mission, and flip_bytes upon it: flips.py PILOTAGE SOURCE FLIP_BYTES COUNT"""

import pathlib
import shutil
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "accept"))
from acceptance import SKIP, main, run  # noqa: E402


def flips(pilotage, source, work, rest):
    flip_bytes, count = rest
    for tool, package in (("minisign", "minisign"), ("gdal_translate", "gdal-bin")):
        if shutil.which(tool) is None:
            print(f"skipped: no {tool}: apt-get install {package}")
            sys.exit(SKIP)
    run("sh", source.resolve() / "tests/data/small_mission/make", cwd=work)
    run("minisign", "-G", "-W", "-f", "-p", "key.pub", "-s", "key.sec", cwd=work)
    run(pilotage.resolve(), "prepare", "mission.json", "-q", "-o", "out", cwd=work)
    run(pilotage.resolve(), "build", "out/plan.json", "--table", "out/tiles.csv", "--selection", "out/selection.json", "--sign-key", "key.sec",
        "-o", "map.gpkg", cwd=work)
    print(run(pathlib.Path(flip_bytes).resolve(), "map.gpkg", (work / "key.pub").read_text().split()[-1], count, 1, cwd=work))


main(flips)
