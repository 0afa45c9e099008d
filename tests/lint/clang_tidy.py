"""clang-tidy 14 over the sources of src, tools and maps, by .clang-tidy; what passed once is not looked at again.

clang_tidy.py SOURCE BUILD [--analyzer] [FILE...]

What is compiled as one (a folder of src, a program) is looked at as one, and passes for good: the digest of configuration, compile
command and every file that its last compilation read is kept in $XDG_CACHE_HOME/pilotage/clang-tidy, for all build trees and checkouts
of a user. Without --analyzer the checks clang-analyzer-* are left out (docs/decisions/checks-in-tests.md). With FILEs, relative to
SOURCE, only what compiles these is looked at."""

import argparse
import concurrent.futures
import hashlib
import json
import os
import pathlib
import re
import shlex
import shutil
import subprocess
import sys

FOLDERS = ("src", "tools", "maps")


def find_clang_tidy():
    """The program and its version; leaves with "skipped" when version 14 is not there: others find other things."""
    for name in ("clang-tidy-14", "clang-tidy"):
        if shutil.which(name):
            told = subprocess.run([name, "--version"], stdout=subprocess.PIPE, text=True, check=True).stdout
            version = re.search(r"version (14\.[0-9.]+)", told)
            if version:
                return name, version.group(1)
    print("skipped: clang-tidy 14 is not installed: apt-get install clang-tidy")
    sys.exit(77)


def headers_by_object(build):
    """What ninja knows of every object: the files that its last compilation read."""
    told = subprocess.run(["ninja", "-C", build, "-t", "deps"], stdout=subprocess.PIPE, text=True, check=True).stdout
    found, current = {}, None
    for line in told.splitlines():
        if line.startswith("    "):
            found[current].append(line.strip())
        elif ": #deps" in line:
            current = line.partition(":")[0]
            found[current] = [] if "(VALID)" in line else None
            if found[current] is None:
                del found[current]
                current = "stale"
                found[current] = []
    return found


class Digests:
    """SHA-256 of files, each read once."""

    def __init__(self):
        self.known = {}

    def of(self, path):
        if path not in self.known:
            self.known[path] = hashlib.sha256(pathlib.Path(path).read_bytes()).hexdigest()
        return self.known[path]


def key_of(entry, source, build, headers, digests, common):
    """The digest of all that decides what clang-tidy says of a source, or None when its headers are not known."""
    command = shlex.split(entry["command"])
    output = command[command.index("-o") + 1]
    if output not in headers:
        return None
    flags = [flag for flag in command[command.index("-o") + 2:] + command[:command.index("-o")] if "/" not in flag or flag[0] == "-"]
    digest = hashlib.sha256(json.dumps([common, sorted(flag.replace(source, "").replace(build, "") for flag in flags)]).encode())
    for file in sorted({os.path.normpath(os.path.join(build, name)) for name in [entry["file"], *headers[output]]}):
        digest.update(f"{file.replace(build, 'BUILD').replace(source, '')} {digests.of(file)}\n".encode())
    return digest.hexdigest()


def sources_of(entry, source):
    """The files of SOURCE, relative to it, that a compile command compiles: more than one where CMake put several into one."""
    path = pathlib.Path(entry["file"])
    files = re.findall(r'^#include "(.*)"$', path.read_text(encoding="utf-8"), re.MULTILINE) if path.parent.name == "Unity" else [path]
    return [os.path.relpath(file, source) for file in files]


def parsed_arguments():
    parser = argparse.ArgumentParser()
    parser.add_argument("source")
    parser.add_argument("build")
    parser.add_argument("--analyzer", action="store_true")
    parser.add_argument("files", nargs="*")
    options = parser.parse_args()
    options.source, options.build = os.path.realpath(options.source), os.path.realpath(options.build)
    return options


def main():
    options = parsed_arguments()
    program, version = find_clang_tidy()
    checks = [] if options.analyzer else ["--checks=-clang-analyzer-*"]
    cache = pathlib.Path(os.environ.get("XDG_CACHE_HOME") or pathlib.Path.home() / ".cache") / "pilotage/clang-tidy"
    cache.mkdir(parents=True, exist_ok=True)
    entries = json.loads((pathlib.Path(options.build) / "compile_commands.json").read_text(encoding="utf-8"))
    wanted = {os.path.normpath(file) for file in options.files}
    chosen, missing = {}, set(wanted)
    for entry in entries:
        sources = sources_of(entry, options.source)
        if wanted.intersection(sources) if wanted else any(file.split(os.sep)[0] in FOLDERS for file in sources):
            chosen[entry["file"]] = entry
            missing.difference_update(sources)
    if not chosen or missing:
        print(f"{options.build}/compile_commands.json: has no {', '.join(sorted(missing)) or 'source of ours'}")
        return 1
    headers, digests = headers_by_object(options.build), Digests()
    common = [version, checks, digests.of(os.path.join(options.source, ".clang-tidy"))]

    def look(entry):
        key = key_of(entry, options.source, options.build, headers, digests, common)
        if key and (cache / key).exists():
            return True, ""
        done = subprocess.run([program, "-p", options.build, "--quiet", *checks, entry["file"]], stdout=subprocess.PIPE,
                              stderr=subprocess.PIPE, text=True, check=False)
        if done.returncode != 0:
            return False, done.stdout or done.stderr
        if key:
            (cache / key).touch()
        return False, ""

    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        results = list(pool.map(look, chosen.values()))
    problems = [text for _, text in results if text]
    print("\n".join(problems))
    before = sum(known for known, _ in results)
    print(f"{len(results)} compilations: {before} passed before, {len(problems)} with problems")
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
