"""Real imagery: score runs or says why not, its V and H agree with numpy, and prepare flies over it.

real_imagery.py PILOTAGE SOURCE_FOLDER"""

import csv
import json
import math
import random
import sys

from acceptance import check, main, need_gdal, real_data, run

gdal = need_gdal()
import numpy as np  # noqa: E402
from osgeo import osr  # noqa: E402

TILE_PX = 48
SAMPLED = 20
RELATIVE = 1e-9


def gray_of(dataset):
    """Gray values (float64) and validity of a raster, from its bands' colours, masks and alpha; written for this test.

    Complex values count by magnitude. BT.601 luma in OpenCV's fixed point: (9798 R + 19235 G + 3735 B + 2^14) / 2^15 rounded down, for unsigned 8 and 16 bits;
    without rounding for all other types."""
    colours = {}
    masks = []
    plain = []
    for i in range(1, dataset.RasterCount + 1):
        band = dataset.GetRasterBand(i)
        colour = band.GetColorInterpretation()
        if colour == gdal.GCI_AlphaBand:
            masks.append(band.ReadAsArray() > 0)
            continue
        colours[colour] = i
        plain.append(i)
    wanted = [colours.get(c) for c in (gdal.GCI_RedBand, gdal.GCI_GreenBand, gdal.GCI_BlueBand)]
    if None in wanted:
        wanted = plain[:3] if len(plain) >= 3 else plain[:1]
    values = []
    for i in wanted:
        band = dataset.GetRasterBand(i)
        array = band.ReadAsArray()
        masks.append(band.GetMaskBand().ReadAsArray() > 0)
        if array.dtype.kind == "c":
            array = np.abs(array.astype(np.complex128))
        if array.dtype.kind == "f":
            masks.append(np.isfinite(array))
        values.append(array)
    valid = np.logical_and.reduce(masks)
    if len(values) == 1:
        gray = values[0].astype(np.float64)
    elif values[0].dtype in (np.uint8, np.uint16):
        red, green, blue = (array.astype(np.int64) for array in values)
        gray = ((red * 9798 + green * 19235 + blue * 3735 + (1 << 14)) >> 15).astype(np.float64)
    else:
        red, green, blue = (array.astype(np.float64) for array in values)
        gray = 0.299 * red + 0.587 * green + 0.114 * blue
    return gray, valid


def variance(gray):
    """Eq. 1: sqrt(sum of squared differences from the mean / (N - 1))."""
    return math.sqrt(np.sum((gray - gray.mean())**2) / (gray.size - 1))


def frieden_entropy(gray):
    """Eq. 2-3: sum of p exp(1 - p) with p the pixel's share of all light."""
    share = gray / gray.sum()
    return float(np.sum(share * np.exp(1 - share)))


def close(ours, theirs):
    return abs(ours - theirs) <= RELATIVE * max(abs(theirs), 1e-300) or ours == theirs


def compare(path, table, seed):
    gray, valid = gray_of(gdal.Open(str(path)))
    with open(table, newline="") as stream:
        rows = [row for row in csv.DictReader(stream) if row["status"] == "scored"]
    chosen = random.Random(seed).sample(rows, min(SAMPLED, len(rows)))
    for row in chosen:
        col, line = int(row["min_col_px"]), int(row["min_row_px"])
        window = np.s_[line:line + TILE_PX, col:col + TILE_PX]
        inside = gray[window][valid[window]]
        check(abs(float(row["valid_fraction"]) - valid[window].mean()) < 1e-12,
              f"{path.name} tile {row['tile_id']}: valid fraction {row['valid_fraction']}, {valid[window].mean()}")
        for name, theirs in (("gray_variance", variance(inside)), ("frieden_entropy", frieden_entropy(inside))):
            if name == "frieden_entropy" and (inside.min() < 0 or inside.sum() == 0):
                check(row[name] == "", f"{path.name} tile {row['tile_id']}: {name} of negative or no light")
                continue
            check(row[name] != "" and close(float(row[name]), theirs),
                  f"{path.name} tile {row['tile_id']}: {name} = {row[name]}, numpy says {theirs!r}")
    return f"{len(chosen)} of {len(rows)} scored tiles agree with numpy to {RELATIVE}"


def score_all(pilotage, data, work):
    rasters = [data / "port/port_2019-08.tif", data / "autzen/autzen.tif", data / "zanzibar/zanzibar_z20.tif"]
    must_run = set(rasters)
    rasters += sorted((data / "odd").glob("*.tif"))
    for index, path in enumerate(rasters):
        table = work / f"{index}.csv"
        code, told = run(pilotage, "score", path, "--tile-size-px", TILE_PX, "--stride-px", 61, "--search-radius-px", 4,
                         "--measures", "gray_variance,frieden_entropy", "--table", table, "-o", work / f"{index}.tif",
                         expect=None)
        if code == 0:
            print(f"{path.name}: {compare(path, table, index)}")
            continue
        check(path not in must_run and code == 1 and path.name in told and not table.exists(),
              f"{path.name}: exit {code}: {told}")
        print(f"{path.name}: refused: {told.strip()}")


def plan_over(raster):
    """A QGroundControl plan: a rectangle at the middle half of the raster, 120 m above home."""
    dataset = gdal.Open(str(raster))
    place = dataset.GetGeoTransform()
    geodetic = osr.SpatialReference()
    geodetic.ImportFromEPSG(4326)
    transform = osr.CoordinateTransformation(dataset.GetSpatialRef(), geodetic)

    def position(across, down):
        x, y = gdal.ApplyGeoTransform(place, across * dataset.RasterXSize, down * dataset.RasterYSize)
        lat, lon, _ = transform.TransformPoint(x, y)
        return lat, lon

    corners = [position(*at) for at in ((0.3, 0.3), (0.7, 0.3), (0.7, 0.7), (0.3, 0.7), (0.3, 0.35))]
    items = [{"type": "SimpleItem", "command": 22 if i == 0 else 16, "frame": 3, "autoContinue": True,
              "doJumpId": i + 1, "params": [0, 0, 0, None, lat, lon, 120]} for i, (lat, lon) in enumerate(corners)]
    return {"fileType": "Plan", "version": 1, "groundStation": "QGroundControl",
            "geoFence": {"circles": [], "polygons": [], "version": 2}, "rallyPoints": {"points": [], "version": 2},
            "mission": {"version": 2, "firmwareType": 12, "vehicleType": 1, "cruiseSpeed": 18, "hoverSpeed": 5,
                        "plannedHomePosition": [corners[0][0], corners[0][1], 10], "items": items}}


def prepare_over_port(pilotage, data, source, work):
    raster = data / "port/port_2019-08.tif"
    (work / "route.plan").write_text(json.dumps(plan_over(raster)))
    run(pilotage, "prepare", "--imagery", raster, "--route", work / "route.plan", "--agl-m", 120, "--camera-hfov-deg",
        73.7, "--camera-width-px", 4000, "--camera-height-px", 2250, "--ins-grade", "tactical", "--speed-mps", 18,
        "-o", work / "out")
    told = run(pilotage, "verify", work / "out/map.gpkg")
    print(told.strip())
    check("intact" in told, told)
    listing = run("ogrinfo", "-ro", work / "out/map.gpkg")
    check([line.split(": ")[1].split(" (")[0] for line in listing.splitlines() if line[:1].isdigit()] ==
          ["tiles", "route", "legs", "map_info"] and "warning" not in listing.lower(), listing)
    flipped = work / "flipped.gpkg"
    run(sys.executable, source / "tests/data/small_mission/flip_descriptor_byte.py", work / "out/map.gpkg", flipped)
    run(pilotage, "verify", flipped, expect=4)
    told = run(sys.executable, "-m", "osgeo_utils.samples.validate_gpkg", "--extra", work / "out/map.gpkg")
    check("error" not in told.lower(), told)


def test(pilotage, source, work, _):
    data = real_data(source)
    score_all(pilotage, data, work)
    prepare_over_port(pilotage, data, source, work)


main(test)
