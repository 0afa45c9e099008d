"""Holds P of a fix by landmarks alone, which survey and report show, against frames.

landmark_prospects.py BIN_FOLDER WORK_FOLDER [FRAMES [one-tile]]

Detectors learn on one made-up country; what they are worth, the landmarks of the map and the frames come from others: P(detect)
and what was found from the very second date that the frames show, turned, tilted and in another size. The map has hardly
any features (20 for each million pixels), so that a fix is one by landmarks, which a run without them shows; frames 400 m
wide are looked for within 90 m, three sigma of the prior, as the survey takes it. P of a frame is that of the tile whose
centre is nearest to its place. Frames over ground that the map does not hold (no_map) or farther than 60 m from any tile's
centre are left out and counted. With one-tile the map stores the first tile of the selection alone: what its landmarks are
worth over ground that is not stored. Frames of other ground, of the next country with these priors, are matched, too."""

import csv
import json
import math
import pathlib
import subprocess
import sys

from osgeo import gdal, osr

gdal.UseExceptions()
LEARNT = 7
COUNTRIES = (21, 22, 23)
LANDMARKS = 100  # of each class, so that P of all sizes comes
SIDE_M, AGL_M, SEARCH_M, RIGHT_M = 400, 346.4, 90, 10
EDGES = (0, 0.05, 0.2, 0.5, 0.8, 1.0001)
METRES_PER_DEG = 111_320


def run(*words):
    return subprocess.run([str(word) for word in words], check=True, capture_output=True, text=True).stdout


def country(bin_folder, work, seed):
    folder = work / f"country_{seed}"
    if not (folder / "ortho_second_epoch.tif").exists():
        run(bin_folder / "make_landmark_country", folder, LANDMARKS, seed)
    return folder


def learn(bin_folder, work):
    model = work / "landmarks.json"
    if not model.exists():
        place = country(bin_folder, work, LEARNT)
        run(bin_folder / "pilotage", "landmark-label", place / "ortho.tif", "--labels", place / "landmarks.geojson", "--overwrite",
            "-q", "-o", work / "chips")
        run(bin_folder / "pilotage", "landmark-train", work / "chips", "-q", "-o", model)
    return model


def write_route(raster, path):
    """Lines to and fro over the whole raster."""
    data = gdal.Open(str(raster))
    place, wgs84, grid = data.GetGeoTransform(), osr.SpatialReference(), data.GetSpatialRef()
    wgs84.ImportFromEPSG(4326)
    for crs in (wgs84, grid):
        crs.SetAxisMappingStrategy(osr.OAMS_TRADITIONAL_GIS_ORDER)
    to_wgs84 = osr.CoordinateTransformation(grid, wgs84)
    width_m, height_m = data.RasterXSize * place[1], -data.RasterYSize * place[5]
    points = []
    for number, y_m in enumerate(range(250, int(height_m) - 249, 300)):
        ends = [250, width_m - 250] if number % 2 == 0 else [width_m - 250, 250]
        points += [to_wgs84.TransformPoint(place[0] + x_m, place[3] - y_m)[:2] for x_m in ends]
    line = {"type": "Feature", "properties": {}, "geometry": {"type": "LineString", "coordinates": points}}
    path.write_text(json.dumps({"type": "FeatureCollection", "features": [line]}), encoding="utf-8")


def tiles_of(survey):
    table = json.loads(survey.read_text(encoding="utf-8"))["tiles"]
    at = {name: i for i, name in enumerate(table["columns"])}
    return [(row[at["center_lon_deg"]], row[at["center_lat_deg"]], row[at["p_landmark_fix"]]) for row in table["rows"]]


def distance_m(lon_deg, lat_deg, tile):
    return math.hypot((lon_deg - tile[0]) * math.cos(math.radians(lat_deg)), lat_deg - tile[1]) * METRES_PER_DEG


def keep_one_tile(selection):
    chosen = json.loads(selection.read_text(encoding="utf-8"))
    chosen["tile_ids"] = chosen["tile_ids"][:1]
    selection.write_text(json.dumps(chosen), encoding="utf-8")


def fixes_elsewhere(bin_folder, work, seed):
    """Of frames of the next country with the priors of this one's: how many, and how many give a fix."""
    place, other = work / f"country_{seed}", work / f"country_{COUNTRIES[(COUNTRIES.index(seed) + 1) % len(COUNTRIES)]}"
    if not (other / "frames/frames.csv").exists():
        return 0, 0
    with open(place / "frames/frames.csv", newline="", encoding="utf-8") as own, \
            open(other / "frames/frames.csv", newline="", encoding="utf-8") as theirs:
        claims = [{key: prior[key] for key in ("prior_lon_deg", "prior_lat_deg", "prior_sigma_m")} for prior in csv.DictReader(own)]
        rows = [row | claim for row, claim in zip(csv.DictReader(theirs), claims)]
    claimed = other / "frames/claimed.csv"
    with open(claimed, "w", newline="", encoding="utf-8") as stream:
        writer = csv.DictWriter(stream, rows[0].keys(), lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)
    run(bin_folder / "pilotage", "match", place / "few_features.gpkg", "--frames", claimed, "--camera", other / "frames/camera.yaml",
        "--overwrite", "-q", "-o", place / "elsewhere.csv")
    with open(place / "elsewhere.csv", newline="", encoding="utf-8") as fixes:
        statuses = [fix["status"] for fix in csv.DictReader(fixes)]
    return sum(status != "no_map" for status in statuses), statuses.count("fix")


def tried(bin_folder, work, model, seed, frames, one_tile):
    """Of each frame over the map: P, and whether its fix is right; None without one."""
    place, program = country(bin_folder, work, seed), bin_folder / "pilotage"
    of_map, camera = place / "map_landmarks.json", place / "frames/camera.yaml"
    run(program, "landmark-score", model, "--labels", place / "landmarks.geojson", "--second-epoch", place / "ortho_second_epoch.tif",
        "--for-map", of_map, "--overwrite", "-q")
    run(bin_folder / "cut_flight_frames", place / "ortho_second_epoch.tif", "-o", place / "frames", "--footprint-m", SIDE_M,
        "--frames", frames, "--seed", seed, "--overwrite")
    run(program, "survey", place / "ortho.tif", "--camera", camera, "--agl-m", AGL_M, "--search-radius-m", SEARCH_M, "--tile-overlap",
        "0.75", "--landmarks", of_map, "--overwrite", "-q", "-o", place / "survey")
    write_route(place / "ortho.tif", place / "route.geojson")
    mission = place / "mission.json"
    mission.write_text(json.dumps({
        "imagery": ["ortho.tif"], "route": "route.geojson", "camera": {"file": "frames/camera.yaml"}, "ins": {"grade": "tactical"},
        "speed_mps": 18, "max_error_m": 60, "agl_m": AGL_M}), encoding="utf-8")
    made, few = place / "mission", place / "few_features.gpkg"
    run(program, "prepare", mission, "--outputs", "json", "--overwrite", "-q", "-o", made)
    if one_tile:
        keep_one_tile(made / "selection.json")
    run(program, "build", made / "plan.json", "--table", made / "tiles.csv", "--selection", made / "selection.json", "--landmarks", of_map,
        "--features-per-mpx", "20", "--overwrite", "-q", "-o", few)
    run(program, "match", few, "--frames", place / "frames/frames.csv", "--camera", camera, "--no-landmarks", "--overwrite", "-q", "-o",
        place / "without.csv")
    with open(place / "without.csv", newline="", encoding="utf-8") as fixes:
        print("without landmarks:", sum(fix["status"] == "fix" for fix in csv.DictReader(fixes)), "fixes")
    run(program, "match", few, "--frames", place / "frames/frames.csv", "--camera", camera,
        "--overwrite", "-q", "-o", place / "fixes.csv")
    tiles = tiles_of(place / "survey/survey.json")
    with open(place / "frames/frames.csv", newline="", encoding="utf-8") as truths, \
            open(place / "fixes.csv", newline="", encoding="utf-8") as fixes:
        for truth, fix in zip(csv.DictReader(truths), csv.DictReader(fixes)):
            lon_deg, lat_deg = float(truth["true_lon_deg"]), float(truth["true_lat_deg"])
            tile = min(tiles, key=lambda one: distance_m(lon_deg, lat_deg, one))
            if distance_m(lon_deg, lat_deg, tile) > 60 or fix["status"] == "no_map":
                continue
            yield tile[2], fix["status"] == "fix", fix["status"] == "fix" and float(fix["center_error_m"]) <= RIGHT_M


def main(bin_folder, work, frames, one_tile):
    work.mkdir(parents=True, exist_ok=True)
    model = learn(bin_folder, work)
    all_tried = []
    for seed in COUNTRIES:
        of_country = list(tried(bin_folder, work, model, seed, frames, one_tile))
        print(f"country {seed}: {len(of_country)} of {frames} frames, mean P {sum(p for p, _, _ in of_country) / len(of_country):.3f}, right "
              f"{sum(right for _, _, right in of_country)}, wrong {sum(fix and not right for _, fix, right in of_country)}", flush=True)
        all_tried.append(of_country)
    elsewhere = [fixes_elsewhere(bin_folder, work, seed) for seed in COUNTRIES]
    print(f"of other ground: {sum(fixes for _, fixes in elsewhere)} fixes of {sum(of for of, _ in elsewhere)} frames")
    for low, high in zip(EDGES, EDGES[1:]):
        inside = [[one for one in country if low <= one[0] < high] for country in all_tried]
        count = sum(map(len, inside))
        if count:
            mean_p = sum(one[0] for country in inside for one in country) / count
            shares = [sum(one[2] for one in country) / len(country) for country in inside if country]
            right = sum(one[2] for country in inside for one in country)
            print(f"P {low:.2f} to {min(high, 1):.2f}: {count} frames, mean P {mean_p:.3f}, right {right / count:.3f}, by country "
                  f"{min(shares):.3f} to {max(shares):.3f}")


if __name__ == "__main__":
    if len(sys.argv) not in (3, 4, 5) or sys.argv[4:] not in ([], ["one-tile"]):
        sys.exit(__doc__)
    main(pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2]), int(sys.argv[3]) if len(sys.argv) > 3 else 500, len(sys.argv) == 5)
