"""The examples of docs/commands, as printed: one page after the other, in a folder that has maps/sample and nothing else.

command_examples.py PILOTAGE SOURCE_FOLDER FOLDER_OF_CUT_FLIGHT_FRAMES [PAGE...]

How commands stand on a page: page_examples.py. Pages run in the order of PAGES, each with the files that those before it
wrote. A block whose first line is "# not run: WHY" shows commands that need what the repository does not have; a block
without "$ " shows forms of use ("pilotage WORD [OPTIONS] …"). A command after which "$ echo $?" stands may fail."""

import os
import shutil
import sys

from acceptance import SKIP, Failed, check, main
from page_examples import blocks, examples_in, run_example

PAGES = ("tile", "score", "select", "build", "prepare", "verify", "update", "inspect", "merge", "calibrate", "report", "match",
         "compare", "survey", "reroute", "simulate", "envelope", "replay", "capture", "audit", "landmark-label", "landmark-train",
         "landmark-score", "fetch",
         "completion", "manual")
NOT_RUN = "# not run: "
EXIT_CODE = "echo $?"


def run_block(where, examples, folder, environment, page):
    """What of a block came out otherwise than the page says; the later examples are run all the same."""
    problems = []
    code = 0
    for index, (number, command, expected) in enumerate(examples):
        try:
            if command == EXIT_CODE:
                check(expected == [str(code)], f"{where}:{number}: $ {command}\nis {code}, and the page says {expected}")
                continue
            may_fail = index + 1 < len(examples) and examples[index + 1][1] == EXIT_CODE
            code = run_example(f"{where}:{number}", command, expected, folder, environment, may_fail, page)
        except Failed as failure:
            problems.append(str(failure))
    return problems


def not_marked(where, block, word):
    """The lines of a block without commands that are no forms of use: commands that nobody runs."""
    return [f"{where}:{number}: neither a command (\"$ …\") nor a form of use, and not marked \"{NOT_RUN}…\": {line}"
            for number, line in enumerate(block[1], block[0]) if not line.startswith(f"pilotage {word} [OPTIONS]")]


def test(pilotage, source, work, rest):
    frames_folder, *words = rest
    if not (source / "maps/sample/frames/frames.csv").exists():
        print("skipped: the sample mission is not made (target sample_mission)")
        sys.exit(SKIP)
    pages = {path.stem for path in (source / "docs/commands").glob("*.md")}
    check(pages == set(PAGES), f"pages and PAGES differ: {sorted(pages ^ set(PAGES))}")
    folder = work / "folder"
    shutil.copytree(source / "maps/sample", folder / "maps/sample", ignore=shutil.ignore_patterns("country", "*.cc"))
    (work / "home").mkdir()
    environment = dict(os.environ, HOME=str(work / "home"), MANWIDTH="80", LC_ALL="C.UTF-8",
                       PATH=os.pathsep.join([str(pilotage.resolve().parent), frames_folder, os.environ["PATH"]]))
    ran = used = 0
    not_run = []
    problems = []
    for word in words or PAGES:
        name = f"docs/commands/{word}.md"
        for block in blocks(source / name):
            examples = examples_in(block)
            if block[1] and block[1][0].startswith(NOT_RUN):
                not_run.append(f"{name}:{block[0]}: {block[1][0].removeprefix(NOT_RUN)}")
            elif examples:
                problems += run_block(name, examples, folder, environment, source / name)
                ran += len(examples)
            else:
                problems += not_marked(name, block, word)
                used += len(block[1])
    check(not problems, "\n\n".join(problems))
    print(f"{ran} commands as printed, {used} forms of use, {len(not_run)} blocks not run:", *not_run, sep="\n  ")
    check(words or ran >= 45, f"only {ran} commands found on {len(PAGES)} pages: they are no longer recognised")


main(test)
