"""Which tests of the first tier need not run again: those that passed, with nothing skipped, when all that decides their outcome was the same.

unchanged.py list BUILD      prints a regular expression of them for ctest -E, and notes them in BUILD/Testing/left_out.json
unchanged.py record BUILD    notes what passed in the run that BUILD/Testing/junit.xml tells of; `list` must have run before it

Both are run in the folder of the repository. What decides: the program (a unit test or a fuzz target: with its libraries linked into it), the files of the repository (for these two
without C++ and Markdown), the installed packages, and the real imagery. Lint tests always run. docs/decisions/checks-in-tests.md."""

import hashlib
import json
import os
import pathlib
import re
import subprocess
import sys

import summary

BEFORE, LEFT_OUT, PASSED = "Testing/digests.json", "Testing/left_out.json", "Testing/passed.json"
LINKED = {"unit", "fuzz"}  # labels of tests whose program holds all the code that they run
NOT_READ = {".cc", ".h", ".md"}


def digest_of_file(path):
    digest = hashlib.blake2b(digest_size=16)
    with open(path, "rb") as file:
        while block := file.read(1 << 20):
            digest.update(block)
    return digest.hexdigest()


def repository_files(source):
    """Everything below the source folder but build trees, and what hidden folders hold."""
    for folder, folders, files in os.walk(source):
        top = os.path.samefile(folder, source)
        folders[:] = sorted(name for name in folders if not name.startswith(".") and not (top and name in ("build", "install")))
        for name in sorted(files):
            path = pathlib.Path(folder) / name
            if "__pycache__" not in path.parts and not path.is_symlink():
                yield path


def imagery_listing():
    named = os.environ.get("PILOTAGE_DATA", "../shared/data")
    return [named, [(str(path), path.stat().st_size, path.stat().st_mtime_ns)
                    for path in sorted(pathlib.Path(named).rglob("*")) if path.is_file()]]


def digests_of_tests(build, source):
    """Of every test that is neither a lint nor of the second tier: all that decides its outcome, as one digest."""
    told = subprocess.run(["ctest", "--test-dir", build, "--show-only=json-v1"], stdout=subprocess.PIPE, check=True).stdout
    files = [(path, digest_of_file(path)) for path in repository_files(source)]
    whole = [(str(path), digest) for path, digest in files]
    read = [(str(path), digest) for path, digest in files if path.suffix not in NOT_READ]
    packages = pathlib.Path("/var/lib/dpkg/status")
    machine = [imagery_listing(), digest_of_file(packages) if packages.exists() else "", os.geteuid()]
    programs = {}

    def program(path):
        if path not in programs:
            programs[path] = digest_of_file(path)
        return programs[path]

    result = {}
    for test in json.loads(told)["tests"]:
        labels = {label for one in test["properties"] if one["name"] == "LABELS" for label in one["value"]}
        if labels & {"lint", "thorough"} or "command" not in test:
            continue
        own = [argument for argument in test["command"] if os.path.isfile(argument)]
        if not labels & LINKED:
            own += [str(path) for path in sorted(pathlib.Path(build, "bin").glob("pilotage*")) if path.is_file()]
        decides = [test["command"], [program(path) for path in own], read if labels & LINKED else whole, machine]
        result[test["name"]] = hashlib.blake2b(json.dumps(decides).encode(), digest_size=16).hexdigest()
    return result


def read_json(path):
    return json.loads(path.read_text(encoding="utf-8")) if path.exists() else {}


def list_unchanged(build, source):
    passed = read_json(build / PASSED)
    digests = digests_of_tests(build, source)
    left_out = {name: passed[name]["cases"] for name, digest in digests.items() if passed.get(name, {}).get("digest") == digest}
    (build / "Testing").mkdir(parents=True, exist_ok=True)
    (build / BEFORE).write_text(json.dumps(digests), encoding="utf-8")
    (build / LEFT_OUT).write_text(json.dumps(left_out), encoding="utf-8")
    if left_out:
        print("^(" + "|".join(re.escape(name) for name in sorted(left_out)) + ")$")


def record(build, source):
    """Only what is after the run as `list` found it before: a file that changed meanwhile may not be what was tested."""
    before, after = read_json(build / BEFORE), digests_of_tests(build, source)
    passed = {name: known for name, known in read_json(build / PASSED).items() if known["digest"] == after.get(name)}
    for name, outcomes in summary.outcomes_by_test(build / "Testing/junit.xml", build / "Testing/cases").items():
        passed.pop(name, None)
        if name in after and before.get(name) == after[name] and all(outcome.state == "passed" for outcome in outcomes):
            passed[name] = {"digest": after[name], "cases": len(outcomes)}
    (build / PASSED).write_text(json.dumps(passed), encoding="utf-8")


if __name__ == "__main__":
    {"list": list_unchanged, "record": record}[sys.argv[1]](pathlib.Path(sys.argv[2]).resolve(), str(pathlib.Path.cwd()))
