"""`reroute` over a real port: straight lines that are NO-GO become GO, and `prepare` of the new plan says the same.

reroute_real_imagery.py PILOTAGE SOURCE_FOLDER

The lines are some of those of studies/reroute_port.py. The level of P at this place is learned from its second date
first: on one date alone P is so little sure of it that no line would be GO at nine places of ten with this limit. The day is
calm and the map without error: in wind such an inertial system loses too many flights on any line."""

import json
import math
import re

from acceptance import check, main, real_data, run

MISSION = {"camera": {"hfov_deg": 60, "width_px": 4000, "height_px": 3000}, "ins": {"grade": "consumer"}, "agl_m": 70,
           "speed_mps": 15, "max_error_m": 40, "wind_sigma_mps": 0, "map_sigma_m": 0}
LINES = (((114.8740858, -1.0760586), (114.8771832, -1.0742191)), ((114.8711337, -1.0743396), (114.8764921, -1.0722332)))
METRES_PER_DEG = 111_000  # near the equator, to a percent


def distance_m(a, b):
    return METRES_PER_DEG * math.dist(a, b)


def test(pilotage, source, work, _):
    imagery, other = (real_data(source) / f"port/port_{date}.tif" for date in ("2019-08", "2020-07_registered"))
    check(imagery.exists(), f"{imagery} is not there")
    (work / "judged").mkdir()
    run(pilotage, "score", imagery, "--gsd-m", "0.6", "--tile-size-px", "111", "--stride-px", "27", "--search-radius-px", "58", "--measures",
        "correct_fix", "--second-epoch", other, "--registration-ties-shadows", "follow", "--evaluate", other, "--evaluate-max-tiles", "600",
        "--evaluate-resamples", "0", "-q", "-o", work / "judged/scores.tif")
    model = work / "model.json"
    print(run(pilotage, "calibrate", f"port={work / 'judged'}", "--adapt", "default", "-o", model), end="")
    mission = work / "mission.json"
    mission.write_text(json.dumps({"imagery": [str(imagery)], "score": {"model": str(model)}, **MISSION}), encoding="utf-8")
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
