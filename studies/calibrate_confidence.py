"""How much evidence frames find where they show other ground: what the constants of match_confidence.cc rest on.

calibrate_confidence.py PILOTAGE CUT_FLIGHT_FRAMES --work DIR [--frames 60] [--footprint-m 154,80,260]
                        [--features-per-mpx 20000] [--no-chips | --only-chips]
                        [--seed 5] [--threads 2]

Not a test: it measures, and prints tables as Markdown. PILOTAGE_DATA names the folder of real imagery. Port and Moscow
take no part: they evaluate what is calibrated here.

Each picture of PLACES becomes a raster of PIXEL_M in EPSG:32633, all with one top left corner, as if it showed so much
smaller ground: what matters is how real ground looks in pixels. Of the first date a map of the whole raster is built,
with chips; of the second date frames are cut (any heading, tilt to 5 degrees, told with an error of 1 degree and 3 %,
priors off by up to 60 m on each axis, sigma 30 m). Then the frames are matched

  other   against the maps of three other places, with the priors of frames of those places;
  beyond  against their own map, with the prior of another frame of that map, more than BEYOND_M from the truth along an
          axis and so beyond the window of some 95 m: ground resembles itself more than that of another country;
  right   against their own map with their own priors. Only places of two dates: the same picture would be easy.

With chips and without. A right place lies within 5 m of the truth. Frames whose window holds no map are left out.
DIR/rows.json keeps the numbers of every frame."""

import argparse
import csv
import json
import math
import os
import pathlib
import sys

import numpy as np

sys.path.append(str(pathlib.Path(__file__).resolve().parents[1] / "tests/accept"))  # helpers shared with the tests
from acceptance import SKIP, Failed, check, need_gdal, run  # noqa: E402
from match_flights import cut, whole_map  # noqa: E402

# Of the Sentinel-2 places those from which the descriptor was not learned (learn_ground_pattern.py).
TWO_DATES = ("beihai", "cupertino", "hongkong", "mumbai", "pisa", "saclay_e")
PLACES = TWO_DATES + ("autzen", "zanzibar")
ONE_DATE = {"autzen": ("autzen/autzen.jpg", 0.508), "zanzibar": ("zanzibar/zanzibar_z20.tif", 0.247)}  # file, scale
PIXEL_M = 0.6
CORNER = (500000, 5000000)
BEYOND_M = 150
CORRECT_M = 5
RATES = (0.1, 0.01, 0.001, 0.0001)
HIGH = (50, 90, 95, 99, 99.5, 99.9, 100)
LOW = (0.1, 1, 5, 10, 50)
EXPECTED_BINS = (0, 10, 20, 30, 50, 100, 200, 400, 600, 900, 1500, 2500, 100000)
NUMBERS = ("support", "expected_features", "ncc", "chip_pixels", "vote_peak", "candidate_center_error_m")


def make_raster(gdal, data, place, date, path):
    name, scale = ONE_DATE.get(place, (f"twodate/sentinel2/{place}_{date}.png", 1))
    picture = gdal.Open(str(data / name))
    width, height = (int(size * scale) for size in (picture.RasterXSize, picture.RasterYSize))
    x, y = CORNER
    gdal.Translate(str(path), picture, width=width, height=height, resampleAlg="average", outputSRS="EPSG:32633",
                   bandList=[1, 2, 3] if picture.RasterCount >= 3 else None,
                   outputBounds=[x, y, x + PIXEL_M * width, y - PIXEL_M * height])
    return path


def read_rows(path):
    with open(path, newline="") as stream:
        return list(csv.DictReader(stream))


def with_priors(rows, claims):
    """The rows with the prior positions of other ones."""
    names = ("prior_lon_deg", "prior_lat_deg", "prior_sigma_m")
    return [row | {name: claim[name] for name in names} for row, claim in zip(rows, claims)]


def claims_beyond(rows, start):
    """For each row the first one, from `start` rows further, whose prior is far enough from the row's truth."""
    def distance_m(row, claim):
        lat_deg = float(row["true_nadir_lat_deg"])
        east = (float(claim["prior_lon_deg"]) - float(row["true_nadir_lon_deg"])) * math.cos(math.radians(lat_deg))
        return max(abs(east), abs(float(claim["prior_lat_deg"]) - lat_deg)) * 111200

    pairs = []
    for i, row in enumerate(rows):
        others = [rows[(i + start + k) % len(rows)] for k in range(len(rows))]
        far = next((claim for claim in others if distance_m(row, claim) > BEYOND_M), None)
        if far:
            pairs.append((row, far))
    return with_priors(*zip(*pairs)) if pairs else []


def match_rows(pilotage, map_path, folder, rows, threads, chips):
    """What fixes.csv says of the rows whose window held map: status and numbers."""
    table, fixes = folder / "claimed.csv", folder / "fixes.csv"
    with open(table, "w", newline="") as stream:
        writer = csv.DictWriter(stream, rows[0].keys(), lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)
    run(pilotage, "match", map_path, "--frames", table, "--camera", folder / "camera.yaml", "--allow-other-camera",
        "-o", fixes, "--overwrite", "-q", "--no-timings", "--threads", threads, "--correct-within-m", CORRECT_M,
        *([] if chips else ["--no-chips"]))
    return [{"fix": row["status"] == "fix", **{name: float(row[name] or "nan") for name in NUMBERS}}
            for row in read_rows(fixes) if float(row["expected_features"]) > 0]


def measure(pilotage, tool, rasters, footprint_m, options):
    """Lists of rows by (what, chips), what being "other", "beyond" or "right"."""
    frames, threads, work = options.frames, options.threads, options.work
    maps, folders, rows = {}, {}, {}
    for place in PLACES:
        try:
            folder = cut(tool, rasters[place][1], work / f"{place}_{footprint_m:g}", frames=frames, seed=options.seed,
                         footprint_m=footprint_m)
        except Failed as failure:
            print(f"{footprint_m:g} m: {place} left out: {str(failure).strip().splitlines()[-1]}\n")
            continue
        maps[place] = whole_map(pilotage, rasters[place][0], work / f"{place}_{footprint_m:g}.gpkg", footprint_m,
                                PIXEL_M, ("--chips", "--features-per-mpx", options.features_per_mpx))
        folders[place], rows[place] = folder, read_rows(folder / "frames.csv")
    found = {(what, chips): [] for what in ("other", "beyond", "right") for chips in options.chips}
    names = list(maps)
    check(len(names) > 3, f"{footprint_m:g} m: fewer than four places have room for frames")
    for i, place in enumerate(names):
        own = rows[place]
        jobs = [("beyond", place, claims_beyond(own, start)) for start in (1, frames // 2)]
        jobs += [("right", place, own)] if place in TWO_DATES else []
        for third in range(3):
            other = names[(i + 1 + third * len(names) // 3) % len(names)]
            jobs.append(("other", other, with_priors(rows[other], own)))
        for what, whose, claimed in jobs:
            for chips in options.chips:
                if claimed:
                    found[what, chips] += match_rows(pilotage, maps[place], folders[whose], claimed, threads, chips)
    return found


def binomial_tail(count, of, share):
    """Probability of `count` or more of `of`."""
    if share <= 0 or share >= 1:
        return float(count <= 0 or share >= 1)
    k = np.arange(count, of + 1)
    logs = [math.lgamma(of + 1) - math.lgamma(n + 1) - math.lgamma(of - n + 1) for n in k]
    return float(np.exp(np.array(logs) + k * math.log(share) + (of - k) * math.log1p(-share)).sum())


def interval(count, of):
    """95 %, by C. Clopper and E. Pearson (Biometrika, 1934)."""
    def solve(count, probability):
        low, high = 0.0, 1.0
        for _ in range(60):
            middle = (low + high) / 2
            low, high = (middle, high) if binomial_tail(count, of, middle) < probability else (low, middle)
        return low
    return (solve(count, 0.025) if count > 0 else 0.0), (solve(count + 1, 0.975) if count < of else 1.0)


def share(count, of):
    if of == 0:
        return "–"
    low, high = interval(count, of)
    return f"{count} of {of}: {100 * count / of:.2f} % ({100 * low:.2f} … {100 * high:.2f})"


def print_table(heads, lines):
    print("| " + " | ".join(heads) + " |\n|---|" + "---:|" * (len(heads) - 1))
    for line in lines:
        print("| " + " | ".join(line) + " |")
    print(flush=True)


def column(rows, name):
    return np.array([row[name] for row in rows], dtype=float)


def quantile_line(label, values, percents):
    """High ones are followed by the exponential tail through 90 and 99 %: rate exp(-(value - onset)/scale)."""
    line = [label, str(len(values))] + [f"{value:.1f}" for value in np.percentile(values, percents)]
    if percents == HIGH:
        q90, q99 = np.percentile(values, (90, 99))
        scale = (q99 - q90) / math.log(10)
        line += [f"{q90 - scale * math.log(10):.1f}", f"{scale:.2f}"]
    return line


def percent_heads(first, percents):
    return [first, "frames"] + ["max" if percent == 100 else f"{percent:g} %" for percent in percents] + \
        (["onset", "scale"] if percents == HIGH else [])


def correlation(rows):
    pixels = column(rows, "chip_pixels")
    return (column(rows, "ncc") * np.sqrt(pixels))[pixels > 0]


def quantile_lines(label, rows, percents):
    lines = []
    for name, values in (("support", column(rows, "support")), ("ncc·√pixels", correlation(rows)),
                         ("evidence", column(rows, "vote_peak"))):
        if len(values) > 0:
            lines.append(quantile_line(f"{label}: {name}", values, percents))
    return lines


def split_right(rows):
    error_m = column(rows, "candidate_center_error_m")
    at_truth = error_m <= CORRECT_M
    return [row for row, right in zip(rows, at_truth) if right], [row for row, right in zip(rows, at_truth) if not right]


def tell(title, found):
    """Everything about one footprint, or all pooled."""
    print(f"### {title}\n")
    for chips in sorted({chips for _, chips in found}, reverse=True):
        label = "with chips" if chips else "without chips"
        wrong = {what: found[what, chips] for what in ("other", "beyond")}
        right, false = split_right(found["right", chips])
        print(f"Accepted at a false fix rate of 0.001, and frames whose evidence claims a rate of at most r, {label}:\n")
        lines = []
        for what, rows in wrong.items():
            evidence = column(rows, "vote_peak")
            reached = [f"{100 * np.mean(evidence >= -math.log(rate)):.3f} %" for rate in RATES]
            lines.append([what, share(sum(row["fix"] for row in rows), len(rows)), *reached])
        print_table(["ground", "accepted"] + [f"r = {rate:g}" for rate in RATES], lines)
        count = len(right) + len(false)
        print_table(["right priors, " + label, "share"],
                    [["best place is right", share(len(right), count)],
                     ["accepted and correct", share(sum(row["fix"] for row in right), count)],
                     ["accepted and false", share(sum(row["fix"] for row in false), count)]])
        lines = [line for what, rows in wrong.items() for line in quantile_lines(what, rows, HIGH)]
        lines += quantile_lines("right priors, wrong place", false, HIGH) if false else []
        print_table(percent_heads(f"wrong places, {label}", HIGH), lines)
        if right:
            print_table(percent_heads(f"right places, {label}", LOW), quantile_lines("right", right, LOW))
        lines = []
        for what, rows in wrong.items():
            expected, support = column(rows, "expected_features"), column(rows, "support")
            for low, high in zip(EXPECTED_BINS, EXPECTED_BINS[1:]):
                inside = (expected >= low) & (expected < high)
                if inside.sum() >= 40:
                    lines.append(quantile_line(f"{what}: {low} … {high - 1}, mean {expected[inside].mean():.0f}",
                                               support[inside], HIGH))
        print_table(percent_heads(f"support by expected features, {label}", HIGH), lines)


def command_line():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("pilotage", type=pathlib.Path)
    parser.add_argument("cut_flight_frames", type=pathlib.Path)
    parser.add_argument("--work", type=pathlib.Path, required=True, help="rasters, maps and frames; some 300 MB")
    parser.add_argument("--frames", type=int, default=60, help="of each place and footprint")
    parser.add_argument("--footprint-m", default="154,80,260", help="widths, joined by commas")
    parser.add_argument("--features-per-mpx", type=float, default=20000, help="of the maps")
    parser.add_argument("--no-chips", dest="chips", action="store_const", const=(False,), default=(True, False),
                        help="features alone, not with chips as well")
    parser.add_argument("--only-chips", dest="chips", action="store_const", const=(True,), help="nor features alone")
    parser.add_argument("--seed", type=int, default=5, help="of the frames")
    parser.add_argument("--threads", type=int, default=2)
    options = parser.parse_args()
    data = pathlib.Path(os.environ.get("PILOTAGE_DATA", ""))
    if not (data / "twodate").is_dir():
        print("skipped: no real imagery (PILOTAGE_DATA)")
        raise SystemExit(SKIP)
    gdal = need_gdal()
    options.work.mkdir(parents=True, exist_ok=True)
    rasters = {place: [make_raster(gdal, data, place, date, options.work / f"{place}_{date}.tif") for date in (1, 2)]
               for place in PLACES}
    pooled = {}
    try:
        for footprint_m in (float(width) for width in options.footprint_m.split(",")):
            found = measure(options.pilotage.absolute(), options.cut_flight_frames.absolute(), rasters, footprint_m,
                            options)
            tell(f"{footprint_m:g} m wide", found)
            for key, rows in found.items():
                pooled.setdefault(key, []).extend(rows)
    except Failed as failure:
        raise SystemExit(str(failure)) from None
    tell("All widths", pooled)
    (options.work / "rows.json").write_text(json.dumps([[*key, rows] for key, rows in pooled.items()]))


if __name__ == "__main__":
    command_line()
