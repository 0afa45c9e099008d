"""Where a frame would be recognised: P(correct fix) of each tile and the tiles that are stored, over the route.

    python3 heat_map.py OUT heat_map.png

OUT is a folder that `pilotage prepare` wrote."""

import json
import pathlib
import sys

import matplotlib
import numpy

matplotlib.use("Agg")
import matplotlib.pyplot as plt

import pilotage

folder, picture = pathlib.Path(sys.argv[1]), sys.argv[2]
tiles = pilotage.read_table(folder / "tiles.csv")
plan = json.loads((folder / "plan.json").read_text(encoding="utf-8"))
selection = json.loads((folder / "selection.json").read_text(encoding="utf-8"))

# Neighbouring tiles overlap: each is drawn as the square of one stride around its centre.
level = plan["levels"][0]
side_m = level["stride_px"] * level["gsd_m"]
tiles = tiles[tiles["level"] == level["level"]]
x_m = (tiles["min_x_m"] + tiles["max_x_m"]) / 2
y_m = (tiles["min_y_m"] + tiles["max_y_m"]) / 2
column = numpy.round((x_m - x_m.min()) / side_m).astype(int)
row = numpy.round((y_m.max() - y_m) / side_m).astype(int)
p = numpy.full((row.max() + 1, column.max() + 1), numpy.nan)
p[row, column] = tiles["p_correct_fix"]
extent = (x_m.min() - side_m / 2, x_m.max() + side_m / 2, y_m.min() - side_m / 2, y_m.max() + side_m / 2)

figure, axes = plt.subplots(figsize=(9, 5), layout="constrained")
image = axes.imshow(p, extent=extent, cmap="cividis", vmin=0, vmax=1, interpolation="nearest")
stored = numpy.isin(tiles["tile_id"], selection["tile_ids"])
axes.scatter(x_m[~stored], y_m[~stored], marker="x", color="tab:red", label="not stored")
samples = plan["route_samples"]
axes.plot([sample["x_m"] for sample in samples], [sample["y_m"] for sample in samples], color="black", linewidth=1, label="route")
axes.set(xlabel=f"easting in m, {plan['crs_name']}", ylabel="northing in m", aspect="equal",
         title=f"{int(stored.sum())} of {len(tiles)} tiles stored; P is modelled")
axes.ticklabel_format(useOffset=False, style="plain")
axes.legend(loc="best")
figure.colorbar(image, label="P(correct fix)", shrink=0.8)
figure.savefig(picture, dpi=100)
