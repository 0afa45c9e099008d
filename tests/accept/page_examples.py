"""Examples on pages of the documentation: found, run, and held against what the page says that they print.

In a block of a page, a line that begins with "$ " is a command (as far as lines end with a backslash), and the lines
below it are what it prints on standard output. "⋮" stands for anything: alone on a line for any number of lines, else
for any part of that line. Numbers before " ms" are times of one machine and are not compared."""

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


def run_example(where, command, expected, folder, environment, may_fail=False):
    """Runs a command in a folder, checks what it prints where the page says anything, and returns its exit code."""
    began = time.monotonic()
    done = subprocess.run(["bash", "-euo", "pipefail", "-c", command], cwd=folder, env=environment, text=True,
                          stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE, check=False)
    print(f"{where}: {time.monotonic() - began:.1f} s: {command.splitlines()[0]}", flush=True)
    check(may_fail or done.returncode == 0, f"{where}: $ {command}\nexit {done.returncode}\n{done.stdout}{done.stderr}")
    check(not expected or same_lines(expected, done.stdout.splitlines()),
          f"{where}: $ {command}\nprints\n{done.stdout}and the page says\n" + "\n".join(expected)
          + f"\nstandard error:\n{done.stderr}")
    return done.returncode
