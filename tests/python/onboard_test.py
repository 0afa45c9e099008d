"""Maps and matching: views without copies, the same answers as the program's, threads, and what is refused."""

import ast
import gc
import inspect
import os
import pathlib
import shutil
import signal
import subprocess
import tempfile
import threading
import unittest

import numpy
import pilotage
from given import MAP, InAFolder, pixels_of, write_gray_frames


class Maps(unittest.TestCase):
    def setUp(self):
        self.map = pilotage.Map(MAP)

    def test_say_what_they_are(self):
        self.assertEqual(self.map.name, str(MAP))
        self.assertGreaterEqual(self.map.info["schema_version"], 1)
        self.assertIn("tool_version", self.map.info["entries"])
        self.assertEqual(self.map.camera.width_px, 1000)
        self.assertEqual(self.map.purpose["mission_name"], None)
        level = self.map.levels[0]
        self.assertGreater(level["tile_size_px"] * level["gsd_m"], 10)

    def test_tiles_are_records(self):
        tiles = self.map.tiles()
        self.assertEqual(len(tiles), pilotage.verify(MAP)["tiles"])
        self.assertTrue((numpy.diff(tiles["tile_id"]) > 0).all())
        self.assertTrue((tiles["max_x_m"] > tiles["min_x_m"]).all())
        self.assertEqual(len(self.map.tiles(level=99)), 0)

    def test_near_is_nearest_first(self):
        tile = self.map.tiles()[3]
        near = self.map.near(tile["lon_deg"], tile["lat_deg"], 60)
        self.assertIn(tile["tile_id"], near["tile_id"][near["distance_m"] == 0])
        self.assertTrue((numpy.diff(near["distance_m"]) >= 0).all())
        self.assertEqual(len(self.map.near(lon_deg=10, lat_deg=10, radius_m=60)), 0)
        with self.assertRaises(pilotage.UsageError):
            self.map.near(10, 100, 60)

    def test_values_are_those_of_the_table(self):
        table = pilotage.read_table(MAP.with_name("tiles.csv"))
        tile_id = int(self.map.tiles()["tile_id"][0])
        row = table[table["tile_id"] == tile_id][0]
        values = self.map.tile_values(tile_id)
        for name in ("gray_variance", "p_correct_fix", "degraded_peak_margin"):
            self.assertAlmostEqual(values[name], row[name], places=6)
        self.assertEqual(values["status"], row["status"])
        with self.assertRaisesRegex(pilotage.UsageError, "tile_id = -7"):
            self.map.tile_values(-7)

    def test_descriptors_are_views_that_outlive_the_map(self):
        tile_id = int(self.map.tiles()["tile_id"][0])
        stored = self.map.descriptors(tile_id)
        keypoints, descriptors, heights = stored.keypoints, stored.descriptors, stored.ground_height_m
        self.assertEqual(keypoints.dtype.names, ("x_px", "y_px", "octave"))
        self.assertEqual(descriptors.shape[0], len(stored))
        for array in (keypoints, descriptors, heights):
            self.assertFalse(array.flags.owndata)
            self.assertFalse(array.flags.writeable)
        self.assertEqual(descriptors.__array_interface__["data"], self.map.descriptors(tile_id).descriptors.__array_interface__["data"])
        before = descriptors.copy(), keypoints["x_px"].copy(), heights.copy()
        points = stored.grid_points_m()
        tile = self.map.tiles()[0]
        self.assertTrue((points[:, 0] >= tile["min_x_m"]).all() and (points[:, 0] <= tile["max_x_m"]).all())
        self.assertTrue((points[:, 1] >= tile["min_y_m"]).all() and (points[:, 1] <= tile["max_y_m"]).all())
        del stored
        self.map = None
        gc.collect()
        for array, copy in zip((descriptors, keypoints["x_px"], heights), before):
            numpy.testing.assert_array_equal(array, copy)

    def test_what_is_not_there_is_none(self):
        self.assertIsNone(self.map.descriptors(-1))
        self.assertIsNone(self.map.descriptors(int(self.map.tiles()["tile_id"][0]), level=5))
        self.assertIsNone(self.map.chip(int(self.map.tiles()["tile_id"][0])))
        self.assertFalse(self.map.has_chips)

    def test_purpose_is_checked(self):
        self.map.check_purpose()
        with self.assertRaisesRegex(pilotage.IntegrityError, "harbour"):
            self.map.check_purpose(mission_name="harbour")
        with self.assertRaisesRegex(pilotage.UsageError, "now = \"tomorrow\""):
            self.map.check_purpose(now="tomorrow")

    def test_names_may_be_any_bytes(self):
        with tempfile.TemporaryDirectory() as folder:
            name = os.fsencode(folder) + b"/\xfe.gpkg"
            shutil.copyfile(MAP, name)
            map = pilotage.Map(name)
            self.assertEqual(os.fsencode(map.name), name)
            self.assertEqual(len(map.tiles()), len(self.map.tiles()))
            with self.assertRaises(pilotage.DataError):
                pilotage.Map(name + b"x")

    def test_of_another_process_are_refused(self):
        child = os.fork()
        if child == 0:
            try:
                self.map.tiles()
            except pilotage.UsageError as error:
                os._exit(0 if "forked" in str(error) else 2)
            os._exit(1)
        self.assertEqual(os.waitpid(child, 0)[1], 0)

    def test_files_that_are_none(self):
        with self.assertRaisesRegex(pilotage.DataError, "not a map database"):
            pilotage.Map(__file__)
        with self.assertRaisesRegex(pilotage.DataError, "map.gpkg.minisig: cannot be read"):
            pilotage.Map(MAP, trusted_keys=["RWQf6LRCGA9i53mlYecO4IzT51TGPpvWucNSCh1CBM0QTaLn73Y7GFO3"])


class Signed(InAFolder):
    def test_maps_open_with_their_key_alone(self):
        for name in ("ours", "others"):
            subprocess.run(["minisign", "-G", "-W", "-p", f"{name}.pub", "-s", f"{name}.sec"], check=True, stdout=subprocess.DEVNULL)
        pilotage.prepare("mission.json", output="out", flights=0, outputs="json", sign_key="ours.sec")
        self.assertEqual(len(pilotage.Map("out/map.gpkg", trusted_keys=["ours.pub"]).tiles()), len(pilotage.Map("out/map.gpkg").tiles()))
        for keys in ("ours.pub", b"ours.pub", pathlib.Path("ours.pub"), ["others.pub", pathlib.Path("ours.pub")]):
            pilotage.Map("out/map.gpkg", trusted_keys=keys)
        with self.assertRaises(pilotage.IntegrityError):
            pilotage.Map("out/map.gpkg", trusted_keys=["others.pub"])
        with self.assertRaisesRegex(pilotage.UsageError, "trusted_keys is empty"):
            pilotage.Map("out/map.gpkg", trusted_keys=[])


class Chips(InAFolder):
    def test_are_pictures(self):
        pilotage.prepare("mission.json", output="out", chips=True, flights=0)
        map = pilotage.Map("out/map.gpkg")
        self.assertTrue(map.has_chips)
        chip = map.chip(int(map.tiles()["tile_id"][0]))
        self.assertEqual(chip.gray.dtype, numpy.uint8)
        self.assertEqual(chip.gray.shape, chip.valid.shape)
        self.assertEqual(chip.gray.shape[1] * chip.factor, chip.window[2])
        self.assertGreater(chip.gray[chip.valid > 0].std(), 1)
        self.assertFalse(chip.gray.flags.owndata or chip.gray.flags.writeable)


def prior_of(row):
    return pilotage.Prior(lon_deg=row["prior_lon_deg"], lat_deg=row["prior_lat_deg"], sigma_m=row["prior_sigma_m"],
                          height_agl_m=row["height_agl_m"], yaw_deg=row["yaw_deg"], pitch_deg=row["pitch_deg"], roll_deg=row["roll_deg"])


class Matching(InAFolder):
    def setUp(self):
        super().setUp()
        write_gray_frames()
        self.rows = pilotage.read_table("frames.csv")
        self.frames = [pixels_of(name) for name in self.rows["file"]]

    def test_gives_what_the_program_gives(self):
        pilotage.match(MAP, frames="frames.csv", output="fixes.csv", timings=False)
        fixes = pilotage.read_table("fixes.csv")
        map = pilotage.Map(MAP)
        found = 0
        for row, frame, expected in zip(self.rows, self.frames, fixes):
            result = map.match(frame, prior_of(row))
            self.assertEqual(result.status, expected["status"])
            self.assertEqual(bool(result), result.status == "fix")
            self.assertEqual(result.stats.inliers, expected["inliers"])
            if not result:
                self.assertIsNone(result.fix)
                continue
            found += 1
            self.assertAlmostEqual(result.fix.lon_deg, expected["lon_deg"], places=8)
            self.assertAlmostEqual(result.fix.lat_deg, expected["lat_deg"], places=8)
            self.assertAlmostEqual(result.fix.covariance_en_m2[0, 0] ** 0.5, expected["east_sigma_m"], places=3)
            self.assertEqual(set(result.fix.to_dict()), set(type(result.fix)._fields))
        self.assertGreater(found, 0, "nothing was found: nothing was compared")

    def test_several_maps_are_asked(self):
        map, other, prior = pilotage.Map(MAP), pilotage.Map(MAP), prior_of(self.rows[0])
        alone = map.match(self.frames[0], prior)
        self.assertEqual(alone.map_index, 0)
        both = map.match(self.frames[0], prior, also_maps=[other])
        self.assertAlmostEqual(1 - both.stats.confidence, 2 * (1 - alone.stats.confidence), places=9)
        self.assertEqual(both.stats.vote_peak, alone.stats.vote_peak)
        self.assertEqual((alone.map_statuses, both.map_statuses), ([alone.status], [alone.status] * 2))
        with self.assertRaisesRegex(TypeError, "None is no Map"):
            map.match(self.frames[0], prior, also_maps=[None])
        for twice in ([map], [other, other]):
            with self.assertRaisesRegex(pilotage.UsageError, "stands there twice"):
                map.match(self.frames[0], prior, also_maps=twice)
        # Threads that ask the same maps in another order do not wait for each other for ever.
        threads = [threading.Thread(target=lambda a=a, b=b: [a.match(self.frames[0], prior, also_maps=[b]) for _ in range(5)], daemon=True)
                   for a, b in ((map, other), (other, map))]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join(60)
            self.assertFalse(thread.is_alive())

    def test_frames_are_taken_where_they_lie(self):
        map = pilotage.Map(MAP)
        padded = numpy.zeros((562, 1100), numpy.uint8)
        padded[:, 40:1040] = self.frames[0]
        a = map.match(padded[:, 40:1040], prior_of(self.rows[0]))
        b = map.match(self.frames[0], prior_of(self.rows[0]))
        self.assertEqual(a.stats.to_dict(), b.stats.to_dict())

    def test_frames_that_are_no_gray_picture(self):
        map, prior = pilotage.Map(MAP), prior_of(self.rows[0])
        for frame, pattern in ((self.frames[0].astype(float), "uint8"), (self.frames[0][:, ::2], "ascontiguousarray"),
                               (self.frames[0][::-1], "ascontiguousarray"), (numpy.stack([self.frames[0]] * 3), "3 dimensions"),
                               (self.frames[0].astype(numpy.int8), "int8")):
            with self.assertRaisesRegex(TypeError, pattern):
                map.match(frame, prior)
        self.assertEqual(map.match(numpy.zeros((0, 0), numpy.uint8), prior).status, "bad_frame")
        self.assertEqual(map.match(self.frames[0][:300], prior).status, "bad_frame")
        self.assertEqual(map.match(self.frames[0], prior, camera=map.camera.for_size(500, 281)).status, "bad_frame")

    def test_options_are_the_librarys(self):
        map, prior = pilotage.Map(MAP), prior_of(self.rows[0])
        self.assertEqual(map.match(self.frames[0], prior, deadline_ms=0).status, "out_of_time")
        with self.assertRaisesRegex(pilotage.UsageError, r"max_false_fix_rate = 2 is outside \[1e-06, 0.5\]"):
            map.match(self.frames[0], prior, max_false_fix_rate=2)
        with self.assertRaisesRegex(TypeError, "unexpected keyword argument 'max_false_rate'"):
            map.match(self.frames[0], prior, max_false_rate=0.01)
        with self.assertRaisesRegex(TypeError, "chips must be True or False, not int"):
            map.match(self.frames[0], prior, chips=1)
        for name in ("search_sigmas", "max_false_fix_rate", "landmarks"):
            self.assertIn(f"{name}: ", pilotage.Map.match.__doc__)

    def test_none_is_not_given(self):
        map, prior = pilotage.Map(MAP), prior_of(self.rows[0])
        self.assertEqual(map.match(self.frames[0], prior, chips=None).stats.to_dict(), map.match(self.frames[0], prior).stats.to_dict())

    def test_handlers_of_signals_find_the_map_in_use(self):
        map, row = pilotage.Map(MAP), self.rows[0]
        prior = pilotage.Prior(lon_deg=row["prior_lon_deg"], lat_deg=row["prior_lat_deg"], sigma_m=100, height_agl_m=row["height_agl_m"])
        before = signal.signal(signal.SIGALRM, lambda number, frame: map.tiles())
        self.addCleanup(signal.signal, signal.SIGALRM, before)
        # A heading that is not known takes seconds, in which signals are asked for each 50 ms; one that comes behind the last time
        # finds the map free, so there are several.
        self.addCleanup(signal.setitimer, signal.ITIMER_REAL, 0)
        signal.setitimer(signal.ITIMER_REAL, 0.05, 0.05)
        with self.assertRaisesRegex(pilotage.UsageError, "is being matched by this thread"):
            map.match(self.frames[0], prior, yaw_sigma_deg=180)
        signal.setitimer(signal.ITIMER_REAL, 0)
        self.assertGreater(len(map.tiles()), 0)

    def test_a_wider_prior_by_its_covariance(self):
        row = self.rows[0]
        prior = pilotage.Prior(lon_deg=row["prior_lon_deg"], lat_deg=row["prior_lat_deg"], covariance_en_m2=[[100, 0], [0, 100]],
                               height_agl_m=row["height_agl_m"], yaw_deg=row["yaw_deg"], pitch_deg=row["pitch_deg"], roll_deg=row["roll_deg"])
        map = pilotage.Map(MAP)
        self.assertEqual(map.match(self.frames[0], prior).stats.to_dict(), map.match(self.frames[0], prior_of(row)).stats.to_dict())
        with self.assertRaisesRegex(pilotage.UsageError, "one of the two"):
            pilotage.Prior(lon_deg=0, lat_deg=0, height_agl_m=60)
        with self.assertRaisesRegex(pilotage.UsageError, "sigma_m = -1 is no standard deviation"):
            pilotage.Prior(lon_deg=0, lat_deg=0, height_agl_m=60, sigma_m=-1)
        with self.assertRaisesRegex(pilotage.UsageError, "no 2 x 2 matrix"):
            pilotage.Prior(lon_deg=0, lat_deg=0, height_agl_m=60, covariance_en_m2=[1, 2, 3])

    def test_threads_share_a_map(self):
        map = pilotage.Map(MAP)
        expected = [map.match(frame, prior_of(row)).stats.to_dict() for frame, row in zip(self.frames, self.rows)]
        answers = {}

        def work(number):
            answers[number] = [map.match(frame, prior_of(row)).stats.to_dict() for frame, row in zip(self.frames, self.rows)]

        threads = [threading.Thread(target=work, args=(number,)) for number in range(4)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual([answers[number] for number in range(4)], [expected] * 4)


class Cameras(unittest.TestCase):
    def test_are_checked(self):
        camera = pilotage.Camera(width_px=640, height_px=480, fx_px=500, fy_px=500, cx_px=320, cy_px=240)
        self.assertEqual(camera, camera.for_size(640, 480))
        self.assertEqual(camera.for_size(320, 240).fx_px, 250)
        lens = pilotage.Camera(width_px=640, height_px=480, fx_px=500.5, fy_px=500, cx_px=320, cy_px=240, distortion_model="fisheye",
                               distortion=[0.1, -0.02], mount_pitch_deg=30)
        self.assertEqual(eval(repr(lens), {"Camera": pilotage.Camera}), lens)
        with self.assertRaisesRegex(pilotage.UsageError, "fx"):
            pilotage.Camera(width_px=640, height_px=480, fx_px=-1, fy_px=500, cx_px=320, cy_px=240)
        with self.assertRaisesRegex(pilotage.UsageError, "pinhole"):
            pilotage.Camera(width_px=640, height_px=480, fx_px=1, fy_px=500, cx_px=320, cy_px=240, distortion_model="pinhole")
        with self.assertRaises(pilotage.DataError):
            camera.for_size(640, 640)


class Stub(unittest.TestCase):
    """_onboard.pyi says what the module has, no more and no less."""

    def test_has_the_modules_classes_and_members(self):
        stub = pathlib.Path(pilotage.__file__).with_name("_onboard.pyi")
        classes = {node.name: node for node in ast.parse(stub.read_text(encoding="utf-8")).body if isinstance(node, ast.ClassDef)}
        bound = {name: value for name, value in vars(pilotage._onboard).items() if inspect.isclass(value)}
        self.assertEqual(set(classes), set(bound))
        for name, node in classes.items():
            stubbed = {item.name for item in node.body if isinstance(item, ast.FunctionDef)} - {"__init__", "__bool__", "__len__"}
            members = {member for member in vars(bound[name]) if not member.startswith("_")}
            self.assertEqual(stubbed, members, name)

    def test_matching_has_the_described_options(self):
        stub = pathlib.Path(pilotage.__file__).with_name("_onboard.pyi").read_text(encoding="utf-8")
        self.assertIn("max_false_fix_rate: float = ...", stub)
        self.assertIn("chips: bool = ...", stub)
        self.assertNotIn("@", stub.replace("@property", ""))


if __name__ == "__main__":
    unittest.main()
