"""`reroute` over a real port: straight lines that are NO-GO become GO, and `prepare` of the new plan says the same.

reroute_real_imagery.py PILOTAGE SOURCE_FOLDER

The lines are some of those of studies/reroute_port.py."""

import json
import math
import re

from acceptance import check, main, real_data, run

MISSION = {"camera": {"hfov_deg": 60, "width_px": 4000, "height_px": 3000}, "ins": {"grade": "consumer"}, "agl_m": 70,
           "speed_mps": 15, "max_error_m": 40}
LINES = (((114.8747159, -1.0766802), (114.8778946, -1.0741762)), ((114.8762954, -1.0722005), (114.8736747, -1.0743062)),
         ((114.8757102, -1.0728647), (114.8707938, -1.0748981)))
METRES_PER_DEG = 111_000  # near the equator, to a percent


def distance_m(a, b):
    return METRES_PER_DEG * math.dist(a, b)


def test(pilotage, source, work, _):
    imagery = real_data(source) / "port/port_2019-08.tif"
    check(imagery.exists(), f"{imagery} is not there")
    mission = work / "mission.json"
    mission.write_text(json.dumps({"imagery": [str(imagery)], **MISSION}), encoding="utf-8")
    for number, (start, end) in enumerate(LINES, 1):
        plan, ends = work / f"new{number}.plan", [f"--{word}={place[0]:.7f},{place[1]:.7f}" for word, place in (("from", start), ("to", end))]
        result = json.loads(run(pilotage, "reroute", mission, *ends, "--search-within-m", "600", "--json", "-q", "-o", plan, streams="stdout"))
        planned, new = result["planned"], result["new"]
        check(planned["verdict"] == "NO-GO" and new["verdict"] == "GO", f"line {number}: {planned['verdict']} to {new['verdict']}")
        points = new["points"]
        check(distance_m(points[0], start) < 0.1 and distance_m(points[-1], end) < 0.1, f"line {number}: other ends: {points}")
        flown_m = sum(distance_m(a, b) for a, b in zip(points, points[1:]))
        check(abs(flown_m / new["length_m"] - 1) < 0.02 and new["length_m"] > planned["length_m"] > 0.98 * distance_m(start, end),
              f"line {number}: {new['length_m']} m for points that are {flown_m:.0f} m, instead of {planned['length_m']} m")
        said = run(pilotage, "prepare", mission, "--route", plan, "--outputs", "json", "-q", "-o", work / f"out{number}")
        check(re.search(r"^(GO: .*)$", said, re.M).group(1) == new["verdict_text"], f"line {number}: prepare says\n{said}\nand reroute\n{new['verdict_text']}")
        print(f"line {number}: P {planned['p_within_limit']:.3f} to {new['p_within_limit']:.3f}, {planned['length_m']:.0f} m to {new['length_m']:.0f} m")


main(test)
