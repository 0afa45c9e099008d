"""The examples of README.md, docs/stages.md, docs/examples/onboard/README.md and docs/tutorial.md, as printed, in their order, and then once more.

readme_examples.py PILOTAGE SOURCE_FOLDER BUILD_FOLDER [--once]

How commands stand on a page: page_examples.py. Blocks without a command are not run. Commands run in a copy of the
repository's files that they use, where build/release is BUILD_FOLDER, and must leave nothing there that git does not
ignore."""

import os
import pathlib
import shutil
import sys

from acceptance import SKIP, check, main
from page_examples import blocks, examples_in, run_example

PAGES = ("README.md", "docs/stages.md", "docs/examples/onboard/README.md", "docs/tutorial.md")


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
            for block in blocks(source / name):
                for number, command, expected in examples_in(block):
                    where = f"{name}:{number}{', second time' if again else ''}"
                    run_example(where, command, expected, checkout, environment, page=source / name)
                    count += 1
    ignored = [line[1:] for line in (source / ".gitignore").read_text().splitlines() if line.startswith("/")]
    strays = [name for name in files_of(checkout) - before if not any(name.startswith(path) for path in ignored)]
    check(not strays, f"examples leave files that git does not ignore: {sorted(strays)[:10]}")
    check(count >= (15 if once else 30), f"only {count} commands found in {PAGES}: they are no longer recognised")
    print(f"{count} commands as printed")


main(test)
