"""What the acceptance tests share: running the program, and saying what did not come out."""

import os
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
        print(f"skipped: {error}: apt-get install python3-gdal python3-numpy")
        sys.exit(SKIP)
    gdal.UseExceptions()
    return gdal


def need_sample(source):
    """Leaves with "skipped" when the sample mission's imagery is not made."""
    if not (source / "maps/sample/ortho.tif").exists():
        print("skipped: the sample's imagery is not made (target sample_mission)")
        sys.exit(SKIP)


def real_data(source):
    """The folder of real imagery, $PILOTAGE_DATA or else ../shared/data beside the repository. Without it leaves with "skipped", and
    with a failure when PILOTAGE_DATA names no folder or an empty one: who sets it wants these tests run."""
    named = os.environ.get("PILOTAGE_DATA")
    if named is not None:
        if not os.path.isdir(named) or not os.listdir(named):
            print(f'FAILED: PILOTAGE_DATA = "{named}" is not a folder with imagery in it')
            sys.exit(1)
        return pathlib.Path(named)
    beside = source / "../shared/data"
    if not beside.is_dir():
        print("skipped: no real imagery: set PILOTAGE_DATA to the folder that holds it")
        sys.exit(SKIP)
    return beside


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
