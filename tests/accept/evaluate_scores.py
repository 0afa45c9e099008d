"""score --evaluate on the sample mission's two dates, or on those of the real port: the numbers are recomputed from
evaluation.csv by other means, and what is found is what must be.

evaluate_scores.py PILOTAGE SOURCE_FOLDER sample|port"""

import csv
import json

from acceptance import check, main, real_data, run

PAPER = ["gray_variance", "frieden_deficit", "clean_peak_margin", "degraded_peak_margin"]


def auc_over_pairs(rows, column):
    """Mann and Whitney by counting every pair."""
    judged = [(float(row[column]), row["outcome"] == "correct") for row in rows
              if row["outcome"] != "not_covered" and row[column]]
    right = [value for value, correct in judged if correct]
    wrong = [value for value, correct in judged if not correct]
    if not right or not wrong:
        return None
    won = sum(1.0 if a > b else 0.5 if a == b else 0.0 for a in right for b in wrong)
    return won / len(right) / len(wrong)


def evaluate(pilotage, reference, other, folder, *more):
    folder.mkdir()
    told = run(pilotage, "score", reference, "--evaluate", other, "-o", folder / "scores.tif", *more)
    with open(folder / "evaluation.json", encoding="utf-8") as stream:
        evaluation = json.load(stream)
    with open(folder / "evaluation.csv", newline="", encoding="utf-8") as stream:
        rows = list(csv.DictReader(stream))
    print(*(line for line in told.splitlines() if line.startswith("evaluation:")), sep="\n")
    for outcome, count in evaluation["outcomes"].items():
        check(sum(row["outcome"] == outcome for row in rows) == count, f"{outcome}: {count}")
    check([p["name"] for p in evaluation["predictors"] if not p["probability"]] == PAPER, evaluation["predictors"])
    for predictor in evaluation["predictors"]:
        # With the level of the place known, P is another one in the same order.
        mine, auc = auc_over_pairs(rows, predictor["name"].removesuffix("_at_level")), predictor["auc"]
        check(mine is not None and abs(mine - auc["value"]) < 1e-9, f"{predictor['name']}: {mine}, {auc}")
        check(auc["low"] <= auc["value"] <= auc["high"], f"{predictor['name']}: {auc}")
    check(not list(folder.glob("*.gpkg")) and not list(folder.glob(".*")), "something temporary stays")
    return evaluation, rows


def sample(pilotage, source, work):
    """Two dates of the synthetic country: one georeference, so nearly no fix may be false."""
    mission = source / "maps/sample"
    grid = ["--tile-size-px", "128", "--stride-px", "128", "--search-radius-px", "64"]
    found, rows = evaluate(pilotage, mission / "ortho.tif", mission / "ortho_second_epoch.tif", work / "voting", *grid,
                           "--evaluate-max-tiles", "200")
    check(0.2 < found["correct_fixes"]["rate"] < 0.98, found["correct_fixes"])
    check(found["false_fixes"]["count"] <= 6, found["false_fixes"])  # shadows move: some metres, among trees
    # A lone road lets a fix slide along it, and an orchard by a row.
    check(sum(row["outcome"] == "false" and float(row["error_m"]) > 6 for row in rows) <= 2, rows)
    for row in rows:
        if row["outcome"] == "correct":
            check(row["status"] == "fix" and float(row["error_m"]) <= 3, row)
    ncc, _ = evaluate(pilotage, mission / "ortho.tif", mission / "ortho_second_epoch.tif", work / "ncc", *grid,
                      "--evaluate-matcher", "ncc", "--evaluate-stride", "2")
    check(ncc["outcomes"]["refused"] <= 10, ncc["outcomes"])  # water of one gray value
    check(ncc["correct_fixes"]["rate"] > 0.2, ncc["correct_fixes"])


def port(pilotage, source, work):
    """Ten months apart, 77 m at 0.6 m/px, ± 38 m. The two lie up to 8 m apart, hence the tolerance."""
    data = real_data(source) / "port"
    found, _ = evaluate(pilotage, data / "port_2019-08.tif", data / "port_2020-07_registered.tif", work / "port",
                        "--gsd-m", "0.6", "--tile-size-px", "128", "--stride-px", "38", "--search-radius-px", "64",
                        "--evaluate-tolerance-m", "12")
    check(0.6 < found["correct_fixes"]["rate"] < 0.8, found["correct_fixes"])
    check(found["false_fixes"]["rate"] < 0.01, found["false_fixes"])
    for predictor in found["predictors"]:
        check(predictor["probability"] or 0.35 < predictor["auc"]["value"] < 0.8, predictor["name"])


def test(pilotage, source, work, rest):
    {"sample": sample, "port": port}[rest[0]](pilotage, source, work)


main(test)
