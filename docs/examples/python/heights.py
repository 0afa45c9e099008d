"""How high to fly over an area: the share of its ground where a camera could find its place, at several heights.

    python3 heights.py ORTHO heights.png [HEIGHT_M ...]"""

import pathlib
import sys
import tempfile

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

import pilotage

ortho, picture = sys.argv[1:3]
heights_m = [float(text) for text in sys.argv[3:]] or [80, 120, 160]
shares = {"go_share": [], "marginal_share": [], "no_go_share": []}
with tempfile.TemporaryDirectory() as folder:
    for height_m in heights_m:
        result = pilotage.survey(ortho, camera_name="DJI Mavic 3E", agl_m=height_m, output=pathlib.Path(folder, f"{height_m:g}"),
                                 progress=lambda what, done, total: print(f"\r{what:40}", end="", file=sys.stderr))
        print(f"\r{height_m:g} m: {result['headline']}")
        for name, values in shares.items():
            values.append(100 * result[name])

figure, axes = plt.subplots(figsize=(7, 4), layout="constrained")
bottom = [0.0] * len(heights_m)
places = [f"{height_m:g}" for height_m in heights_m]
for (name, values), color in zip(shares.items(), ("#2c7fb8", "#d9b300", "#8856a7")):
    axes.bar(places, values, bottom=bottom, color=color, label=name.removesuffix("_share").replace("_", "-"))
    bottom = [low + value for low, value in zip(bottom, values)]
axes.set(xlabel="height above ground in m", ylabel="share of the area in %", ylim=(0, 100), title=f"{pathlib.Path(ortho).name}; modelled")
axes.legend(loc="lower left")
figure.savefig(picture, dpi=100)
