"""A frame and where it was found: the answer of the onboard matcher beside what the aircraft believed.

    python3 match_frame.py MAP FRAMES.csv NUMBER match_frame.png

NUMBER counts the rows of the table from 0. Frames are 8-bit gray PGM, which need no decoder."""

import pathlib
import sys

import matplotlib
import numpy

matplotlib.use("Agg")
import matplotlib.pyplot as plt
from matplotlib.patches import Ellipse

import pilotage

DEG_PER_M = 1 / 111_320  # of latitude


def read_pgm(path):
    data = path.read_bytes()
    kind, width, height, _ = data.split(maxsplit=4)[:4]
    assert kind == b"P5", f"{path}: is no binary PGM"
    width, height = int(width), int(height)
    return numpy.frombuffer(data, numpy.uint8)[-width * height:].reshape(height, width)


def ellipse(covariance_m2, center, **style):
    """That holds 95 % of a normal error in two dimensions."""
    variances, axes = numpy.linalg.eigh(covariance_m2)
    width, height = 2 * numpy.sqrt(5.991 * variances)
    angle_deg = numpy.degrees(numpy.arctan2(axes[1, 0], axes[0, 0]))
    return Ellipse(center, width, height, angle=angle_deg, fill=False, **style)


map, table = pilotage.Map(sys.argv[1]), pathlib.Path(sys.argv[2])
row = pilotage.read_table(table)[int(sys.argv[3])]
frame = read_pgm(table.parent / row["file"])
prior = pilotage.Prior(lon_deg=row["prior_lon_deg"], lat_deg=row["prior_lat_deg"], sigma_m=row["prior_sigma_m"],
                       height_agl_m=row["height_agl_m"], yaw_deg=row["yaw_deg"], pitch_deg=row["pitch_deg"], roll_deg=row["roll_deg"])
result = map.match(frame, prior)


def east_north_m(lon_deg, lat_deg):
    """From the prior's position, to some millimetres over such ways."""
    return ((lon_deg - prior.lon_deg) / DEG_PER_M * numpy.cos(numpy.radians(prior.lat_deg)), (lat_deg - prior.lat_deg) / DEG_PER_M)


figure, (left, right) = plt.subplots(1, 2, figsize=(11, 5), layout="constrained")
left.imshow(frame, cmap="gray", vmin=0, vmax=255)
left.set(title=f"{row['file']}: {result.text}", xticks=[], yticks=[])
right.plot(0, 0, "o", color="tab:blue", label="believed")
right.add_patch(ellipse(prior.covariance_en_m2, (0, 0), color="tab:blue"))
for tile in map.near(prior.lon_deg, prior.lat_deg, 60):
    east_m, north_m = east_north_m(tile["lon_deg"], tile["lat_deg"])
    right.plot(east_m, north_m, "+", color="gray")
if result:
    place = east_north_m(result.fix.lon_deg, result.fix.lat_deg)
    right.plot(*place, "s", color="tab:orange", label=f"fix, {result.stats.inliers} pairs of features")
    right.add_patch(ellipse(result.fix.covariance_en_m2, place, color="tab:orange"))
if "true_nadir_lon_deg" in row.dtype.names:
    right.plot(*east_north_m(row["true_nadir_lon_deg"], row["true_nadir_lat_deg"]), "x", color="black", label="where it was")
right.set(xlabel="east in m", ylabel="north in m", aspect="equal", title="95 % ellipses; + are centres of stored tiles")
right.legend()
figure.savefig(sys.argv[4], dpi=100)
print(result.status, *(f"{value:.8f}" for value in ((result.fix.lon_deg, result.fix.lat_deg) if result else ())))
