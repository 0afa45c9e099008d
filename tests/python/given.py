"""What the tests of the Python package begin with: the small mission, its map and its frames (tests/cli/make_given)."""

import json
import os
import pathlib
import shutil
import tempfile
import unittest

import numpy
from osgeo import gdal

gdal.UseExceptions()
GIVEN = pathlib.Path(os.environ["PILOTAGE_TEST_GIVEN"])
PREPARED = GIVEN / "prepared" / "out"
MAP = PREPARED / "map.gpkg"


class InAFolder(unittest.TestCase):
    """Each test in a folder of its own that holds the small mission."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.addCleanup(os.chdir, os.getcwd())
        shutil.copytree(GIVEN / "small_mission", folder.name, dirs_exist_ok=True)
        os.chdir(folder.name)
        self.folder = pathlib.Path(folder.name)
        self.mission = json.loads(pathlib.Path("mission.json").read_text(encoding="utf-8"))


def write_gray_frames():
    """The frames as gray pictures, and their table, in the working folder: what GDAL and the program see as the same pixels."""
    lines = (GIVEN / "frames" / "frames.csv").read_text(encoding="utf-8").splitlines()
    for name in ("frame0", "frame1", "frame2"):
        gdal.Translate(f"{name}.png", str(GIVEN / "frames" / f"{name}.jpg"), format="PNG", bandList=[2])
    pathlib.Path("frames.csv").write_text("\n".join(lines).replace(".jpg", ".png") + "\n", encoding="utf-8")


def pixels_of(path):
    return numpy.ascontiguousarray(gdal.Open(str(path)).ReadAsArray())
