"""What a better inertial system buys: flights of one plan that stay within the limit, by grade, with their intervals.

    python3 inertial_grades.py MISSION inertial_grades.png [FLIGHTS]"""

import pathlib
import sys
import tempfile

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

import pilotage

mission, picture = sys.argv[1:3]
flights = int(sys.argv[3]) if len(sys.argv) > 3 else 2000
grades = ("industrial", "tactical", "navigation")
flown, planned = [], []
with tempfile.TemporaryDirectory() as folder:
    for grade in grades:
        out = pathlib.Path(folder, grade)
        pilotage.prepare(mission, output=out, ins_grade=grade, outputs="json", flights=0)
        simulation = pilotage.simulate(out, output=out / "simulation.json", flights=flights)
        flown.append(simulation["within"])
        planned.append(simulation["planned_p"])
        print(f"{grade}: {simulation['within']['share']:.3f} of {flights} simulated flights, planned {simulation['planned_p']:.3f}")

figure, axes = plt.subplots(figsize=(7, 4), layout="constrained")
share = [one["share"] for one in flown]
bars = [[one["share"] - one["low"] for one in flown], [one["high"] - one["share"] for one in flown]]
axes.errorbar(grades, share, yerr=bars, fmt="o", capsize=6, label=f"simulated, {flights} flights, 95 % interval")
axes.plot(grades, planned, "k_", markersize=20, label="planned")
axes.set(ylabel="flights within the limit all the way", ylim=(0, 1.05), title=pathlib.Path(mission).name)
axes.legend(loc="lower right")
figure.savefig(picture, dpi=100)
