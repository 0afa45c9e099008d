"""Learns the binary tests of the descriptor "ground" from pictures of ground at two dates, and writes them as source.

learn_ground_pattern.py [-o ground_pattern_tests.cc] [--reach-px 15] [--bits 256] [--seed 1] [--evaluate]

PILOTAGE_DATA names the folder of real imagery. The places of LEARN teach and take no part in anything else: neither in
the calibration of confidence nor in the model of P. The port evaluates (--evaluate prints the table of
docs/methods/ground-pattern.md, beside cv::ORB's pattern). Wants Debian's python3-opencv. One run takes two minutes and
gives the same bytes on the same machine.

A test compares the sums of 3 x 3 pixels at two points of the patch. CANDIDATES tests are drawn, and for corners (FAST,
spread as the maps' are) it is seen how often a test disagrees

  right  between the first date and the second one at the same place, turned by sigma 1.5 degrees, scaled by sigma 3 %
         and moved by up to 1 px along each axis: what is left of attitude, height and grid when a frame is matched;
  wrong  between the first date and the second one at another corner of the same picture, at least 16 px away.

Then tests are taken one after the other, each time the one that most raises the discriminability of the SUM of
disagreements, (mean wrong - mean right) / sqrt(0.35 variance right + 0.65 variance wrong). Covariances of the chosen
tests are carried along, so that a test which repeats what others say gains little. The first 64 and 128 of the tests
are the shorter descriptors."""

import argparse
import os
import pathlib

import numpy as np

try:
    import cv2
except ImportError:  # it is no package of the tests
    cv2 = None

LEARN = ("abudhabi", "bercy", "bordeaux", "chongqing", "milano", "norcia")
CANDIDATES = 8000
PAIRS_PER_PLACE = 2500
BOX_RADIUS_PX = 1
YAW_SIGMA_DEG, SCALE_SIGMA, SHIFT_PX = 1.5, 0.03, 1.0
WEIGHT_RIGHT = 0.35
FLOW_STEP_PX, FLOW_HALF_PX, FLOW_REACH_PX = 32, 48, 10
LEAST_NCC, MOST_SHIFT_PX = 0.35, 6
APART_PX = 16
MARGIN_PX = 30
PORT_GSDS_M = (0.45, 0.6, 0.9)
WRONG_DRAWS = 30
HEAD = """// Made by studies/learn_ground_pattern.py; not to be edited.

#include "pilotage/vision/ground_pattern.h"

namespace pilotage {{

const std::array<BriefPair, kGroundPatternTests> kGroundPattern{{{{
"""


def stretched(gray):
    low, high = np.percentile(gray, (0.5, 99.5))
    return np.clip((gray - low) * 255.0 / max(1.0, high - low), 0, 255).astype(np.uint8)


def corners(gray):
    """Some 20,000 corners for each million pixels, spread over cells of 20 px: FAST 20, or 5 where those are few."""
    cell, each = 20, 8
    height, width = gray.shape

    def by_cell(threshold):
        cells = {}
        for point in cv2.FastFeatureDetector_create(threshold).detect(gray):
            x, y = int(point.pt[0]), int(point.pt[1])
            if MARGIN_PX <= x < width - MARGIN_PX and MARGIN_PX <= y < height - MARGIN_PX:
                cells.setdefault((y // cell, x // cell), []).append((-point.response, y, x))
        return cells

    strong, faint = by_cell(20), by_cell(5)
    found = []
    for key in sorted(faint):
        here = strong.get(key, [])
        found += sorted(here if len(here) >= each else faint[key])[:each]
    return np.array([(x, y) for _, y, x in found], float).reshape(-1, 2)


def displacement(first, second):
    """Where squares of 96 px of the first date lie in the second, medians of 5 x 5 of them, and their correlation."""
    height, width = first.shape
    border = FLOW_HALF_PX + FLOW_REACH_PX
    ys, xs = (np.arange(border, size - border, FLOW_STEP_PX) for size in (height, width))
    moved, ncc = np.zeros((len(ys), len(xs), 2)), np.zeros((len(ys), len(xs)))
    for i, y in enumerate(ys):
        for j, x in enumerate(xs):
            square = first[y - FLOW_HALF_PX:y + FLOW_HALF_PX, x - FLOW_HALF_PX:x + FLOW_HALF_PX]
            around = second[y - border:y + border, x - border:x + border]
            _, ncc[i, j], _, at = cv2.minMaxLoc(cv2.matchTemplate(around, square, cv2.TM_CCOEFF_NORMED))
            moved[i, j] = np.array(at) - FLOW_REACH_PX
    smooth = np.array([[np.median(moved[max(0, i - 2):i + 3, max(0, j - 2):j + 3].reshape(-1, 2), axis=0)
                        for j in range(len(xs))] for i in range(len(ys))])
    return ys, xs, smooth, ncc


class Pair:
    """Two dates of a place: corners of the first, and where they lie in the second."""

    def __init__(self, first, second, random, most):
        self.gray = [stretched(first), stretched(second)]
        side = 2 * BOX_RADIUS_PX + 1
        self.boxes = [cv2.blur(gray.astype(np.float32), (side, side)) for gray in self.gray]
        ys, xs, moved, ncc = displacement(*self.gray)
        points = corners(self.gray[0])
        random.shuffle(points)
        points = points[:most]
        row = np.clip(np.round((points[:, 1] - ys[0]) / FLOW_STEP_PX).astype(int), 0, len(ys) - 1)
        col = np.clip(np.round((points[:, 0] - xs[0]) / FLOW_STEP_PX).astype(int), 0, len(xs) - 1)
        known = (ncc[row, col] > LEAST_NCC) & (np.abs(moved[row, col]).max(1) <= MOST_SHIFT_PX)
        self.points, self.moved = points[known], moved[row, col][known]

    def bits(self, date, at, turn, tests):
        """Answers (points x tests) of tests turned by matrices (a, b, c, d) at points."""
        answers = np.empty((len(at), len(tests)), np.uint8)
        for begin in range(0, len(at), 2000):
            part = slice(begin, begin + 2000)
            a, b, c, d = (turn[part, k:k + 1] for k in range(4))

            def values(x, y):
                cols = (at[part, 0:1] + a * x + b * y).astype(np.float32)
                rows = (at[part, 1:2] + c * x + d * y).astype(np.float32)
                return cv2.remap(self.boxes[date], cols, rows, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REFLECT_101)

            answers[part] = values(tests[:, 0], tests[:, 1]) < values(tests[:, 2], tests[:, 3])
        return answers


def upright(count):
    return np.tile([1.0, 0.0, 0.0, 1.0], (count, 1))


def disturbed(random, count):
    turn = np.radians(YAW_SIGMA_DEG) * random.standard_normal(count)
    scale = 1 + SCALE_SIGMA * random.standard_normal(count)
    matrices = np.stack([scale * np.cos(turn), -scale * np.sin(turn), scale * np.sin(turn), scale * np.cos(turn)], 1)
    return matrices, random.uniform(-SHIFT_PX, SHIFT_PX, (count, 2))


def others(random, points):
    """For each point the index of another one that is not near."""
    other = random.permutation(len(points))
    for _ in range(5):
        near = np.hypot(*(points[other] - points).T) < APART_PX
        other[near] = random.integers(0, len(points), near.sum())
    return other


def disagreements(random, pair, tests):
    """Of right and of wrong pairs: rows of zeros and ones."""
    count = len(pair.points)
    reference = pair.bits(0, pair.points, upright(count), tests)
    turn, shift = disturbed(random, count)
    right = reference ^ pair.bits(1, pair.points + pair.moved + shift, turn, tests)
    other = others(random, pair.points)
    turn, shift = disturbed(random, count)
    shift += random.integers(-6, 7, (count, 2))
    wrong = reference ^ pair.bits(1, pair.points[other] + pair.moved[other] + shift, turn, tests)
    return right, wrong


def draw_candidates(random, reach_px):
    limit = reach_px - BOX_RADIUS_PX
    tests = np.empty((0, 4), int)
    while len(tests) < CANDIDATES:
        drawn = random.integers(-limit, limit + 1, (CANDIDATES, 4))
        apart = np.hypot(drawn[:, 0] - drawn[:, 2], drawn[:, 1] - drawn[:, 3]) >= 2 * BOX_RADIUS_PX
        tests = np.unique(np.concatenate([tests, drawn[apart]]), axis=0)
    return random.permutation(tests)[:CANDIDATES]


def choose(right, wrong, bits):
    """Indices of the tests in the order in which they are taken."""
    right, wrong = right.astype(np.float32), wrong.astype(np.float32)
    mean_right, mean_wrong = right.mean(0), wrong.mean(0)
    right -= mean_right
    wrong -= mean_wrong
    weights = (WEIGHT_RIGHT, 1 - WEIGHT_RIGHT)
    variances = [mean * (1 - mean) for mean in (mean_right, mean_wrong)]
    covariances = [np.zeros(right.shape[1], np.float32) for _ in range(2)]
    lead, spread = 0.0, [0.0, 0.0]
    free, chosen = np.ones(right.shape[1], bool), []
    for _ in range(bits):
        pooled = sum(w * (s + 2 * c + v) for w, s, c, v in zip(weights, spread, covariances, variances))
        score = np.where(free, (lead + mean_wrong - mean_right) / np.sqrt(np.maximum(pooled, 1e-9)), -np.inf)
        best = int(np.argmax(score))
        chosen.append(best)
        free[best] = False
        lead += mean_wrong[best] - mean_right[best]
        for k, rows in enumerate((right, wrong)):
            spread[k] += 2 * covariances[k][best] + variances[k][best]
            covariances[k] += rows.T @ rows[:, best] / len(rows)
    return chosen


def read_pair(data, place, random):
    first, second = (cv2.imread(str(data / f"twodate/sentinel2/{place}_{date}.png"), cv2.IMREAD_GRAYSCALE)
                     for date in (1, 2))
    return Pair(first, second, random, PAIRS_PER_PLACE)


def learn(data, reach_px, bits, seed):
    random = np.random.default_rng(seed)
    tests = draw_candidates(random, reach_px)
    found = []
    for place in LEARN:
        pair = read_pair(data, place, random)
        found.append(disagreements(random, pair, tests))
        print(f"{place}: {len(pair.points)} pairs", flush=True)
    return tests[choose(*(np.concatenate(rows) for rows in zip(*found)), bits)]


def write_source(path, tests):
    lines = [f"    {{{x1}, {y1}, {x2}, {y2}}},\n" for x1, y1, x2, y2 in tests]
    path.write_text(HEAD.format() + "".join(lines) + "}};\n\n}  // namespace pilotage\n")


def orb_bits(gray, points):
    """cv::ORB's 256 tests, upright."""
    orb = cv2.ORB_create(nfeatures=len(points), nlevels=1, edgeThreshold=1)
    keys = [cv2.KeyPoint(float(round(x)), float(round(y)), 31, 0.0, 0, 0, i) for i, (x, y) in enumerate(points)]
    keys, rows = orb.compute(gray, keys)
    bits = np.zeros((len(points), 256), np.uint8)
    bits[[key.class_id for key in keys]] = np.unpackbits(rows, axis=1)
    return bits


def tell(name, gsd_m, points, reference, second, random):
    """Shares of right pairs at the distance that 1 of 1,000 and 1 of 100 wrong pairs come up to."""
    right = (reference ^ second).sum(1)
    wrong = []
    for _ in range(WRONG_DRAWS):
        other = random.permutation(len(points))
        far = np.hypot(*(points[other] - points).T) > APART_PX
        wrong.append((reference ^ second[other]).sum(1)[far])
    wrong = np.sort(np.concatenate(wrong))
    shares = [float((right < wrong[int(rate * len(wrong))]).mean()) for rate in (1e-3, 1e-2)]
    print(f"| {name} | {gsd_m:g} m | {len(points)} | {shares[0]:.2f} | {shares[1]:.2f} | "
          f"{wrong.mean():.0f} ± {wrong.std():.1f} | {np.mean(right):.0f} ± {np.std(right):.1f} |", flush=True)


def evaluate(data, tests, seed):
    from osgeo import gdal
    random = np.random.default_rng(seed + 1)
    print("| descriptor | GSD | corners | right at 1 wrong of 1,000 | at 1 of 100 | bits of wrong pairs | of right ones |")
    print("|---|---|---:|---:|---:|---:|---:|")
    for gsd_m in PORT_GSDS_M:
        pictures = []
        for name in ("port_2019-08", "port_2020-07_registered"):
            source = gdal.Open(str(data / f"port/{name}.tif"))
            small = gdal.Translate("", source, format="MEM", bandList=[1, 2, 3], resampleAlg="average",
                                   xRes=gsd_m, yRes=gsd_m).ReadAsArray()
            pictures.append(cv2.cvtColor(np.ascontiguousarray(small.transpose(1, 2, 0)), cv2.COLOR_RGB2GRAY))
        pair = Pair(*pictures, random, 4000)
        turn, shift = disturbed(random, len(pair.points))
        at = pair.points + pair.moved + shift
        tell("ORB's 256", gsd_m, pair.points, orb_bits(pair.gray[0], pair.points), orb_bits(pair.gray[1], at), random)
        for bits in (64, 128, 256, 512):
            if bits <= len(tests):
                some = tests[:bits]
                tell(f"ground {bits}", gsd_m, pair.points, pair.bits(0, pair.points, upright(len(at)), some),
                     pair.bits(1, at, turn, some), random)


def command_line():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("-o", "--output", type=pathlib.Path, default="ground_pattern_tests.cc")
    parser.add_argument("--reach-px", type=int, default=15, help="of a patch, from its middle, box included")
    parser.add_argument("--bits", type=int, default=256)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--evaluate", action="store_true", help="hold the tests against the port")
    options = parser.parse_args()
    data = pathlib.Path(os.environ.get("PILOTAGE_DATA", ""))
    if not (data / "twodate").is_dir():
        print("skipped: no real imagery (PILOTAGE_DATA)")
        raise SystemExit(77)
    if cv2 is None:
        raise SystemExit("learn_ground_pattern.py wants OpenCV for Python: apt-get install python3-opencv")
    tests = learn(data, options.reach_px, options.bits, options.seed)
    write_source(options.output, tests)
    if options.evaluate:
        evaluate(data, tests, options.seed)


if __name__ == "__main__":
    command_line()
