"""The matcher over the sample mission's country: map of June, frames of September of the next year by another camera.

match_sample_mission.py PILOTAGE SOURCE_FOLDER CUT_FLIGHT_FRAMES"""

import sys

from acceptance import SKIP, check, main
from match_flights import check_none, check_rates, cut, fly, tell_heights, whole_map

FRAMES = 100


def test(pilotage, source, work, rest):
    tool = rest[0]
    first, second = (source / "maps/sample" / name for name in ("ortho.tif", "ortho_second_epoch.tif"))
    if not second.exists():
        print("skipped: the sample mission's imagery is not made: cmake --build … --target sample_mission")
        sys.exit(SKIP)
    map_path = whole_map(pilotage, first, work / "map.gpkg", 154)
    here = cut(tool, second, work / "here", frames=FRAMES, footprint_m=154)
    # One frame in a hundred lies over an orchard, whose rows look alike every five metres.
    told = fly(pilotage, map_path, here)
    check_rates("another date", told, 0.6, 0.02)
    check(not any("lie" in warning or "lean" in warning for warning in told["warnings"]), f"fixes lean: {told['warnings']}")
    # Told 8 % too high, as over heights of another datum: fixes come, and all of them are lower.
    tell_heights(here, 1.08)
    told = fly(pilotage, map_path, here)
    check(any("below the heights that the matcher was told" in warning for warning in told["warnings"]),
          f"heights that are off by 8 % are not noticed: {told['lean']}, {told['warnings']}")
    same = cut(tool, first, work / "same", frames=FRAMES, footprint_m=154, seed=2)
    check_rates("the same date", fly(pilotage, map_path, same), 0.8, 0.02)
    shifted = cut(tool, second, work / "shifted", frames=FRAMES, footprint_m=154, prior_shift_m=600, seed=3)
    check_none("priors 600 m off", fly(pilotage, map_path, shifted))


main(test)
