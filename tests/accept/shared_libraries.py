"""The shared libraries that accept.install installed: their names, what they load, and what they export, which is what
installed headers declare.

shared_libraries.py INSTALLED"""

import pathlib
import re
import subprocess
import sys

from acceptance import Failed, check, run

GROUND = ("gdal", "GeographicLib", "ceres", "fftw", "yaml-cpp", "opencv_imgcodecs")


def dynamic(library, tag):
    """The values of one tag of the dynamic section: names in brackets."""
    return re.findall(rf"\({tag}\).*\[(.*)\]", run("readelf", "-d", "-W", library))


def exported_functions(library):
    """The functions and methods of namespace pilotage that the library defines and shows: their last names."""
    listing = subprocess.run(["nm", "-D", "-C", "--defined-only", str(library)], text=True, stdout=subprocess.PIPE,
                             check=True).stdout
    names = set()
    for line in listing.splitlines():
        found = re.match(r"[0-9a-f]+ T (pilotage::[^(]*)\(", line)
        if found:
            names.add(re.sub(r"\[abi:.*|<.*", "", found.group(1)).split("::")[-1])
    return {name for name in names if not name.startswith("operator")}


def check_library(installed, prefix, name, used):
    """`used`: what a program calls. Returns the library and how many names of functions it exports."""
    found = list(prefix.rglob(f"libpilotage_{name}.so"))
    check(len(found) == 1, f"{prefix}: libpilotage_{name}.so: {found}")
    check(dynamic(found[0], "SONAME") == [f"libpilotage_{name}.so.0"], f"SONAME: {dynamic(found[0], 'SONAME')}")
    check((found[0].parent / f"libpilotage_{name}.so.0").exists(), f"libpilotage_{name}.so.0 is not installed")
    functions = exported_functions(found[0])
    headers = "".join(path.read_text() for path in (installed / "everything/include").rglob("*.h"))
    words = set(re.findall(r"~?\w+", headers))
    surplus = sorted(functions - words)
    check(not surplus, f"libpilotage_{name}.so exports what no installed header declares: {surplus}")
    missing = sorted(set(used) - functions)
    check(not missing, f"libpilotage_{name}.so does not export {missing}; it does {sorted(functions)}")
    return found[0], len(functions)


def test(installed):
    flies, onboard = check_library(installed, installed / "onboard", "onboard",
                                   ["match", "MapReader", "tiles_near", "nav_sat_fix", "mavlink_global_position_sensor",
                                    "match_status_name", "match_status_text", "resized_camera", "camera_problem"])
    needed = dynamic(flies, "NEEDED")
    check(not [name for name in needed if any(part in name for part in GROUND)], f"what flies loads {needed}")
    _, prep = check_library(installed, installed / "everything", "prep",
                            ["prepare", "plan_tiles", "select_tiles", "build_map", "make_report", "verify_map",
                             "require_intact", "sign_file", "match", "MapReader"])
    print(f"{onboard} and {prep} names of functions exported")


try:
    test(pathlib.Path(sys.argv[1]))
except Failed as failure:
    print(f"FAILED: {failure}")
    sys.exit(1)
