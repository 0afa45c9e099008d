"""The examples of README.md and docs/examples/onboard/README.md, as printed, in their order, and then once more.

readme_examples.py PILOTAGE SOURCE_FOLDER BUILD_FOLDER [--once]

In a block of a page, a line that begins with "$ " is a command (as far as lines end with a backslash), and the lines
below it are what it prints; a line "⋮" stands for any lines. Blocks without such a line are not run. Commands run in a
copy of the repository's files that they use, where build/release is BUILD_FOLDER, and must leave nothing there that
git does not ignore."""

import os
import pathlib
import shutil
import subprocess
import sys
import time

from acceptance import SKIP, check, main

PAGES = ("README.md", "docs/examples/onboard/README.md")
ANY_LINES = "⋮"


def examples(page):
    """(line number, command, expected lines) of a page, in its order."""
    found = []
    in_block = False
    for number, line in enumerate(page.read_text(encoding="utf-8").splitlines(), 1):
        if line.lstrip().startswith("```"):
            in_block = not in_block
            continued = printing = False
        elif in_block and line.startswith("$ "):
            found.append((number, line[2:], []))
            continued, printing = line.endswith("\\"), True
        elif in_block and continued:
            start, command, expected = found[-1]
            found[-1] = (start, command + "\n" + line, expected)
            continued = line.endswith("\\")
        elif in_block and printing:
            found[-1][2].append(line)
    return [(number, command, expected[:-1] if expected and not expected[-1] else expected)
            for number, command, expected in found]


def same_lines(expected, printed):
    """Whether the printed lines are the expected ones; ANY_LINES matches any number of them."""
    if not expected:
        return not printed
    if expected[0] == ANY_LINES:
        return any(same_lines(expected[1:], printed[i:]) for i in range(len(printed) + 1))
    return bool(printed) and expected[0] == printed[0] and same_lines(expected[1:], printed[1:])


def checkout_of(source, build, work):
    """The files of the repository that examples read, and the built program where a reader has it."""
    checkout = work / "checkout"
    for folder in ("maps/sample", "docs/examples"):
        shutil.copytree(source / folder, checkout / folder)
    (checkout / "build").mkdir()
    (checkout / "build/release").symlink_to(build.resolve())
    (work / "home").mkdir()
    return checkout


def files_of(folder):
    return {path.relative_to(folder).as_posix() for path in folder.rglob("*") if not path.is_dir()}


def run_example(where, command, expected, checkout, environment):
    began = time.monotonic()
    done = subprocess.run(["bash", "-euo", "pipefail", "-c", command], cwd=checkout, env=environment, text=True,
                          stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE, check=False)
    print(f"{where}: {time.monotonic() - began:.1f} s: {command.splitlines()[0]}", flush=True)
    check(done.returncode == 0, f"{where}: $ {command}\nexit {done.returncode}\n{done.stdout}{done.stderr}")
    check(not expected or same_lines(expected, done.stdout.splitlines()),
          f"{where}: $ {command}\nprints\n{done.stdout}and the page says\n" + "\n".join(expected))


def test(pilotage, source, work, rest):
    build = pathlib.Path(rest[0])
    if not (source / "maps/sample/frames/frames.csv").exists():
        print("skipped: the sample mission is not made (target sample_mission)")
        sys.exit(SKIP)
    checkout = checkout_of(source, build, work)
    before = files_of(checkout)
    environment = dict(os.environ, HOME=str(work / "home"),
                       PATH=f"{pilotage.resolve().parent}{os.pathsep}{os.environ['PATH']}")
    count = 0
    once = "--once" in rest[1:]
    for again in (False,) if once else (False, True):
        for name in PAGES:
            for number, command, expected in examples(source / name):
                where = f"{name}:{number}{', second time' if again else ''}"
                run_example(where, command, expected, checkout, environment)
                count += 1
    ignored = [line[1:] for line in (source / ".gitignore").read_text().splitlines() if line.startswith("/")]
    strays = [name for name in files_of(checkout) - before if not any(name.startswith(path) for path in ignored)]
    check(not strays, f"examples leave files that git does not ignore: {sorted(strays)[:10]}")
    check(count >= (15 if once else 30), f"only {count} commands found in {PAGES}: they are no longer recognised")
    print(f"{count} commands as printed")


main(test)
