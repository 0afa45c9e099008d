"""Every command hears SIGTERM, wherever it is: it ends soon, with exit code 130, and leaves nothing behind.

interruption.py PILOTAGE SOURCE_FOLDER [--moments 0.1,0.4,1] [--map LARGE.gpkg]

Each command runs on the sample's imagery, once for each moment (seconds after its start), and gets the signal then. How
long it takes to end is printed: on the clock, and of the processor's time, which is what an idle machine would take. As
a test it fails only where both are out of all reason: a loaded machine decides nothing."""

import argparse
import os
import pathlib
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time

from acceptance import SKIP, Failed, check, run

INTERRUPTED = 130
MAX_CLOCK_S = 10
MAX_PROCESSOR_S = 2
TICKS = os.sysconf("SC_CLK_TCK")


def processor_s(pid):
    """What a process has used so far."""
    fields = pathlib.Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / TICKS


def interrupt(command, moment_s, cwd):
    """Exit code, and the clock's and the processor's seconds from the signal to the end; None when it ended before."""
    process = subprocess.Popen(command, cwd=cwd, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
    try:
        process.wait(timeout=moment_s)
        return process.returncode, None, None, process.stderr.read()
    except subprocess.TimeoutExpired:
        pass
    used_s = processor_s(process.pid)
    start = time.monotonic()
    process.send_signal(signal.SIGTERM)
    words = process.stderr.read()
    _, status, usage = os.wait4(process.pid, 0)
    clock_s = time.monotonic() - start
    process.returncode = os.waitstatus_to_exitcode(status)
    return process.returncode, clock_s, max(0.0, usage.ru_utime + usage.ru_stime - used_s), words


def prepare_inputs(pilotage, sample, work):
    """What the commands read, of the sample mission: a plan, its table, selection and map; shards; an evaluation."""
    def go(*words):
        run(pilotage, *words, "-q", cwd=work)

    for name in ("ortho.tif", "ortho_second_epoch.tif", "elevation.tif", "route.plan", "camera.yaml", "mission.json", "frames"):
        (work / name).symlink_to(sample / name)
    go("tile", "mission.json", "-o", "plan.json")
    go("score", "plan.json", "-o", "scores.tif", "--table", "tiles.csv")
    go("select", "plan.json", "--table", "tiles.csv", "-o", "selection.json")
    go("build", "plan.json", "--table", "tiles.csv", "--selection", "selection.json", "--chips", "-o", "map.gpkg")
    go("build", "plan.json", "--table", "tiles.csv", "--selection", "selection.json", "--update", "map.gpkg", "-o", "second.gpkg")
    coarse = ["ortho.tif", "--gsd-m", "0.6", "--tile-size-px", "128", "--search-radius-px", "64"]
    go("score", *coarse, "--stride-px", "16", "--measures", "gray_variance", "--shard", "1/1", "--shards", "parts")
    (work / "here").mkdir()
    go("score", *coarse, "--stride-px", "128", "--measures", "correct_fix", "--evaluate", "ortho_second_epoch.tif",
       "--evaluate-max-tiles", "150", "-o", "here/scores.tif")


def commands(large_map):
    """Of each command what takes long; `-o` names what may not be left."""
    chosen = ["plan.json", "--table", "tiles.csv", "--selection", "selection.json"]
    frames = ["--frames", "frames/frames.csv", "--camera", "frames/camera.yaml"]
    found = {
        "tile": ["tile", "mission.json", "--tile-overlap", "0.95", "-o", "new.json"],
        "score": ["score", "ortho.tif", "--tile-size-px", "256", "--stride-px", "64", "--search-radius-px", "128", "-o", "new.tif"],
        "score --second-epoch": ["score", "plan.json", "--second-epoch", "ortho_second_epoch.tif", "-o", "new.tif"],
        "score --evaluate": ["score", "ortho.tif", "--gsd-m", "0.6", "--tile-size-px", "128", "--measures", "gray_variance",
                             "--evaluate", "ortho_second_epoch.tif", "-o", "new.tif"],
        "select": ["select", "plan.json", "--table", "tiles.csv", "--advise", "-o", "new.json"],
        "build": ["build", *chosen, "--chips", "-o", "new.gpkg"],
        "report": ["report", *chosen, "--outputs", "html,json,gpkg,kmz", "-o", "new.html"],
        "prepare": ["prepare", "mission.json", "--outputs", "pack", "-o", "new"],
        "update": ["update", "map.gpkg", "second.gpkg.delta", "-o", "new.gpkg"],
        "survey": ["survey", "ortho.tif", "--elevation", "elevation.tif", "--camera-hfov-deg", "73.7", "--camera-width-px", "1000",
                   "--camera-height-px", "562", "--agl-m", "60", "-o", "new"],
        "reroute": ["reroute", "mission.json", "--keep-waypoints", "--max-error-m", "45", "-o", "new.plan"],
        "match": ["match", "map.gpkg", *frames, "-o", "new.csv"],
        "match, wide": ["match", "map.gpkg", *frames, "--search-sigmas", "10", "--height-sigma-fraction", "0.1", "-o", "new.csv"],
        "verify": ["verify", "map.gpkg"],
        "inspect": ["inspect", "map.gpkg"],
        "merge": ["merge", "parts", "-o", "new.tif", "--table", "new.csv"],
        "calibrate": ["calibrate", "here=here", "--adapt", "default", "-o", "new.json"],
        "compare": ["compare", "ortho.tif", *frames, "-o", "new.md"],
    }
    if large_map:
        for word in ("verify", "inspect"):
            found[f"{word}, large"] = [word, str(large_map)]
    return found


def leftovers(work, before):
    return sorted(path.name for path in work.iterdir() if path.name not in before)


def campaign(pilotage, work, moments_s, large_map):
    before = {path.name for path in work.iterdir()}
    slow = []
    clocks_s, processors_s = [], []
    for name, words in commands(large_map).items():
        heard, ended = [], 0
        for moment_s in moments_s:
            code, clock_s, used_s, said = interrupt([str(pilotage), *words], moment_s, work)
            left = leftovers(work, before)
            for path in left:
                (shutil.rmtree if (work / path).is_dir() else os.unlink)(work / path)
            if clock_s is None or code == 0:
                check(code == 0, f"{name}: exit {code} without a signal\n{said}")
                ended += 1
                if clock_s is None:
                    break  # later moments are later still
                continue
            # Before the program listens, the signal ends it as it ends any other.
            check(code in (INTERRUPTED, -signal.SIGTERM), f"{name} at {moment_s} s: exit {code}, not {INTERRUPTED}\n{said}")
            check(not left, f"{name} at {moment_s} s: left behind: {', '.join(left)}")
            heard.append((clock_s, used_s))
            if clock_s > MAX_CLOCK_S and used_s > MAX_PROCESSOR_S:
                slow.append(f"{name} at {moment_s} s: {clock_s:.2f} s, {used_s:.2f} s of the processor")
        clocks_s += [clock for clock, _ in heard]
        processors_s += [used for _, used in heard]
        worst = (max(clock for clock, _ in heard), max(used for _, used in heard)) if heard else (0, 0)
        print(f"{name:22} {len(heard):2} heard, {ended} had ended; at most {worst[0] * 1e3:5.0f} ms, {worst[1] * 1e3:5.0f} ms of the processor", flush=True)
    for what, values in (("clock", sorted(clocks_s)), ("processor", sorted(processors_s))):
        if values:
            at = [values[min(len(values) - 1, int(share * len(values)))] * 1e3 for share in (0.5, 0.95, 1)]
            print(f"{what}: {len(values)} signals, median {at[0]:.0f} ms, 95 % below {at[1]:.0f} ms, at most {at[2]:.0f} ms")
    check(not slow, "\n".join(slow))
    check(clocks_s, "no signal was heard")


def main():
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("pilotage", type=pathlib.Path)
    parser.add_argument("source", type=pathlib.Path)
    parser.add_argument("--moments", default="0.15,0.6,2", help="seconds after the start")
    parser.add_argument("--map", type=pathlib.Path, help="a large map, to verify and inspect")
    arguments = parser.parse_args()
    sample = arguments.source.resolve() / "maps/sample"
    if not (sample / "ortho.tif").exists():
        print("skipped: the sample mission's imagery is not made: cmake --build … --target sample_mission")
        sys.exit(SKIP)
    moments_s = sorted(float(moment) for moment in re.split(",", arguments.moments))
    work = pathlib.Path(tempfile.mkdtemp(prefix="pilotage_interruption_"))
    try:
        prepare_inputs(arguments.pilotage.resolve(), sample, work)
        campaign(arguments.pilotage.resolve(), work, moments_s, arguments.map and arguments.map.resolve())
    except Failed as failure:
        print(f"FAILED: {failure}")
        sys.exit(1)
    finally:
        shutil.rmtree(work)


main()
