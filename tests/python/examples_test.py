"""The scripts of docs/examples/python, as their pages call them: each draws a picture that has something on it."""

import importlib.util
import os
import pathlib
import subprocess
import sys
import unittest

from given import MAP, PREPARED, InAFolder, write_gray_frames
from osgeo import gdal

EXAMPLES = pathlib.Path(__file__).parents[2] / "docs" / "examples" / "python"


class Examples(InAFolder):
    drawn = set()

    def draw(self, script, *arguments):
        picture = script.replace(".py", ".png")
        words = [picture if argument == "PICTURE" else str(argument) for argument in arguments]
        done = subprocess.run([sys.executable, "-B", EXAMPLES / script, *words], capture_output=True, text=True, check=False,
                              env={**os.environ, "MPLCONFIGDIR": str(self.folder / "matplotlib")})
        self.assertEqual(done.returncode, 0, done.stderr)
        pixels = gdal.Open(picture).ReadAsArray()[:3]
        self.assertGreaterEqual(pixels.shape[1:], (300, 600))
        white = (pixels == 255).all(axis=0).mean()
        self.assertGreater(white, 0.02)
        self.assertLess(white, 0.98, "nothing is drawn")
        self.drawn.add(script)
        return done.stdout

    def test_heat_map(self):
        self.draw("heat_map.py", PREPARED, "PICTURE")

    def test_match_frame(self):
        write_gray_frames()
        for name in ("frame0", "frame1", "frame2"):
            gdal.Translate(f"{name}.pgm", f"{name}.png", format="PNM")
        table = pathlib.Path("frames.csv").read_text(encoding="utf-8").replace(".png", ".pgm")
        pathlib.Path("frames.csv").write_text(table, encoding="utf-8")
        answers = [self.draw("match_frame.py", MAP, "frames.csv", number, "PICTURE") for number in range(3)]
        self.assertTrue(any(answer.startswith("fix 16.") for answer in answers), answers)

    def test_error_along_route(self):
        self.draw("error_along_route.py", PREPARED, "PICTURE")

    def test_heights(self):
        said = self.draw("heights.py", "ortho.tif", "PICTURE", 50, 60)
        self.assertIn("60 m: a fix may be expected", said)

    def test_inertial_grades(self):
        said = self.draw("inertial_grades.py", "mission.json", "PICTURE", 50)
        self.assertIn("tactical: ", said)

    @classmethod
    def tearDownClass(cls):
        missing = {path.name for path in EXAMPLES.glob("*.py")} - cls.drawn
        assert not missing, f"not run: {missing}"
        super().tearDownClass()


if __name__ == "__main__":
    if importlib.util.find_spec("matplotlib") is None:
        print("skipped: matplotlib is not installed: apt-get install python3-matplotlib")
        sys.exit(77)
    unittest.main()
