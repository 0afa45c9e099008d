"""Closing lines of tools/test: what was skipped and why, what failed, and `N passed, N failed, N skipped`.

summary.py JUNIT_FILE CASES_FOLDER [JUNIT_FILE CASES_FOLDER ...]

One pair for each run of ctest: what it wrote with --output-junit, and the folder where its GoogleTest programs left
<name of the test>.xml. A GoogleTest program counts as its cases, any other test of ctest as one; a program that ended without
telling its cases counts as one that failed. Exits with 1 when something failed or nothing was run."""

import collections
import pathlib
import re
import sys
import xml.etree.ElementTree as ElementTree

Outcome = collections.namedtuple("Outcome", "name state reason")


def last_line(text, pattern):
    found = [line for line in (text or "").splitlines() if re.search(pattern, line)]
    return found[-1] if found else ""


def reason_of_skip(test):
    """What the test printed behind "skipped: "; the case runner and all scripts say it so."""
    said = last_line(test.findtext("system-out"), r"skipped: ")
    return said.partition("skipped: ")[2].strip() or "it does not say why"


def cases_of(name, file):
    """The outcomes of a GoogleTest program."""
    for case in ElementTree.parse(file).getroot().iter("testcase"):
        full = f"{name}: {case.get('classname')}.{case.get('name')}"
        skipped = case.find("skipped")
        if case.find("failure") is not None:
            yield Outcome(full, "failed", "")
        elif skipped is not None or case.get("result") in ("skipped", "suppressed") or case.get("status") == "notrun":
            # The message begins with a line FILE:LINE.
            said = (skipped.get("message") if skipped is not None else "") or ""
            yield Outcome(full, "skipped", " ".join(said.splitlines()[1:]).strip() or "it does not say why")
        else:
            yield Outcome(full, "passed", "")


def outcomes_of(junit, cases):
    for test in ElementTree.parse(junit).getroot().iter("testcase"):
        name, state = test.get("name"), test.get("status")
        file = cases / f"{name}.xml"
        skipped = test.find("skipped")
        if file.exists():
            found = list(cases_of(name, file))
            yield from found
            if state != "run" and not any(outcome.state == "failed" for outcome in found):
                yield Outcome(name, "failed", "")  # an abort behind the last case, a leak, a time limit
        elif state == "run":
            yield Outcome(name, "passed", "")
        elif skipped is not None and "SKIP" in (skipped.get("message") or ""):
            yield Outcome(name, "skipped", reason_of_skip(test))
        else:
            yield Outcome(name, "failed", "")


def print_skipped(outcomes):
    """One paragraph for each reason, with the tests that gave it."""
    by_reason = collections.defaultdict(list)
    for outcome in outcomes:
        by_reason[outcome.reason].append(outcome.name)
    if by_reason:
        print("\nSkipped, and why:")
    for reason, names in sorted(by_reason.items()):
        print(f"  {reason}")
        for name in sorted(names):
            print(f"    {name}")


def main(arguments):
    outcomes = []
    for junit, cases in zip(arguments[::2], arguments[1::2]):
        if not pathlib.Path(junit).exists():  # ctest refused its arguments
            print(f"{junit}: does not exist, so ctest ran nothing")
            return 1
        outcomes.extend(outcomes_of(pathlib.Path(junit), pathlib.Path(cases)))
    print_skipped([outcome for outcome in outcomes if outcome.state == "skipped"])
    failed = sorted(outcome.name for outcome in outcomes if outcome.state == "failed")
    if failed:
        print("\nFailed:")
        for name in failed:
            print(f"  {name}")
    count = collections.Counter(outcome.state for outcome in outcomes)
    print(f"\n{count['passed']} passed, {count['failed']} failed, {count['skipped']} skipped")
    return 1 if failed or not outcomes else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
