"""How far off the aircraft may be along the route, and where the gaps are.

    python3 error_along_route.py OUT error_along_route.png

OUT is a folder that `pilotage prepare` wrote."""

import json
import pathlib
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

folder, picture = pathlib.Path(sys.argv[1]), sys.argv[2]
selection = json.loads((folder / "selection.json").read_text(encoding="utf-8"))
profile = selection["error_profile"]
km = [point["distance_m"] / 1000 for point in profile]

figure, (above, below) = plt.subplots(2, 1, figsize=(9, 5), sharex=True, layout="constrained")
above.plot(km, [point["error_m"] for point in profile], color="tab:blue")
above.axhline(selection["max_error_m"], color="tab:red", linestyle="--", label=f"limit {selection['max_error_m']:g} m")
for gap in selection["gaps"]:
    above.axvspan(gap["from_distance_m"] / 1000, gap["to_distance_m"] / 1000, color="tab:gray", alpha=0.3)
above.set(ylabel=f"position error in m, {selection['sigma_multiple']:g} sigma", ylim=(0, None),
          title=f"{len(selection['gaps'])} gaps without a matching area; modelled")
above.legend()
below.plot(km, [point["p_within_limit"] for point in profile], color="tab:green", label="share of flights within the limit so far")
below.plot(km, [point["p_correct_fix"] for point in profile], color="tab:orange", linewidth=0.8, label="P(correct fix) below")
simulation = folder / "simulation.json"
if simulation.exists():
    flown = json.loads(simulation.read_text(encoding="utf-8"))["along"]
    below.plot([point["distance_m"] / 1000 for point in flown], [point["p_within"] for point in flown], "k:", label="the same of simulated flights")
below.set(xlabel="way along the route in km", ylabel="probability", ylim=(0, 1.05))
below.legend(loc="lower left")
figure.savefig(picture, dpi=100)
