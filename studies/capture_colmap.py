"""COLMAP's opinion on a block that `capture` adjusted: the frames that it used through COLMAP's own features, matches and bundle
adjustment, which know nothing of positions and attitudes, and both results laid over each other by a similarity. Run by
hand; judges nothing. Wants Debian's package colmap (3.8) on the PATH.

capture_colmap.py PILOTAGE FRAMES --work DIR [CAPTURE OPTION...]      FRAMES: a folder of photos, or a frames.csv

FRAMES is a folder with positions in its photos' tags (COLMAP then tries each frame with its 30 nearest), or a table (COLMAP
tries all pairs). Options for `capture` go last. Prints what came out of each: frames, points, sightings, reprojection error,
focal length, k1, k2, time; then the distance of the frames' places horizontally and in height, and of their viewing
directions and headings; and all of that once more with COLMAP held to the lens that `capture` found, which over flat ground
no pictures tell from the height. Heights of `capture` are those above the ground below each frame: over relief they are not those
of one level, and heights and turns in common then say less. COLMAP's features and matches are kept in DIR and not worked out again."""

import argparse
import csv
import json
import os
import pathlib
import shutil
import sqlite3
import subprocess
import sys
import time

import numpy as np

SEMI_MAJOR_M, ECCENTRICITY2 = 6378137.0, 0.00669437999014  # WGS 84
CAMERA_FROM_BODY = np.array([[0, 1, 0], [-1, 0, 0], [0, 0, 1]])  # x right, y backwards of the nose: straight down, not mounted


def run(log, *command):
    with open(log, "a", encoding="utf-8") as said:
        status = subprocess.run([str(word) for word in command], stdout=said, stderr=subprocess.STDOUT,
                                env={**os.environ, "QT_QPA_PLATFORM": "offscreen"}, check=False).returncode
    if status != 0:
        sys.exit(f"{' '.join(map(str, command))}: ended with {status}; {log}")


def match_by_colmap(frames, used, work):
    """Features and matches into COLMAP's database; the seconds that they took."""
    kept, database, pictures, log = work / "matched.json", work / "colmap.db", work / "pictures", work / "colmap.txt"
    if not kept.exists():
        database.unlink(missing_ok=True)
        shutil.rmtree(pictures, ignore_errors=True)
        pictures.mkdir()
        for file in used:
            (pictures / file.name).symlink_to(file.resolve())
        start = time.monotonic()
        run(log, "colmap", "feature_extractor", "--database_path", database, "--image_path", pictures, "--ImageReader.single_camera", 1,
            "--ImageReader.camera_model", "RADIAL", "--SiftExtraction.use_gpu", 0)
        matcher = ("exhaustive_matcher",) if frames.is_file() else ("spatial_matcher", "--SpatialMatching.max_num_neighbors", 30)
        run(log, "colmap", *matcher, "--database_path", database, "--SiftMatching.use_gpu", 0)
        kept.write_text(json.dumps({"frames": str(frames), "seconds": time.monotonic() - start}))
    said = json.loads(kept.read_text())
    if said["frames"] != str(frames):
        sys.exit(f"{work} is of {said['frames']}")
    return said["seconds"]


def adjust_by_colmap(work, sparse, lens=None):
    """The folder of COLMAP's largest model as text, how many models there are, and the seconds that it took. `lens`: focal
    length, k1 and k2 to hold; else they are adjusted from what the tags say."""
    log = work / "colmap.txt"
    shutil.rmtree(sparse, ignore_errors=True)
    sparse.mkdir()
    database = work / "colmap.db"
    held = ()
    if lens is not None:
        database = sparse / "held.db"
        shutil.copy(work / "colmap.db", database)
        with sqlite3.connect(database) as cameras:
            (params,) = cameras.execute("SELECT params FROM cameras").fetchone()
            _, centre_x, centre_y, _, _ = np.frombuffer(params)
            focal_px, k1, k2 = lens
            cameras.execute("UPDATE cameras SET params = ?, prior_focal_length = 1",
                            (np.array([focal_px, centre_x, centre_y, k1, k2]).tobytes(),))
        held = ("--Mapper.ba_refine_focal_length", 0, "--Mapper.ba_refine_extra_params", 0)
    start = time.monotonic()
    run(log, "colmap", "mapper", "--database_path", database, "--image_path", work / "pictures", "--output_path", sparse, *held)
    seconds = time.monotonic() - start
    models = sorted(path for path in sparse.iterdir() if (path / "images.bin").exists())
    if not models:
        sys.exit(f"COLMAP made no model; {log}")
    for model in models:
        run(log, "colmap", "model_converter", "--input_path", model, "--output_path", model, "--output_type", "TXT")
    return max(models, key=lambda model: len(read_images(model))), len(models), seconds


def pictures_of(frames):
    if frames.is_dir():
        return sorted(path for path in frames.iterdir() if path.suffix.lower() in (".jpg", ".jpeg", ".tif", ".png"))
    with open(frames, encoding="utf-8-sig", newline="") as table:
        return [frames.parent / row["file"] for row in csv.DictReader(table)]


def read_images(model):
    """By name: the turn from the world to the camera (3 x 3) and the camera's place in the world."""
    lines = [line for line in (model / "images.txt").read_text().splitlines() if not line.startswith("#")]
    images = {}
    for line in lines[::2]:  # every second line lists the sightings
        words = line.split(maxsplit=9)
        w, x, y, z = map(float, words[1:5])
        turn = np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
                         [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                         [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]])
        images[words[9]] = turn, -turn.T @ np.array(words[5:8], float)
    return images


def reprojection_rms_px(model):
    """Over all sightings, as `capture` counts: by pixels of images.txt and points of points3D.txt through the lens."""
    focal_px, centre_x, centre_y, k1, k2 = camera_of(model)
    points = {}
    for line in (model / "points3D.txt").read_text().splitlines():
        if not line.startswith("#"):
            words = line.split()
            points[int(words[0])] = np.array(words[1:4], float)
    lines = [line for line in (model / "images.txt").read_text().splitlines() if not line.startswith("#")]
    images = read_images(model)
    squares, count = 0.0, 0
    for head, sightings in zip(lines[::2], lines[1::2]):
        turn, place = images[head.split(maxsplit=9)[9]]
        table = np.array(sightings.split(), float).reshape(-1, 3)
        table = table[table[:, 2] >= 0]
        rays = (np.array([points[int(point)] for point in table[:, 2]]) - place) @ turn.T
        u, v = rays[:, 0] / rays[:, 2], rays[:, 1] / rays[:, 2]
        r2 = u * u + v * v
        lens = focal_px * (1 + k1 * r2 + k2 * r2 * r2)
        squares += float(np.sum((centre_x + lens * u - table[:, 0]) ** 2 + (centre_y + lens * v - table[:, 1]) ** 2))
        count += len(table)
    return (squares / count) ** 0.5, len(points), count


def camera_of(model):
    lines = [line for line in (model / "cameras.txt").read_text().splitlines() if not line.startswith("#")]
    return tuple(map(float, lines[0].split()[4:9]))


def similarity(from_points, to_points):
    """Scale, turn and shift that take the first (n x 3) to the second with least squares (S. Umeyama, PAMI 13, 1991)."""
    a, b = from_points - from_points.mean(0), to_points - to_points.mean(0)
    u, d, vt = np.linalg.svd(b.T @ a / len(a))
    sign = np.diag([1, 1, np.sign(np.linalg.det(u) * np.linalg.det(vt))])
    turn = u @ sign @ vt
    scale = np.trace(np.diag(d) @ sign) / np.mean(np.sum(a * a, 1))
    return scale, turn, to_points.mean(0) - scale * turn @ from_points.mean(0)


def body_from_ned(yaw_deg, pitch_deg, roll_deg):
    y, p, r = np.radians([yaw_deg, pitch_deg, roll_deg])
    about_z = np.array([[np.cos(y), np.sin(y), 0], [-np.sin(y), np.cos(y), 0], [0, 0, 1]])
    about_y = np.array([[np.cos(p), 0, -np.sin(p)], [0, 1, 0], [np.sin(p), 0, np.cos(p)]])
    about_x = np.array([[1, 0, 0], [0, np.cos(r), np.sin(r)], [0, -np.sin(r), np.cos(r)]])
    return about_x @ about_y @ about_z


def rms(values):
    return float(np.sqrt(np.mean(np.square(values))))


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("pilotage", type=pathlib.Path)
    parser.add_argument("frames", type=pathlib.Path)
    parser.add_argument("--work", type=pathlib.Path, required=True)
    given, options = parser.parse_known_args()
    given.work.mkdir(parents=True, exist_ok=True)

    start = time.monotonic()
    captured = subprocess.run([given.pilotage, "capture", given.frames, "-o", given.work / "map.tif", "--overwrite", "--leave-out", "-q",
                               "--json", *options], stdout=subprocess.PIPE, check=True)
    seconds = time.monotonic() - start
    block = json.loads(captured.stdout)
    camera = block["camera"]
    print(f"capture: {len(block['frames'])} of {block['frames_given']} frames, {block['points']} points, {block['sightings']} sightings, "
          f"{block['reprojection_rms_px']:.2f} px RMS; focal length {camera['focal_length_px']:.1f} px, k1 {camera['k1']:.4f}, "
          f"k2 {camera['k2']:.4f}; {seconds:.0f} s with the map", flush=True)

    names = {pathlib.Path(frame["file"]).name for frame in block["frames"]}
    used = [file for file in pictures_of(given.frames) if file.name in names]
    matching_s = match_by_colmap(given.frames, used, given.work)
    for name, lens in (("sparse", None), ("held", (camera["focal_length_px"], camera["k1"], camera["k2"]))):
        model, models, seconds = adjust_by_colmap(given.work, given.work / name, lens)
        compare(block, model, models, matching_s + seconds, "COLMAP:  " if lens is None else "COLMAP with that lens:")


def compare(block, model, models, seconds, who):
    images = read_images(model)
    rms_px, points, sightings = reprojection_rms_px(model)
    focal_px, _, _, k1, k2 = camera_of(model)
    others = f" ({models} models, the largest)" if models > 1 else ""
    print(f"{who} {len(images)} of {len(block['frames'])} frames{others}, {points} points, {sightings} sightings, "
          f"{rms_px:.2f} px RMS; focal length {focal_px:.1f} px, k1 {k1:.4f}, k2 {k2:.4f}; {seconds:.0f} s")

    both = [frame for frame in block["frames"] if pathlib.Path(frame["file"]).name in images and frame["agl_m"] is not None]
    lat0, lon0 = np.mean([np.radians([frame["lat_deg"], frame["lon_deg"]]) for frame in both], 0)
    across = 1 - ECCENTRICITY2 * np.sin(lat0) ** 2
    north_radius_m, east_radius_m = SEMI_MAJOR_M * (1 - ECCENTRICITY2) / across**1.5, SEMI_MAJOR_M / across**0.5
    ours = np.array([[(np.radians(frame["lat_deg"]) - lat0) * north_radius_m,
                      (np.radians(frame["lon_deg"]) - lon0) * east_radius_m * np.cos(lat0), -frame["agl_m"]]
                     for frame in both])  # north, east, down
    theirs = np.array([images[pathlib.Path(frame["file"]).name][1] for frame in both])
    scale, turn, shift = similarity(theirs, ours)
    misses = ours - (scale * theirs @ turn.T + shift)
    horizontal = np.hypot(misses[:, 0], misses[:, 1])
    worst = int(np.argmax(horizontal))
    print(f"places of {len(both)} frames: {rms(horizontal):.3f} m RMS horizontally (largest {horizontal[worst]:.3f} m, "
          f"{pathlib.Path(both[worst]['file']).name}), {rms(misses[:, 2]):.3f} m in height, of {np.mean(-ours[:, 2]):.0f} m")
    # The similarity's turn is that of the places; the frames' own turns have one more in common, which flat blocks hide.
    between = []
    for frame in both:
        mine = CAMERA_FROM_BODY @ body_from_ned(frame["yaw_deg"], frame["pitch_deg"], frame["roll_deg"])
        between.append(mine.T @ (images[pathlib.Path(frame["file"]).name][0] @ turn.T))
    u, _, vt = np.linalg.svd(sum(between))
    common = u @ np.diag([1, 1, np.linalg.det(u @ vt)]) @ vt
    angle_deg = lambda m: np.degrees(np.arccos(np.clip((np.trace(m) - 1) / 2, -1, 1)))
    print(f"turns: {angle_deg(common):.2f} deg in common, {rms([angle_deg(common.T @ m) for m in between]):.3f} deg RMS beside that")


if __name__ == "__main__":
    main()
