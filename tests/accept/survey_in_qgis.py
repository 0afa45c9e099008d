"""What QGIS itself makes of the files of `pilotage survey`: each comes up styled, and tiles are drawn in the colour of their class.

survey_in_qgis.py PILOTAGE SOURCE_FOLDER FOLDER_OF_PICTURES"""

import os
import pathlib
import shutil
import subprocess
import sys

from acceptance import SKIP, check, main, run

# Looked for as files: importing QGIS loads a hundred libraries.
if not pathlib.Path("/usr/lib/python3/dist-packages/qgis/core").exists():
    print("skipped: QGIS is not installed: apt-get install python3-qgis")
    sys.exit(SKIP)
if shutil.which("gdal_translate") is None:
    print("skipped: no gdal_translate: apt-get install gdal-bin")
    sys.exit(SKIP)


def test(pilotage, source, work, arguments):
    if not (source / "maps/sample/ortho.tif").exists():
        print("skipped: maps/sample/ortho.tif is not there; the build makes it")
        sys.exit(SKIP)
    pictures = pathlib.Path(arguments[0])
    pictures.mkdir(parents=True, exist_ok=True)
    run("sh", source / "tests/data/small_mission/make", cwd=work)
    run(pilotage, "survey", "ortho.tif", "--elevation", "elevation.tif", "--camera-hfov-deg", "73.7", "--camera-width-px", "1000",
        "--camera-height-px", "562", "--agl-m", "60", "-o", "area", "-q", cwd=work)
    home = work / "home"
    home.mkdir(mode=0o700)
    done = subprocess.run(["/usr/bin/python3", str(source / "tests/gis/check_in_qgis.py"), str(work / "area"), str(pictures)], text=True,
                          stdout=subprocess.PIPE, stderr=subprocess.PIPE, check=False, timeout=300,
                          env=dict(os.environ, QT_QPA_PLATFORM="offscreen", XDG_RUNTIME_DIR=str(home), HOME=str(home)))
    check(done.returncode == 0 and "checked in QGIS 3." in done.stdout, f"exit {done.returncode}\n{done.stdout}\n{done.stderr[-2000:]}")
    print(done.stdout.strip())


main(test)
