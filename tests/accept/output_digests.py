"""Holds the bytes of what the program writes: of the sample mission, and of real imagery where there is some.

output_digests.py PILOTAGE SOURCE_FOLDER [--record]

The digests of output_digests.json are BLAKE2b-256 of whole files. Numbers may differ in their last digits on a processor
with other vector instructions, so the file says for which of them it holds; on others the test is skipped. --record
writes the file: to be done by who changes an output on purpose, who says in the commit which file changed, and why."""

import hashlib
import json
import os
import pathlib
import platform
import shutil
import sys

from acceptance import SKIP, check, main, need_sample, run

HELD = pathlib.Path(__file__).with_suffix(".json")
SAMPLE = ["plan.json", "tiles.csv", "scores.tif", "selection.json", "map.gpkg"]
PORT = ["tiles.csv", "scores.tif"]


def instruction_set():
    """What the kernels are chosen by: the machine, and whether it has AVX-512."""
    cpu = pathlib.Path("/proc/cpuinfo")
    flags = set()
    if cpu.exists():
        flags = {word for line in cpu.read_text().splitlines() if line.startswith("flags") for word in line.split()}
    return platform.machine() + (" avx512f" if "avx512f" in flags else "")


def digest(path):
    return hashlib.blake2b(path.read_bytes(), digest_size=32).hexdigest()


def sample_digests(pilotage, source, work):
    """Prepares a copy of the sample: paths stand in the outputs, so the folder must look alike everywhere."""
    sample = work / "sample"
    shutil.copytree(source / "maps/sample", sample, ignore=shutil.ignore_patterns("country", "out"))
    run(pilotage, "prepare", "mission.json", "-o", "out", "-q", cwd=sample)
    return {f"sample/{name}": digest(sample / "out" / name) for name in SAMPLE}


def port_digests(pilotage, data, work):
    folder = work / "port"
    folder.mkdir()
    os.symlink(data / "port/port_2019-08.tif", folder / "port.tif")
    run(pilotage, "score", "port.tif", "--gsd-m", "1.2", "--tile-size-px", "64", "--stride-px", "64",
        "--search-radius-px", "16", "-o", "scores.tif", "--table", "tiles.csv", "-q", cwd=folder)
    return {f"port/{name}": digest(folder / name) for name in PORT}


def test(pilotage, source, work, arguments):
    record = arguments == ["--record"]
    check(record or not arguments, f"{arguments}: only --record is known")
    need_sample(source)
    held = {} if record else json.loads(HELD.read_text())
    here = instruction_set()
    if not record and held["instruction_set"] != here:
        print(f"skipped: the digests are of {held['instruction_set']}, this is {here}")
        sys.exit(SKIP)
    found = sample_digests(pilotage.resolve(), source, work)
    data = pathlib.Path(os.environ.get("PILOTAGE_DATA") or source / "../shared/data")
    if (data / "port").is_dir():
        found |= port_digests(pilotage.resolve(), data.resolve(), work)
    else:
        print("no real imagery (PILOTAGE_DATA): the sample alone")
    if record:
        HELD.write_text(json.dumps({"instruction_set": here, "blake2b_256": found}, indent=2) + "\n")
        print(f"{HELD}: {len(found)} digests")
        return
    expected = held["blake2b_256"]
    wrong = [f"{name}: {value}, expected {expected.get(name, 'nothing: it is not in the file')}"
             for name, value in found.items() if expected.get(name) != value]
    check(not wrong, f"{len(wrong)} of {len(found)} files differ\n" + "\n".join(wrong))
    print(f"{len(found)} files as held")


main(test)
