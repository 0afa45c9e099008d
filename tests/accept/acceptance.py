"""What the acceptance tests share: running the program, and saying what did not come out."""

import pathlib
import shutil
import subprocess
import sys
import tempfile

SKIP = 77  # ctest's SKIP_RETURN_CODE


def need_gdal():
    """Leaves with "skipped" when GDAL's Python bindings are not installed."""
    try:
        import numpy  # noqa: F401
        from osgeo import gdal
    except ImportError as error:
        print(f"skipped: {error}")
        sys.exit(SKIP)
    gdal.UseExceptions()
    return gdal


class Failed(Exception):
    pass


def check(holds, what):
    if not holds:
        raise Failed(what)


def run(*command, expect=0, cwd=None, streams="both"):
    """Runs a command; its exit code must be `expect`. Returns both of its streams as one text, or "stdout" alone."""
    done = subprocess.run([str(part) for part in command], cwd=cwd, text=True, stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT if streams == "both" else None, check=False)
    check(expect is None or done.returncode == expect,
          f"{' '.join(str(part) for part in command)}: exit {done.returncode}, not {expect}\n{done.stdout}")
    return done.stdout if expect is not None else (done.returncode, done.stdout)


def main(test):
    """Runs test(pilotage, source folder, working folder, further arguments) as a ctest test."""
    pilotage, source, *rest = sys.argv[1:]
    work = pathlib.Path(tempfile.mkdtemp(prefix="pilotage_accept_"))
    try:
        test(pathlib.Path(pilotage), pathlib.Path(source), work, rest)
    except Failed as failure:
        print(f"FAILED: {failure}")
        sys.exit(1)
    finally:
        shutil.rmtree(work)
