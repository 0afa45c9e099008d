"""Faults, kills and power cuts in every stage: whatever breaks, what stands in the end is the old outputs or the new ones, whole.

    campaign.py PILOTAGE SOURCE SHIM [--faults N --kills N --stops N] [--stop-within-s T] [--seed S] [--jobs J] [--only COMMAND]

Each command runs once under SHIM (fault_shim.cc), which numbers its calls on files below the working folder: open, read, write, sync,
rename, remove, and large allocations. Then it runs again over the outputs of an earlier run, and one of these calls fails (an error, a
short read or write, no memory) or the process is killed in it. In the short form the calls are taken evenly, up to a limit for each
command and kind of call, and one write of each output is cut short; with --faults, --kills and --stops as many as named are drawn at
random, half of the kills and all stops (SIGTERM) at any moment. Slow commands have fewer runs. A power cut is not played but computed:
the shim keeps what is synced, and for each prefix of the calls two disks are made, one on which nothing else survived, one on which the
names survived and what was never synced is empty.

What must hold of the outputs:
  exit 0        they are byte for byte those of a run without faults
  another exit  they are those of the earlier run, or those of a run without faults; one message, and none that says "unexpected"
  stopped       as for another exit, which is 130, within --stop-within-s of the signal
  killed, cut   each is of the earlier run or of the new one, never some of both; where the map stands, or there is one output alone,
                nothing is missing; after a kill the next run ends well
and nothing else is left in the folder, but by a kill, and then until the next run.
"""

import argparse
import collections
import concurrent.futures
import hashlib
import os
import pathlib
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "accept"))
from acceptance import SKIP  # noqa: E402

#: `main`: the output that must not stand without the others. `thin`: by how much fewer runs are made of a slow command.
Case = collections.namedtuple("Case", "name earlier command main thin", defaults=(1,))
Fault = collections.namedtuple("Fault", "call action lasts")
Run = collections.namedtuple("Run", "code text files leftovers")

#: What is done to each kind of call, and to how many calls of a command in the short form. The last fill the disk for good.
FAULTS = ((Fault("open", "EACCES", False), 16), (Fault("open", "EMFILE", False), 4), (Fault("read", "EIO", False), 12),
          (Fault("read", "SHORT", False), 8), (Fault("write", "ENOSPC", False), 12), (Fault("write", "SHORT", False), 6),
          (Fault("sync", "EIO", False), 40), (Fault("rename", "EIO", False), 40), (Fault("remove", "EACCES", False), 6),
          (Fault("alloc", "ENOMEM", False), 8), (Fault("write", "ENOSPC", True), 4))
KILLS = ((Fault("write", "KILL", False), 8), (Fault("sync", "KILL", False), 40), (Fault("rename", "KILL", False), 40),
         (Fault("remove", "KILL", False), 6))
STAGE = ("out/plan.json", "--table", "out/tiles.csv", "--selection", "out/selection.json")
#: How often SIGTERM comes to a command in the short form.
STOPS = 4
INTERRUPTED = 130
FRAME = ("frame1.jpg", "--prior-lon-deg", "16.4991", "--prior-lat-deg", "55.5012", "--prior-sigma-m", "10", "--height-agl-m", "60",
         "--yaw-deg", "0", "--pitch-deg", "0", "--roll-deg", "0", "--no-timings")
#: Nine frames of the mission's imagery, each overlapping its neighbours by half, and their table; and a part of it as another map.
BLOCK = """(echo file,prior_lon_deg,prior_lat_deg,height_agl_m,yaw_deg,pitch_deg,roll_deg
for row in 0 100 200; do for column in 0 120 240; do
  gdal_translate -q -of PNG --config GDAL_PAM_ENABLED NO -srcwin $column $row 300 200 ortho.tif b${row}_$column.png
  echo "$((column + 150)) $((row + 100))" | gdaltransform -t_srs EPSG:4326 -output_xy ortho.tif | (read lon lat
    echo "b${row}_$column.png,$lon,$lat,150,1.24,0,0")
done; done) > block.csv && gdal_translate -q -srcwin 100 50 400 400 ortho.tif part.tif"""
#: Deaths by a signal that are libraries' answers to a failed allocation: GDAL and PROJ end the process, libgeotiff uses what it did not
#: get. Our own code allocates by `new`, which throws.
DEATHS = {-signal.SIGABRT: "aborted", -signal.SIGSEGV: "crashed"}
#: libtiff's answer to a failed read of a tile's place in the file.
TIFF_ASSERTION = "_TIFFFetchStrileValue: Assertion"


def cases():
    fresh = ["--overwrite", "-q"]
    prepare = ["prepare", "mission.json", "-o", "new"]
    survey = ["survey", "ortho.tif", "--elevation", "elevation.tif", "--camera-hfov-deg", "73.7", "--camera-width-px", "1000",
              "--camera-height-px", "562", "--agl-m", "60", "--tile-overlap", "0", "-o", "new"]
    reroute = ["reroute", "mission.json", "-o", "new/better.plan"]
    capture = ["capture", "block.csv", "--camera-hfov-deg", "53.130102", "--camera-width-px", "300", "--camera-height-px", "200",
               "--align", "ortho.tif", "--log", "new/a.csv", "--camera-log", "new/c.yaml", "--quality", "new/q.html", "-o", "new/r.tif"]
    audit = ["audit", "part.tif", "ortho.tif", "-o", "new/s.svg", "--disagreement", "new/d.tif"]
    envelope = ["--factors", "height_m,attitude_error_deg,jpeg_quality", "--height-m", "60:90:30", "--attitude-error-deg", "2",
                "--jpeg-quality", "20"]
    return (
        Case("prepare", [*prepare, "--speed-mps", "17"], [*prepare, "--sign-key", "key.sec", *fresh], "map.gpkg", 8),
        Case("prepare_new_folder", None, ["prepare", "mission.json", "-q", "-o", "new", "--outputs", "pack", "--sign-key", "key.sec"],
             "map.gpkg", 8),
        Case("tile", ["tile", "tile.json", "--tile-overlap", "0.4", "-o", "new/plan.json"],
             ["tile", "tile.json", "-o", "new/plan.json", *fresh], None),
        Case("score", ["score", "out/plan.json", "--measures", "uniqueness", "-o", "new/scores.tif", "--table", "new/tiles.csv"],
             ["score", "out/plan.json", "-o", "new/scores.tif", "--table", "new/tiles.csv", *fresh], None, 5),
        Case("select", ["select", "out/plan.json", "--table", "out/tiles.csv", "--sparse", "-o", "new/selection.json"],
             ["select", "out/plan.json", "--table", "out/tiles.csv", "-o", "new/selection.json", *fresh], None),
        Case("build", ["build", *STAGE, "--descriptor-bits", "128", "-o", "new/map.gpkg", "--sign-key", "key.sec"],
             ["build", *STAGE, "-o", "new/map.gpkg", "--sign-key", "key.sec", *fresh], "map.gpkg", 3),
        Case("update", ["build", *STAGE, "-o", "new/map.gpkg", "--sign-key", "key.sec"],
             ["update", "out/map.gpkg", "second.gpkg.delta", "-o", "new/map.gpkg", "--public-key", "key.pub", *fresh], "map.gpkg", 3),
        Case("report", ["report", *STAGE, "--title", "Earlier", "--outputs", "html,json,gpkg,cog", "-o", "new/report.html"],
             ["report", *STAGE, "--outputs", "html,json,gpkg,cog,kml", "-o", "new/report.html", *fresh], None, 5),
        Case("verify", None, ["verify", "out/map.gpkg", "--public-key", "key.pub"], None),
        Case("match", ["match", "out/map.gpkg", *FRAME, "--max-false-fix-rate", "0.01", "-o", "new/fix.csv"],
             ["match", "out/map.gpkg", "--public-key", "key.pub", *FRAME, "-o", "new/fix.csv", "--overwrite"], None),
        Case("survey", [*survey, "--title", "Earlier"], [*survey, *fresh], "survey.html", 12),
        Case("simulate", ["simulate", "out", "--flights", "3", "-o", "new/s.json", "--tracks", "new/t.gpkg"],
             ["simulate", "out", "--flights", "4", "-o", "new/s.json", "--tracks", "new/t.gpkg", *fresh], "s.json", 4),
        Case("replay", ["replay", "fix.csv", "--plan", "out", "--correct-within-m", "9", "-o", "new/r.json", "--fixes", "new/f.csv",
                        "--evaluation", "new/ev"],
             ["replay", "fix.csv", "--plan", "out", "-o", "new/r.json", "--fixes", "new/f.csv", "--evaluation", "new/ev", *fresh],
             "r.json", 3),
        Case("envelope", ["envelope", "out", *envelope, "--places", "2", "-o", "new/e.json", "--csv", "new/e.csv", "--svg", "new/e.svg"],
             ["envelope", "out", *envelope, "--places", "3", "-o", "new/e.json", "--csv", "new/e.csv", "--svg", "new/e.svg", *fresh],
             "e.json", 12),
        Case("merge", ["merge", "earlier_parts", "-o", "new/scores.tif", "--table", "new/tiles.csv"],
             ["merge", "parts", "-o", "new/scores.tif", "--table", "new/tiles.csv", *fresh], None),
        Case("calibrate", ["calibrate", "here=here", "--adapt", "default", "--date", "2026-01-01", "-o", "new/model.json"],
             ["calibrate", "here=here", "--adapt", "default", "--date", "2026-01-02", "-o", "new/model.json", *fresh], None),
        Case("reroute", [*reroute, "--speed-mps", "17"], [*reroute, *fresh], "better.plan", 8),
        Case("capture", [*capture, "--gsd-m", "0.6"], [*capture, *fresh], "r.tif", 20),
        Case("audit", [*audit, "--max-shift-m", "2"], [*audit, *fresh], None, 4),
    )


class Campaign:
    def __init__(self, pilotage, source, shim, work, seed, stop_within_s):
        self.pilotage, self.source, self.shim, self.work, self.stop_within_s = pilotage, source, shim, work, stop_within_s
        self.heard_after_s = []
        self.random = random.Random(seed)
        self.failures = []
        self.counts = collections.Counter()
        self.outcomes = collections.Counter()
        self.lock = threading.Lock()

    def make_mission(self):
        """The folder that each run gets a copy of: the small mission, frames of it, a key, and what the stages made of it."""
        home = self.work / "home"
        home.mkdir()
        for script in ("small_mission/make", "frames/make"):
            subprocess.run(["sh", str(self.source / "tests/data" / script)], cwd=home, check=True)
        subprocess.run(["minisign", "-G", "-W", "-f", "-p", "key.pub", "-s", "key.sec"], cwd=home, check=True, stdout=subprocess.DEVNULL)
        mission = (home / "mission.json").read_text()
        (home / "tile.json").write_text("".join(line for line in mission.splitlines(True) if '"select"' not in line))
        self.plain(home, ["prepare", "mission.json", "-q", "-o", "out"])
        self.plain(home, ["build", *STAGE, "-o", "out/map.gpkg", "--sign-key", "key.sec", "--overwrite"])
        self.plain(home, ["build", *STAGE, "--descriptor-bits", "128", "--update", "out/map.gpkg", "-o", "second.gpkg", "--sign-key",
                          "key.sec"])
        self.plain(home, ["match", "out/map.gpkg", *FRAME, "-o", "fix.csv"])
        coarse = ["score", "ortho.tif", "--tile-size-px", "48", "--search-radius-px", "32"]
        for name, stride_px in (("earlier_parts", "48"), ("parts", "32")):
            self.plain(home, [*coarse, "--stride-px", stride_px, "--measures", "gray_variance", "--shard", "1/1", "--shards", name])
        subprocess.run(["sh", "-c", BLOCK], cwd=home, check=True)
        (home / "here").mkdir()
        self.plain(home, [*coarse, "--stride-px", "32", "--measures", "correct_fix", "--evaluate", "ortho.tif",
                          "--evaluate-max-tiles", "60", "-o", "here/scores.tif"])

    def plain(self, folder, command):
        done = subprocess.run([self.pilotage, *command, "--threads", "1"], cwd=folder, text=True, errors="replace",
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT, check=False)
        if done.returncode != 0:
            raise RuntimeError(f"{' '.join(command)}: exit {done.returncode}\n{done.stdout}")
        return done.stdout

    def reference(self, case):
        """What stands before the case, what stands after it, what it prints, and the calls of each kind that it makes."""
        folder = self.work / f"reference_{case.name}"
        shutil.copytree(self.work / "home", folder)
        if case.earlier is not None or case.name != "prepare_new_folder":
            (folder / "new").mkdir()
        if case.earlier is not None:
            self.plain(folder, case.earlier)
        shutil.copytree(folder, self.work / f"before_{case.name}")
        old = state_of(folder / "new")[0]
        calls, text, seconds = {}, "", float("inf")
        for call in ("open", "read", "write", "sync", "rename", "remove", "alloc"):
            again = self.work / f"count_{case.name}"
            shutil.copytree(self.work / f"before_{case.name}", again)
            log = self.work / f"count_{case.name}.log"
            started = time.monotonic()
            run = self.run(again, case.command, Fault(call, "", False), 0, log)
            seconds = min(seconds, time.monotonic() - started)  # what else the machine does makes a run seem longer
            if run.code != 0:
                raise RuntimeError(f"{case.name}: exit {run.code} without a fault\n{run.text}")
            lines = log.read_text().splitlines() if log.exists() else []
            calls[call] = [line.split("\t", 1)[1].replace(str(again) + "/", "") for line in lines]
            text, new = run.text, run.files
            shutil.rmtree(again)
            log.unlink(missing_ok=True)
        return old, new, text, calls, seconds

    def run(self, folder, command, fault, at, log=None, disk=None):
        environment = dict(os.environ, LD_PRELOAD=str(self.shim), FAULT_FOLDER=str(folder), FAULT_CALLS=fault.call, FAULT_AT=str(at),
                           FAULT_ACTION=fault.action, FAULT_LASTS="1" if fault.lasts else "0", FAULT_LOG=str(log or ""),
                           FAULT_DISK=str(disk or ""))
        done = subprocess.run([self.pilotage, *command, "--threads", "1"], cwd=folder, env=environment, text=True, errors="replace",
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT, check=False)
        return Run(done.returncode, done.stdout, *state_of(folder / "new"))

    def fail(self, case, what, problem, text=""):
        with self.lock:
            self.failures.append(f"{case.name}, {what}: {problem}" + (f"\n    {text.strip()[-600:]}" if text else ""))

    def one(self, case, reference, fault, at, wait_s=None, stops=False):
        """One run with one fault (or, with wait_s, killed or stopped after that time), judged."""
        what = f"{'stopped' if stops else 'killed'} after {wait_s} s"
        if wait_s is None:
            what = f"{fault.action}{' from there on' if fault.lasts else ''} in {fault.call} {at} ({reference[3][fault.call][at - 1]})"
        folder = pathlib.Path(tempfile.mkdtemp(prefix="run_", dir=self.work))
        folder.rmdir()
        shutil.copytree(self.work / f"before_{case.name}", folder)
        try:
            run = self.run(folder, case.command, fault, at) if wait_s is None else self.cut_short(case, what, folder, wait_s, stops)
            if run is None:
                return
            with self.lock:
                self.counts["stops" if stops else "kills" if run.code == -signal.SIGKILL else "faults"] += 1
                self.outcomes["killed" if run.code == -signal.SIGKILL else "exit 0" if run.code == 0 else "stopped" if stops
                              else DEATHS.get(run.code, "refused")] += 1
            if run.code == -signal.SIGKILL:
                self.judge_killed(case, reference, what, folder, run)
            elif stops and run.code == -signal.SIGTERM:  # before the program listens
                if run.files != reference[0] or run.leftovers:
                    self.fail(case, what, f"{differences(run.files, reference[0])}, left {run.leftovers}", run.text)
            elif stops and run.code not in (0, INTERRUPTED):
                self.fail(case, what, f"exit {run.code}, not {INTERRUPTED}", run.text)
            else:
                self.judge_ended(case, reference, fault, what, run)
        finally:
            shutil.rmtree(folder, ignore_errors=True)

    def cut_short(self, case, what, folder, wait_s, stops):
        """A run that gets SIGKILL, or SIGTERM, at a moment. None, and a failure, when it is deaf to SIGTERM."""
        process = subprocess.Popen([self.pilotage, *case.command, "--threads", "1"], cwd=folder, text=True, errors="replace",
                                   stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
        time.sleep(wait_s)
        (process.terminate if stops else process.kill)()
        sent = time.monotonic()
        try:
            text = process.communicate(timeout=self.stop_within_s if stops else None)[0]
        except subprocess.TimeoutExpired:
            process.kill()
            self.fail(case, what, f"runs on {self.stop_within_s} s after SIGTERM", process.communicate()[0])
            return None
        if stops and process.returncode == INTERRUPTED:
            with self.lock:
                self.heard_after_s.append(time.monotonic() - sent)
        return Run(process.returncode, text, *state_of(folder / "new"))

    def judge_killed(self, case, reference, what, folder, run):
        old, new = reference[:2]
        problem = mixture(run.files, old, new, case.main)
        if problem:
            self.fail(case, what, problem)
        elif case.command[0] not in ("verify",):
            again = self.run(folder, [*case.command, "--overwrite"] if "--overwrite" not in case.command else case.command,
                             Fault("none", "", False), 0)
            if again.code != 0 or again.files != new or again.leftovers:
                self.fail(case, what, f"the next run: exit {again.code}, {differences(again.files, new)}, left {again.leftovers}",
                          again.text)

    def judge_ended(self, case, reference, fault, what, run):
        old, new, text = reference[:3]
        if fault.call == "alloc" and "out_of_memory" in run.text:
            return  # match() answers with a status
        if run.code == 0:
            if run.files != new or run.leftovers and fault.call != "remove":
                self.fail(case, what, f"exit 0, but {differences(run.files, new)}, left {run.leftovers}", run.text)
            elif not new and run.text != text:
                self.fail(case, what, "exit 0, but it says something else", run.text)
            return
        if run.code < 0 and not (fault.call == "alloc" and run.code in DEATHS or fault.call == "read" and TIFF_ASSERTION in run.text):
            return self.fail(case, what, f"died of signal {-run.code}", run.text)
        if run.files not in (old, new):
            self.fail(case, what, f"exit {run.code} and {mixture(run.files, old, new, case.main) or 'outputs are missing'}: "
                      f"{differences(run.files, old)}", run.text)
        if run.leftovers and fault.call != "remove" and run.code > 0:
            self.fail(case, what, f"exit {run.code}, left {run.leftovers}", run.text)
        if run.code > 0 and ("unexpected" in run.text or "pilotage" not in run.text):
            self.fail(case, what, f"exit {run.code} and no clear message", run.text)

    def cut_power(self, case, old, new):
        """Every disk that a power cut in the course of the case can leave."""
        folder, log, disk = self.work / f"cut_{case.name}", self.work / f"cut_{case.name}.log", self.work / f"disk_{case.name}"
        shutil.copytree(self.work / f"before_{case.name}", folder)
        disk.mkdir()
        run = self.run(folder, case.command, Fault("sync,rename,remove", "", False), 0, log, disk)
        if run.code != 0 or run.files != new:
            return self.fail(case, "power", "the run itself went wrong", run.text)
        lines = [line.split("\t") for line in log.read_text().splitlines()]
        out = str(folder / "new")
        states = list(disks_after_cuts(lines, out, old, disk))
        for problem in sorted({mixture(files, old, new, case.main) for files in states} - {""}):
            self.fail(case, "power cut", problem)
        self.counts["power cuts"] += len(states)
        if lines and states[-1] != new:
            self.fail(case, "power cut after the end", f"exit 0 was promised, but {differences(states[-1], new)}")
        shutil.rmtree(folder)
        shutil.rmtree(disk)


def digest(data):
    return hashlib.blake2b(data, digest_size=16).hexdigest()


def state_of(folder):
    """The outputs that stand in a folder and in those in it, by name, and what is hidden or empty there."""
    files, leftovers = {}, []
    for path in sorted(folder.iterdir()) if folder.is_dir() else ():
        if path.name.startswith(".") or path.is_dir() and not any(path.iterdir()):
            leftovers.append(path.name)
        elif path.is_dir():
            inside, left = state_of(path)
            files.update({f"{path.name}/{name}": content for name, content in inside.items()})
            leftovers += [f"{path.name}/{name}" for name in left]
        else:
            files[path.name] = digest(path.read_bytes())
    return files, leftovers


def differences(files, wanted):
    words = [f"{name} is missing" for name in sorted(wanted.keys() - files.keys())]
    words += [f"{name} is too much" for name in sorted(files.keys() - wanted.keys())]
    words += [f"{name} is another" for name in sorted(files.keys() & wanted.keys()) if files[name] != wanted[name]]
    return ", ".join(words) or "no difference"


def mixture(files, old, new, main):
    """What is wrong with outputs that a kill left; nothing is the empty text."""
    torn = [name for name, value in files.items() if value not in (old.get(name), new.get(name))]
    if torn:
        return f"neither old nor new: {', '.join(torn)}"
    of_old = [name for name in files if files[name] != new.get(name)]
    of_new = [name for name in files if files[name] != old.get(name)]
    if of_old and of_new:
        return f"mixed: {', '.join(of_old)} of the earlier run beside {', '.join(of_new)}"
    whole = files in (old, new)
    if main in files and not whole:
        return f"{main} stands, but {differences(files, old if of_old else new)}"
    if len(old) == 1 and len(new) == 1 and not whole:
        return f"the one output is gone: {differences(files, new)}"
    return ""


def disks_after_cuts(lines, out, old, disk):
    """For each prefix of the log the outputs that stand on the disk: with what was synced alone; with the names of every moment since, and
    of contents what was synced. Contents that were never synced count as empty."""
    empty = digest(b"")
    names = {f"{out}/{name}": name for name in old}  # path -> identity of a file
    contents = dict(old)                              # identity -> what of it is on the disk
    durable = dict(names)
    fresh = 0

    def outputs(entries):
        return {path[len(out) + 1:]: contents.get(file, empty) for path, file in entries.items()
                if path.startswith(out + "/") and "/." not in path[len(out):]}

    for number, call, path, *second in lines:
        if call in ("fsync", "fdatasync"):
            if os.path.isdir(path):
                inside = {entry: file for entry, file in names.items() if os.path.dirname(entry) == path}
                durable = {entry: file for entry, file in durable.items() if os.path.dirname(entry) != path} | inside
            else:
                if path not in names:
                    fresh += 1
                    names[path] = f"new {fresh}"
                contents[names[path]] = digest((disk / number).read_bytes())
        elif call == "rename":
            if path not in names:
                fresh += 1
                names[path] = f"new {fresh}"
            names[second[0]] = names.pop(path)
        else:
            names.pop(path, None)
        yield outputs(names)
        yield outputs(durable)


def evenly(count, limit):
    return range(1, count + 1) if count <= limit else sorted({1 + round(i * (count - 1) / (limit - 1)) for i in range(limit)})


def one_write_of_each_output(chosen, known):
    """The middle one, in the fastest case that makes the output."""
    tried = set()
    for case in sorted(chosen, key=lambda case: known[case.name][4]):
        _, new, _, calls, _ = known[case.name]
        for name in sorted(new.keys() - tried):
            writes = [at for at, call in enumerate(calls["write"], 1) if pathlib.PurePath(call).name == name]
            if writes:
                tried.add(name)
                yield case, writes[len(writes) // 2]


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("pilotage", type=pathlib.Path)
    parser.add_argument("source", type=pathlib.Path)
    parser.add_argument("shim", type=pathlib.Path)
    parser.add_argument("--faults", type=int, help="as many, drawn at random")
    parser.add_argument("--kills", type=int, help="as many, drawn at random")
    parser.add_argument("--stops", type=int, help="as many, drawn at random")
    parser.add_argument("--stop-within-s", type=float, default=2, help="how long a command may go on after SIGTERM")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    parser.add_argument("--only", nargs="+", help="these commands alone")
    options = parser.parse_args()
    source = options.source.resolve()
    for tool in ("minisign", "gdal_translate"):
        if shutil.which(tool) is None:
            print(f"skipped: no {tool}: apt-get install {'gdal-bin' if tool.startswith('gdal') else tool}")
            sys.exit(SKIP)
    if not (source / "maps/sample/ortho.tif").exists():
        print("skipped: maps/sample/ortho.tif is not there; the build makes it")
        sys.exit(SKIP)

    work = pathlib.Path(tempfile.mkdtemp(prefix="pilotage_fault_"))
    campaign = Campaign(options.pilotage.resolve(), source, options.shim.resolve(), work, options.seed, options.stop_within_s)
    tasks = []
    at_random = any(count is not None for count in (options.faults, options.kills, options.stops))
    at_any_moment = Fault("none", "", False)
    try:
        campaign.make_mission()
        chosen = [case for case in cases() if not options.only or case.name in options.only]
        known = {}
        for case in chosen:
            known[case.name] = campaign.reference(case)
            old, new, text, calls, seconds = known[case.name]
            print(f"{case.name}: {', '.join(f'{len(made)} {call}' for call, made in calls.items())}, {seconds:.2f} s", flush=True)
            if not at_random:
                # Into a new folder: only what differs from the same over an earlier output.
                for fault, limit in KILLS if case.name == "prepare_new_folder" else FAULTS + KILLS:
                    tasks += [(case, known[case.name], fault, at) for at in evenly(len(calls[fault.call]), max(2, limit // case.thin))]
                tasks += [(case, known[case.name], at_any_moment, 0, seconds * (part + 0.5) / STOPS, True) for part in range(STOPS)]
            campaign.cut_power(case, old, new)
        if not at_random:
            tasks += [(case, known[case.name], Fault("write", "SHORT", False), at) for case, at in one_write_of_each_output(chosen, known)]
        for faults, wanted in ((FAULTS, options.faults or 0), (KILLS, options.kills or 0)):
            while wanted > 0:
                case = campaign.random.choices(chosen, [1 / one.thin for one in chosen])[0]
                old, new, text, calls, seconds = known[case.name]
                fault = campaign.random.choice(faults)[0]
                if faults is KILLS and campaign.random.random() < 0.5:
                    tasks.append((case, known[case.name], fault, 0, campaign.random.uniform(0, seconds)))
                elif calls[fault.call]:
                    tasks.append((case, known[case.name], fault, campaign.random.randint(1, len(calls[fault.call]))))
                else:
                    continue
                wanted -= 1
        for _ in range(options.stops or 0):
            case = campaign.random.choices(chosen, [1 / one.thin for one in chosen])[0]
            tasks.append((case, known[case.name], at_any_moment, 0, campaign.random.uniform(0, known[case.name][4]), True))
        with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
            for done in [pool.submit(campaign.one, *task) for task in tasks]:
                done.result()
    finally:
        shutil.rmtree(work, ignore_errors=True)
    for failure in campaign.failures[:60]:
        print(f"FAILED: {failure}")
    print(f"{campaign.counts['faults']} faults, {campaign.counts['kills']} kills, {campaign.counts['stops']} stops "
          f"(the slowest ended {max(campaign.heard_after_s, default=0):.2f} s after SIGTERM), "
          f"{campaign.counts['power cuts']} disks after power cuts; "
          f"{dict(campaign.outcomes)}; {len(campaign.failures)} failures")
    sys.exit(1 if campaign.failures else 0)


if __name__ == "__main__":
    main()
