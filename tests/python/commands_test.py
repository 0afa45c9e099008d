"""Functions of the program's commands: their arguments, results, errors, progress, and how they are ended."""

import inspect
import json
import os
import pathlib
import pickle
import re
import signal
import subprocess
import sys
import threading
import time
import unittest
import warnings

import numpy
import pilotage
from given import MAP, InAFolder, write_gray_frames

PROGRAM = os.environ["PILOTAGE_PROGRAM"]


class Arguments(unittest.TestCase):
    def test_are_those_of_the_described_options(self):
        described = json.loads(subprocess.run([PROGRAM, "manual", "--format", "json"], check=True, capture_output=True).stdout)
        self.assertEqual(len(described["commands"]), len(pilotage.commands.__all__))
        for command in described["commands"]:
            function = getattr(pilotage, command["word"].replace("-", "_"))
            parameters = inspect.signature(function).parameters
            flags = {option["flag"] for section in command["sections"] for option in section["options"]}
            flags -= {"--print-config", "--print-schema", "--json", "--quiet", "--progress"}
            keywords = {name for name, parameter in parameters.items() if parameter.kind is inspect.Parameter.KEYWORD_ONLY}
            self.assertEqual({"--" + name.rstrip("_").replace("_", "-") for name in keywords - {"progress"}}, flags, command["word"])
            for section in command["sections"]:
                for option in section["options"]:
                    if option["flag"] in flags and option["name"] not in ("output", "config"):
                        word = option["help"].replace("Exit", "Throw").split()[0]
                        self.assertRegex(function.__doc__, rf"(?m)^ +{option['flag'][2:].replace('-', '_')}_?: {re.escape(word)}")
            typed = re.findall("--[a-z][a-z0-9-]*|Exit with", re.sub("`[^`]*`", "", function.__doc__))  # back quotes: for the command line
            self.assertEqual([word for word in typed if word in {*flags, "Exit with"}], [], command["word"])

    def test_of_the_terminal_are_none_of_python(self):
        for name in ("print_config", "print_schema", "json", "quiet"):
            self.assertNotIn(name, inspect.signature(pilotage.prepare).parameters)

    def test_keywords_of_python_get_an_underscore(self):
        self.assertIn("from_", inspect.signature(pilotage.reroute).parameters)

    def test_say_units_ranges_and_defaults(self):
        self.assertRegex(pilotage.score.__doc__, r"tile_size_px: Side of a square tile\. .* \[pixels; 2 to 4096\]")
        self.assertEqual(str(inspect.signature(pilotage.score).parameters["tile_size_px"].annotation), "int | None")
        self.assertIn("'tactical'", inspect.signature(pilotage.prepare).parameters["ins_grade"].annotation)


class Results(InAFolder):
    def test_are_what_the_program_prints(self):
        result = pilotage.tile("mission.json", output="plan.json")
        printed = subprocess.run([PROGRAM, "tile", "mission.json", "--json", "-o", "typed.json"], check=True, capture_output=True).stdout
        expected = json.loads(printed)
        self.assertEqual({**result, "output": ""}, {**expected, "output": ""})
        self.assertEqual(pathlib.Path("plan.json").read_bytes(), pathlib.Path("typed.json").read_bytes())
        self.assertEqual(result.command[1], "tile")

    def test_arguments_win_over_the_mission_file_and_a_dict_is_one(self):
        mission = self.mission
        pilotage.tile("mission.json", output="a.json", agl_m=80, camera_hfov_deg=60.0)
        pilotage.tile({**mission, "agl_m": 80, "camera": {**mission["camera"], "hfov_deg": 60}}, output=pathlib.Path("b.json"))
        self.assertEqual(pathlib.Path("a.json").read_bytes(), pathlib.Path("b.json").read_bytes())
        pilotage.tile("mission.json", output="c.json")
        self.assertNotEqual(pathlib.Path("a.json").read_bytes(), pathlib.Path("c.json").read_bytes())

    def test_stages_follow_each_other(self):
        pilotage.tile("mission.json", output="plan.json")
        pilotage.score("plan.json", output="scores.tif", table="tiles.csv", measures=["gray_variance", "frieden_entropy"])
        selection = pilotage.select("plan.json", table="tiles.csv", output="selection.json")
        built = pilotage.build("plan.json", table="tiles.csv", selection="selection.json", output="map.gpkg")
        self.assertEqual(built["tiles"], selection["selected_tiles"])
        self.assertEqual(len(pilotage.Map("map.gpkg").tiles()), built["tiles"])
        self.assertTrue(pilotage.verify("map.gpkg")["intact"])

    def test_a_dict_may_hold_paths_and_numpys_numbers(self):
        pilotage.tile("mission.json", output="a.json", agl_m=80)
        pilotage.tile({**self.mission, "agl_m": numpy.float32(80), "imagery": [pathlib.Path("ortho.tif")], "max_error_m": numpy.int64(20)},
                      output="b.json")
        self.assertEqual(pathlib.Path("a.json").read_bytes(), pathlib.Path("b.json").read_bytes())
        with self.assertRaisesRegex(pilotage.UsageError, "mission holds what JSON cannot"):
            pilotage.tile({**self.mission, "agl_m": float("nan")}, output="c.json")
        with self.assertRaisesRegex(pilotage.UsageError, "mission holds what JSON cannot"):
            pilotage.tile({**self.mission, "imagery": [b"\xfe.tif"]}, output="c.json")
        with self.assertRaisesRegex(TypeError, "mission holds a set"):
            pilotage.tile({**self.mission, "imagery": {"ortho.tif"}}, output="c.json")

    def test_numpys_numbers_are_numbers(self):
        pilotage.tile("mission.json", output="a.json", agl_m=numpy.float32(80), overwrite=numpy.True_)
        pilotage.tile("mission.json", output="b.json", agl_m=80)
        self.assertEqual(pathlib.Path("a.json").read_bytes(), pathlib.Path("b.json").read_bytes())

    def test_list_of_rasters_and_one_alone(self):
        options = {"tile_size_px": 128, "stride_px": 128, "measures": "gray_variance"}
        pilotage.score("ortho.tif", output="one.tif", table="one.csv", **options)
        pilotage.score(["ortho.tif"], output="list.tif", table="list.csv", **options)
        self.assertEqual(pathlib.Path("one.csv").read_bytes(), pathlib.Path("list.csv").read_bytes())

    def test_warnings_are_pythons(self):
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            pilotage.tile("mission.json", output="plan.json")
            pilotage.score("plan.json", output="scores.tif", table="tiles.csv", measures="gray_variance")
            pilotage.select("plan.json", table="tiles.csv", output="selection.json")
            result = pilotage.build("plan.json", table="tiles.csv", selection="selection.json", second_epoch="ortho.tif", output="map.gpkg")
        self.assertEqual(result["warnings"], ["--second-epoch changes no feature without --keep-features stable"])
        caught = [warning for warning in caught if "second_epoch" in str(warning.message)]
        self.assertEqual([str(warning.message) for warning in caught], ["second_epoch changes no feature without keep_features stable"])
        self.assertTrue(all(warning.category is pilotage.PilotageWarning for warning in caught))
        self.assertTrue(all(warning.filename == __file__ for warning in caught))


class Errors(InAFolder):
    def expect(self, kind, pattern, call):
        with self.assertRaisesRegex(kind, pattern) as caught:
            call()
        self.assertIs(type(caught.exception), kind)

    def test_have_the_kinds_of_the_library(self):
        self.expect(pilotage.UsageError, r"^agl_m = -3 is outside \[1, 30000\]$",
                    lambda: pilotage.tile("mission.json", output="plan.json", agl_m=-3))
        self.expect(pilotage.UsageError, r"^ins_grade = \"tactica\" is not one of: .*did you mean \"tactical\"",
                    lambda: pilotage.tile("mission.json", output="plan.json", ins_grade="tactica"))
        self.expect(pilotage.DataError, r"nowhere\.tif", lambda: pilotage.tile("mission.json", output="plan.json", imagery="nowhere.tif"))
        damaged = MAP.read_bytes()
        at = damaged.index(b"pilotage 0.")  # the tool's version, which the digest covers
        pathlib.Path("damaged.gpkg").write_bytes(damaged[:at] + b"P" + damaged[at + 1:])
        with self.assertRaises(pilotage.IntegrityError) as caught:
            pilotage.verify("damaged.gpkg")
        self.assertFalse(caught.exception.result["intact"])
        self.assertTrue(issubclass(pilotage.IntegrityError, pilotage.DataError))
        self.assertTrue(issubclass(pilotage.UsageError, ValueError))

    def test_of_a_dict_name_the_argument(self):
        self.expect(pilotage.UsageError, r'^mission: unknown key "camera\.hfov_degg"; did you mean',
                    lambda: pilotage.tile({"camera": {"hfov_degg": 60}}, output="plan.json"))
        self.expect(pilotage.UsageError, r'^config: unknown key "tile_sise_px"',
                    lambda: pilotage.score("ortho.tif", config={"tile_sise_px": 64}, output="scores.tif"))

    def test_say_what_python_should_give(self):
        pathlib.Path("plan.json").touch()
        self.expect(pilotage.DataError, r"plan\.json: exists already; give overwrite=True to replace it",
                    lambda: pilotage.tile("mission.json", output="plan.json"))

    def test_of_types_come_before_any_work(self):
        for call, pattern in (
                (lambda: pilotage.score("ortho.tif", output="s.tif", tile_size_px=64.5), "tile_size_px must be an integer, not float"),
                (lambda: pilotage.score("ortho.tif", output="s.tif", tile_size_px="64"), "tile_size_px must be an integer, not str"),
                (lambda: pilotage.tile("mission.json", output="p.json", agl_m="60"), "agl_m must be a number, not str"),
                (lambda: pilotage.tile("mission.json", output="p.json", agl_m=True), "agl_m must be a number, not bool"),
                (lambda: pilotage.tile("mission.json", output="p.json", agl_m=numpy.True_), "agl_m must be a number, not bool"),
                (lambda: pilotage.tile("mission.json", output="p.json", progress=True), "progress must be a function"),
                (lambda: pilotage.tile("mission.json", output="p.json", overwrite=1), "overwrite must be True or False, not int"),
                (lambda: pilotage.tile("mission.json", output=3), "output must be a path, not int"),
                (lambda: pilotage.tile("mission.json", output="p.json", tile_sise_px=3), "unexpected keyword argument 'tile_sise_px'"),
                (lambda: pilotage.tile("mission.json"), "missing 1 required keyword-only argument: 'output'")):
            self.expect(TypeError, pattern, call)

    def test_nothing_in_a_list_is_no_choice(self):
        for call in (lambda: pilotage.tile("mission.json", output="p.json", imagery=[]), lambda: pilotage.tile("mission.json", output="p.json", imagery=[""]),
                     lambda: pilotage.score("ortho.tif", output="s.tif", measures=[])):
            self.expect(pilotage.UsageError, "^(imagery|measures) (is empty|holds an empty text); leave it out", call)

    def test_standard_streams_are_refused(self):
        self.expect(pilotage.UsageError, "standard input and output are for the command line", lambda: pilotage.tile("-", output="plan.json"))
        self.expect(pilotage.UsageError, "standard input and output are for the command line",
                    lambda: pilotage.tile("mission.json", output="-"))

    def test_gate_keeps_the_result(self):
        write_gray_frames()
        rows = pathlib.Path("frames.csv").read_text(encoding="utf-8").replace("16.49", "15.49").replace("16.50", "15.50")
        pathlib.Path("frames.csv").write_text(rows, encoding="utf-8")  # beside the map
        with self.assertRaises(pilotage.GateNotMet) as caught:
            pilotage.match(MAP, frames="frames.csv", output="fixes.csv", require_fix=True)
        self.assertEqual(caught.exception.result["output"], "fixes.csv")
        again = pickle.loads(pickle.dumps(caught.exception))
        self.assertEqual((str(again), again.result, again.result.command),
                         (str(caught.exception), caught.exception.result, caught.exception.result.command))
        self.assertTrue(pathlib.Path("fixes.csv").exists())

    def test_program_of_another_version_is_refused(self):
        other = self.folder / "other"
        other.write_text("#!/bin/sh\necho pilotage 0.0.1\n", encoding="utf-8")
        other.chmod(0o755)
        os.environ["PILOTAGE_PROGRAM"] = str(other)
        self.addCleanup(os.environ.__setitem__, "PILOTAGE_PROGRAM", PROGRAM)
        self.expect(pilotage.DataError, r'other: is "pilotage 0\.0\.1", but this module is of pilotage ',
                    lambda: pilotage.tile("mission.json", output="plan.json"))
        other.unlink()
        other.symlink_to(PROGRAM)  # the right one is installed
        pilotage.tile("mission.json", output="plan.json")
        os.environ["PILOTAGE_PROGRAM"] = "no_such_program"
        self.expect(pilotage.DataError, "no_such_program: is no program", lambda: pilotage.tile("mission.json", output="plan.json"))

    def test_program_that_dies_is_told(self):
        other = self.folder / "other"
        other.write_text(f'#!/bin/sh\n[ "$1" = --version ] && exec "{PROGRAM}" --version\necho last words >&2\nkill -9 $$\n', encoding="utf-8")
        other.chmod(0o755)
        os.environ["PILOTAGE_PROGRAM"] = str(other)
        self.addCleanup(os.environ.__setitem__, "PILOTAGE_PROGRAM", PROGRAM)
        self.expect(pilotage.InternalError, "pilotage tile was ended by signal 9: last words",
                    lambda: pilotage.tile("mission.json", output="plan.json"))


class Progress(InAFolder):
    def test_is_told_by_the_calling_thread(self):
        said, threads = [], set()

        def progress(what, done, total):
            said.append((what, done, total))
            threads.add(threading.get_ident())

        pilotage.prepare("mission.json", output="out", progress=progress)
        self.assertEqual(threads, {threading.get_ident()})
        self.assertTrue(any("score" in what for what, _, _ in said), said)
        self.assertTrue(all(0 <= done and total >= 0 for _, done, total in said))

    def test_false_ends_the_work_without_a_trace(self):
        before = sorted(self.folder.rglob("*"))
        with self.assertRaises(pilotage.Interrupted):
            pilotage.prepare("mission.json", output="out", progress=lambda what, done, total: "score" not in what)
        self.assertEqual([path for path in sorted(self.folder.rglob("*")) if path not in before and path.is_file()], [])

    def test_numpys_false_ends_it_too(self):
        with self.assertRaises(pilotage.Interrupted):
            pilotage.prepare("mission.json", output="out", progress=lambda what, done, total: numpy.bool_(False))

    def test_a_slow_callback_is_told_the_latest(self):
        said = []

        def progress(what, done, total):
            said.append(what)
            time.sleep(0.5)

        began = time.monotonic()
        pilotage.prepare("mission.json", output="out", flights=0, progress=progress)
        slow = time.monotonic() - began
        self.assertLess(len(said), 12)
        self.assertLess(0.5 * len(said) - slow, 1)

    def test_a_process_that_is_killed_leaves_no_program(self):
        script = "import pilotage\npilotage.prepare('mission.json', output='orphaned', flights=1000000, threads=1)\n"

        def running():
            return [path.parent.name for path in pathlib.Path("/proc").glob("[0-9]*/cmdline") if b"orphaned" in self.read(path)
                    and pathlib.Path(path.parent, "cwd").resolve() == self.folder.resolve()]

        process = subprocess.Popen([sys.executable, "-B", "-c", script])
        self.wait_for(lambda: len(running()) == 2)
        time.sleep(3)  # flying
        process.kill()
        process.wait()
        self.wait_for(lambda: not running())
        self.assertFalse(pathlib.Path("orphaned").exists())

    def read(self, path):
        try:
            return path.read_bytes()
        except OSError:
            return b""

    def wait_for(self, condition):
        until = time.monotonic() + 20
        while not condition():
            self.assertLess(time.monotonic(), until)
            time.sleep(0.1)

    def test_what_the_callback_throws_comes_out(self):
        def progress(what, done, total):
            raise KeyError(what)

        with self.assertRaises(KeyError):
            pilotage.prepare("mission.json", output="out", progress=progress)

    def test_other_threads_run_meanwhile(self):
        counted, ended = [], threading.Event()

        def count():
            while not ended.is_set():
                counted.append(time.monotonic())
                time.sleep(0.001)

        other = threading.Thread(target=count)
        other.start()
        try:
            pilotage.tile("mission.json", output="plan.json")
        finally:
            ended.set()
            other.join()
        self.assertGreater(len(counted), 20)

    def test_ctrl_c_ends_it_and_leaves_nothing(self):
        script = ("import pilotage, sys\n"
                  "def progress(what, done, total):\n"
                  "    print(what, flush=True)\n"
                  "try:\n"
                  "    pilotage.prepare('mission.json', output='out', flights=1000000, threads=1, progress=progress)\n"
                  "except KeyboardInterrupt:\n"
                  "    print('interrupted', flush=True)\n")
        process = subprocess.Popen([sys.executable, "-B", "-c", script], stdout=subprocess.PIPE, text=True)
        for line in process.stdout:
            if "flying" in line:
                process.send_signal(signal.SIGINT)
                break
        rest = process.stdout.read()
        self.assertEqual(process.wait(20), 0)
        process.stdout.close()
        self.assertTrue(rest.endswith("interrupted\n"), rest)
        self.assertEqual([path for path in self.folder.rglob("*") if path.is_file() and "out" in path.parts[-2:]], [])


if __name__ == "__main__":
    unittest.main()
