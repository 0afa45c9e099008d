"""Examples on pages of the documentation: found, run, and held against what the page says that they print.

In a block of a page, a line that begins with "$ " is a command (as far as lines end with a backslash), and the lines
below it are what it prints on standard output. "⋮" stands for anything: alone on a line for any number of lines, else
for any part of that line. Numbers before " ms" are times of one machine and are not compared.

With PILOTAGE_REWRITE_EXAMPLES=1 what a page says is replaced by what is printed, as far as its "⋮" show where; look at
the difference before you keep it."""

import difflib
import os
import re
import subprocess
import time

from acceptance import check

ANYTHING = "⋮"
TIME = re.compile(r"\d+(\.\d+)? ms\b")


def blocks(page):
    """(line number of the first line, lines) of each block of a page that names no other language, in its order."""
    found = []
    fence = None
    for number, line in enumerate(page.read_text(encoding="utf-8").splitlines(), 1):
        if line.lstrip().startswith("```"):
            if fence is None and line.strip() == "```":
                found.append((number + 1, []))
            fence = line.strip() if fence is None else None
        elif fence == "```":
            found[-1][1].append(line)
    return found


def examples_in(block):
    """(line number, command, expected lines) of a block, in its order."""
    first, lines = block
    found = []
    continued = False
    for number, line in enumerate(lines, first):
        if line.startswith("$ "):
            found.append((number, line[2:], []))
            continued = line.endswith("\\")
        elif continued:
            start, command, expected = found[-1]
            found[-1] = (start, command + "\n" + line, expected)
            continued = line.endswith("\\")
        elif found:
            found[-1][2].append(line)
    return [(number, command, expected[:-1] if expected and not expected[-1] else expected)
            for number, command, expected in found]


def same_line(expected, printed):
    expected, printed = TIME.sub("0 ms", expected), TIME.sub("0 ms", printed)
    return re.fullmatch(".*".join(re.escape(part) for part in expected.split(ANYTHING)), printed) is not None


def same_lines(expected, printed):
    """Whether the printed lines are the expected ones."""
    if not expected:
        return not printed
    if expected[0] == ANYTHING:
        return any(same_lines(expected[1:], printed[i:]) for i in range(len(printed) + 1))
    return bool(printed) and same_line(expected[0], printed[0]) and same_lines(expected[1:], printed[1:])


def filled_line(expected, printed):
    """The printed line, cut where the expected one is."""
    if ANYTHING not in expected:
        return printed
    first, last = expected.split(ANYTHING)[0], expected.split(ANYTHING)[-1]
    return printed[:len(first)] + ANYTHING + (printed[-len(last):] if last else "")


def filled_lines(expected, printed):
    """The printed lines, where the expected ones stand between their cuts: at the beginning, at the end, or most alike."""
    if ANYTHING not in expected:
        if not any(ANYTHING in line for line in expected):
            return printed
        return [filled_line(a, b) for a, b in zip(expected, printed)] if len(expected) == len(printed) else None
    filled = []
    at = 0
    runs = "\n".join(expected).split(ANYTHING + "\n") if expected[-1] != ANYTHING else "\n".join(expected[:-1]).split(ANYTHING + "\n")
    for number, run in enumerate(runs):
        lines = run.rstrip("\n").split("\n") if run.strip("\n") else []
        if number == 0:
            begin = 0
        elif number + 1 == len(runs) and expected[-1] != ANYTHING:
            begin = len(printed) - len(lines)
        else:
            alike = [sum(difflib.SequenceMatcher(None, a, b).ratio() for a, b in zip(lines, printed[i:])) for i in range(at, len(printed))]
            begin = at + alike.index(max(alike)) if alike else at
        if begin + len(lines) > len(printed) or begin < at:
            return None
        filled += ([ANYTHING] if number else []) + [filled_line(a, b) for a, b in zip(lines, printed[begin:])]
        at = begin + len(lines)
    return filled + ([ANYTHING] if expected[-1] == ANYTHING else [])


def rewrite(page, command, expected, printed):
    """Puts what is printed onto the page in place of what it says."""
    filled = filled_lines(expected, printed)
    text = page.read_text(encoding="utf-8")
    said = f"$ {command}\n" + "\n".join(expected)
    if filled is None or not same_lines(filled, printed) or text.count(said) != 1:
        return False
    page.write_text(text.replace(said, f"$ {command}\n" + "\n".join(filled)), encoding="utf-8")
    return True


def run_example(where, command, expected, folder, environment, may_fail=False, page=None):
    """Runs a command in a folder, checks what it prints where the page says anything, and returns its exit code."""
    began = time.monotonic()
    done = subprocess.run(["bash", "-euo", "pipefail", "-c", command], cwd=folder, env=environment, text=True,
                          stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE, check=False)
    print(f"{where}: {time.monotonic() - began:.1f} s: {command.splitlines()[0]}", flush=True)
    check(may_fail or done.returncode == 0, f"{where}: $ {command}\nexit {done.returncode}\n{done.stdout}{done.stderr}")
    printed = done.stdout.splitlines()
    if expected and not same_lines(expected, printed) and page is not None and os.environ.get("PILOTAGE_REWRITE_EXAMPLES") == "1":
        if rewrite(page, command, expected, printed):
            print(f"{where}: rewritten", flush=True)
            return done.returncode
    check(not expected or same_lines(expected, printed),
          f"{where}: $ {command}\nprints\n{done.stdout}and the page says\n" + "\n".join(expected)
          + f"\nstandard error:\n{done.stderr}")
    return done.returncode
