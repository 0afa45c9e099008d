"""Truth of frames in the georeference of the map they are flown over.

registered_truth.py FOLDER TAKEN.tif REFERENCE.tif

Two pictures of the same ground seldom agree to a metre: the port's of 2020 lies up to 8 m off that of 2019 in its
north-east, although it was warped onto it. A fix on the map of the one can then not be judged by the other's
coordinates. So the ground around the true centre of each frame of FOLDER is looked for in the reference by normalised
cross-correlation of the pictures themselves (no feature, no prior takes part). One such shift may be wrong, and the
disagreement of two registered pictures is a smooth field: a frame's true columns in frames.csv are moved by the median
of the NEIGHBOURS shifts found next to it whose peak reaches MIN_NCC; where there are fewer within NEAR_M they stay.
Both pictures share one pixel grid. Prints the shifts' quantiles."""

import csv
import math
import pathlib
import sys

import numpy as np
from acceptance import need_gdal

gdal = need_gdal()
from osgeo import osr  # noqa: E402

HALF_PX = 190  # of the ground compared: 114 m at 0.3 m
REACH_PX = 40  # 12 m
MIN_NCC = 0.3
NEIGHBOURS = 5
NEAR_M = 120


def gray_of(dataset):
    bands = [dataset.GetRasterBand(i + 1).ReadAsArray().astype(np.float32) for i in range(3)]
    gray = 0.299 * bands[0] + 0.587 * bands[1] + 0.114 * bands[2]
    for axis in (0, 1):  # binomial smoothing, about one pixel: grain and JPEG blocks do not correlate
        for _ in range(3):
            gray = 0.25 * np.roll(gray, 1, axis) + 0.5 * gray + 0.25 * np.roll(gray, -1, axis)
    return gray


def find(template, window):
    """Shift (columns, rows) of the template from the middle of the window where the NCC is highest, and that NCC."""
    size = template.shape[0]
    template = template - template.mean()
    shape = [n + size for n in window.shape]
    correlation = np.fft.irfft2(np.fft.rfft2(window, shape) * np.conj(np.fft.rfft2(template, shape)), shape)
    count = window.shape[0] - size + 1
    correlation = correlation[:count, :count]
    sums = []
    for values in (window.astype(np.float64), window.astype(np.float64)**2):
        table = np.pad(values.cumsum(0).cumsum(1), ((1, 0), (1, 0)))
        sums.append((table[size:, size:] - table[:-size, size:] - table[size:, :-size] + table[:-size, :-size]))
    deviation = np.sqrt(np.maximum(sums[1] - sums[0]**2 / size**2, 1e-6))
    ncc = correlation / (deviation * np.sqrt((template**2).sum()))
    row, col = np.unravel_index(ncc.argmax(), ncc.shape)
    return col - (count - 1) // 2, row - (count - 1) // 2, float(ncc.max())


def correct_truth(folder, taken_path, reference_path):
    """Returns the shifts in metres, one a frame that was moved."""
    taken, reference = (gdal.Open(str(path)) for path in (taken_path, reference_path))
    place = taken.GetGeoTransform()
    if place != reference.GetGeoTransform() or taken.RasterXSize != reference.RasterXSize:
        raise SystemExit(f"{taken_path} and {reference_path} have different pixel grids")
    geodetic = osr.SpatialReference()
    geodetic.ImportFromEPSG(4326)
    geodetic.SetAxisMappingStrategy(osr.OAMS_TRADITIONAL_GIS_ORDER)
    to_map = osr.CoordinateTransformation(geodetic, taken.GetSpatialRef())
    to_geodetic = osr.CoordinateTransformation(taken.GetSpatialRef(), geodetic)
    images = [gray_of(taken), gray_of(reference)]
    with open(folder / "frames.csv", newline="") as stream:
        rows = list(csv.DictReader(stream))
    places, found = [], []
    for row in rows:
        x, y, _ = to_map.TransformPoint(float(row["true_lon_deg"]), float(row["true_lat_deg"]))
        places.append((x, y))
        col, line = (int(n) for n in gdal.ApplyGeoTransform(gdal.InvGeoTransform(place), x, y))
        reach = HALF_PX + REACH_PX
        if min(col, line) < reach or col + reach > taken.RasterXSize or line + reach > taken.RasterYSize:
            continue
        template = images[0][line - HALF_PX:line + HALF_PX, col - HALF_PX:col + HALF_PX]
        window = images[1][line - reach:line + reach, col - reach:col + reach]
        cols, lines, ncc = find(template, window)
        if ncc >= MIN_NCC and max(abs(cols), abs(lines)) < REACH_PX:
            found.append((x, y, cols * place[1], lines * place[5]))
    found = np.array(found)
    shifts_m = []
    for row, (x, y) in zip(rows, places):
        distances_m = np.hypot(found[:, 0] - x, found[:, 1] - y)
        nearest = np.argsort(distances_m, kind="stable")[:NEIGHBOURS]
        if len(nearest) < NEIGHBOURS or distances_m[nearest[-1]] > NEAR_M:
            continue
        east, north = np.median(found[nearest, 2]), np.median(found[nearest, 3])
        shifts_m.append(math.hypot(east, north))
        for name in ("true", "true_nadir"):
            x, y, _ = to_map.TransformPoint(float(row[name + "_lon_deg"]), float(row[name + "_lat_deg"]))
            lon_deg, lat_deg, _ = to_geodetic.TransformPoint(x + east, y + north)
            row[name + "_lon_deg"], row[name + "_lat_deg"] = repr(lon_deg), repr(lat_deg)
    with open(folder / "frames.csv", "w", newline="") as stream:
        writer = csv.DictWriter(stream, rows[0].keys(), lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)
    print(f"{len(shifts_m)} of {len(rows)} true places moved, median {np.quantile(shifts_m, 0.5):.2f} m, 95 % "
          f"{np.quantile(shifts_m, 0.95):.2f} m, largest {max(shifts_m):.2f} m", flush=True)
    return shifts_m


if __name__ == "__main__":
    correct_truth(pathlib.Path(sys.argv[1]), sys.argv[2], sys.argv[3])
