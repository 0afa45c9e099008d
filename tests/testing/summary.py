"""Closing lines of tools/test: what was skipped and why, what failed, what each tier came to, and `N passed, N failed, N skipped`.

summary.py FOLDER

FOLDER is Testing/ of a build tree: junit.xml there is what ctest wrote with --output-junit, cases/<name of the test>.xml what a
GoogleTest program did, left_out.json the tests that unchanged.py found to need no second run, with their numbers of cases, and
thorough.json, where both tiers ran, what `ctest --show-only=json-v1 -L thorough` says of the second. A GoogleTest program counts as its
cases, any other test of ctest as one; a program that ended without telling its cases counts as one that failed. Exits with 1 when
something failed or nothing was run."""

import collections
import json
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


def outcomes_of(test, cases):
    """Of one test in ctest's JUnit file: one, or as many as its GoogleTest program has cases."""
    name, state = test.get("name"), test.get("status")
    file, skipped = cases / f"{name}.xml", test.find("skipped")
    if file.exists():
        found = list(cases_of(name, file))
        if state != "run" and not any(outcome.state == "failed" for outcome in found):
            found.append(Outcome(name, "failed", ""))  # an abort behind the last case, a leak, a time limit
        return found
    if state == "run":
        return [Outcome(name, "passed", "")]
    if skipped is not None and "SKIP" in (skipped.get("message") or ""):
        return [Outcome(name, "skipped", reason_of_skip(test))]
    return [Outcome(name, "failed", "")]


def outcomes_by_test(junit, cases):
    """By the name of the test; nothing when ctest ran nothing, because it refused its arguments."""
    if not junit.exists():
        return {}
    return {test.get("name"): outcomes_of(test, cases) for test in ElementTree.parse(junit).getroot().iter("testcase")}


def counts_told(outcomes, earlier=0):
    count = collections.Counter(outcome.state for outcome in outcomes)
    return f"{count['passed'] + earlier} passed, {count['failed']} failed, {count['skipped']} skipped"


def print_tiers(by_test, thorough):
    """A line for each tier; `thorough` are the names of the second's tests."""
    print()
    for tier, names in (("First tier", by_test.keys() - thorough), ("Second tier", thorough)):
        outcomes = [outcome for name in names for outcome in by_test[name]]
        print(f"{tier}, {len(names)} tests: {counts_told(outcomes)}")


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


def main(testing):
    testing = pathlib.Path(testing)
    by_test = outcomes_by_test(testing / "junit.xml", testing / "cases")
    outcomes = [outcome for found in by_test.values() for outcome in found]
    left_out = json.loads((testing / "left_out.json").read_text(encoding="utf-8")) if (testing / "left_out.json").exists() else {}
    print_skipped([outcome for outcome in outcomes if outcome.state == "skipped"])
    failed = sorted(outcome.name for outcome in outcomes if outcome.state == "failed")
    if failed:
        print("\nFailed:")
        for name in failed:
            print(f"  {name}")
    left_out = {name: cases for name, cases in left_out.items() if name not in by_test}  # what a fixture makes may have run again
    earlier = sum(left_out.values())
    if earlier:
        print(f"\n{earlier} of the passed ones, in {len(left_out)} tests, ran before with the same program, files and packages; "
              "tools/test --all runs them again.")
    if (testing / "thorough.json").exists():
        told = json.loads((testing / "thorough.json").read_text(encoding="utf-8"))
        print_tiers(by_test, by_test.keys() & {test["name"] for test in told["tests"]})
    print(f"\n{counts_told(outcomes, earlier)}")
    return 1 if failed or not outcomes else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))
