"""The plugin for QGIS, as it is packed, in QGIS itself: parameters, results, layers with their styles, progress, cancelling, errors.

plugin_in_qgis.py PILOTAGE SOURCE_FOLDER"""

import os
import pathlib
import subprocess
import sys
import zipfile

from acceptance import SKIP, check, main, run


def check_archive(source, work):
    """Packed twice: the same bytes; a plugin as QGIS looks for it."""
    for name in ("plugin.zip", "again.zip"):
        run("/usr/bin/python3", source / "tools/write-qgis-plugin", name, cwd=work)
    check((work / "plugin.zip").read_bytes() == (work / "again.zip").read_bytes(), "the plugin is not the same twice")
    with zipfile.ZipFile(work / "plugin.zip") as packed:
        packed.extractall(work)
        metadata = packed.read("pilotage_processing/metadata.txt").decode()
    check("\nversion=@" not in metadata and "\nhasProcessingProvider=yes\n" in metadata, metadata)


def test(pilotage, source, work, arguments):
    check_archive(source, work)
    # Looked for as files: importing QGIS loads a hundred libraries.
    if not pathlib.Path("/usr/share/qgis/python/plugins/processing").exists():
        print("skipped: QGIS's Processing is not installed: apt-get install python3-qgis")
        sys.exit(SKIP)
    if not (source / "maps/sample/ortho.tif").exists():
        print("skipped: maps/sample/ortho.tif is not there; the build makes it")
        sys.exit(SKIP)
    mission, ran, home = work / "mission", work / "ran", work / "home"
    for folder in (mission, ran, home):
        folder.mkdir(mode=0o700)
    run("sh", source / "tests/data/small_mission/make", cwd=mission)
    done = subprocess.run(["/usr/bin/python3", "-B", str(source / "tests/gis/check_plugin_in_qgis.py"), str(work), str(mission)], text=True, cwd=ran,
                          stdout=subprocess.PIPE, stderr=subprocess.PIPE, check=False, timeout=600,
                          env=dict(os.environ, QT_QPA_PLATFORM="offscreen", XDG_RUNTIME_DIR=str(home), HOME=str(home), PILOTAGE_PROGRAM=str(pilotage)))
    check(done.returncode == 0 and "checked in QGIS 3." in done.stdout, f"exit {done.returncode}\n{done.stdout}\n{done.stderr[-2000:]}")
    print(done.stdout.strip())


main(test)
