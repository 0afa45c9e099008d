"""What the acceptance tests of `match` share: maps of whole rasters, frames with truth, and what came of them."""

import csv
import json
import subprocess

from acceptance import check, run
from whole_map import make_whole_map

CAMERA = (60, 640, 480)  # degrees, pixels: that of cut_flight_frames


def cut(tool, raster, folder, **options):
    """Frames of a raster; options as of cut_flight_frames: cut(…, footprint_m=154, frames=100). Returns the folder."""
    flags = [part for name, value in options.items() for part in ("--" + name.replace("_", "-"), value)]
    run(tool, raster, "-o", folder, *flags)
    return folder


def write_rows(folder, rows):
    with open(folder / "frames.csv", "w", newline="") as stream:
        writer = csv.DictWriter(stream, rows[0].keys(), lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)


def move_priors(folder, other):
    """Makes the frames of a folder claim to be where those of another one are: frames over the wrong map."""
    with open(folder / "frames.csv", newline="") as stream:
        rows = list(csv.DictReader(stream))
    with open(other / "frames.csv", newline="") as stream:
        claims = list(csv.DictReader(stream))
    for i, row in enumerate(rows):
        for name in ("prior_lon_deg", "prior_lat_deg", "prior_sigma_m"):
            row[name] = claims[i % len(claims)][name]
    write_rows(folder, rows)


def tell_heights(folder, factor):
    """Makes the frames of a folder claim to be so many times as high as they do."""
    with open(folder / "frames.csv", newline="") as stream:
        rows = list(csv.DictReader(stream))
    for row in rows:
        row["height_agl_m"] = repr(factor * float(row["height_agl_m"]))
    write_rows(folder, rows)


def fly(pilotage, map_path, folder, *options):
    """Matches the frames of a folder; returns what `match --json` says of them."""
    done = subprocess.run(
        [str(part) for part in (pilotage, "match", map_path, "--frames", folder / "frames.csv", "--camera",
                                folder / "camera.yaml", "--allow-other-camera", "-o", folder / "fixes.csv",
                                "--overwrite", "--json", "-q", *options)],
        text=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE, check=False)
    check(done.returncode == 0, f"match: exit {done.returncode}\n{done.stdout}{done.stderr}")
    return json.loads(done.stdout)


def percent(rate):
    low, high = rate["low"], rate["high"]
    return f"{rate['count']} of {rate['of']} ({100 * low:.1f} to {100 * high:.1f} %)"


def tell(what, told):
    """One line for people."""
    refused = ", ".join(f"{count} {name}" for name, count in told["refused"].items())
    text = f"{what}: correct {percent(told['correct_fixes'])}, false among accepted {told['false_fixes']['count']} of " \
           f"{told['false_fixes']['of']}; refused: {refused or 'none'}"
    if told["accepted"]:
        centers = told["centers"]
        text += f"; error {told['median_error_m']:.2f} m median, {told['p95_error_m']:.2f} m 95 %, NEES mean of the " \
                f"correct {told['nees_correct']['mean']:.2f}; centres {centers['within']} of {centers['fixes']} right, " \
                f"{centers['median_error_m']:.2f} m median, {centers['p95_error_m']:.2f} m 95 %"
    print(text, flush=True)


MOST_NEES = 2.8  # of the aircraft's place, 2 where covariances are true: of some 40 fixes and more


def check_rates(what, told, least_correct, most_false):
    """Shares of fixes whose centre is right of all frames, and whose centre is not of the accepted: whether the ground
    was recognised. How far the aircraft is off besides is tilt, and its covariance must say so."""
    tell(what, told)
    right = told["centers"]["within"] if told["centers"] else 0
    check(right >= least_correct * told["frames"], f"{what}: fewer than {least_correct} correct")
    check(told["accepted"] - right <= most_false * max(1, told["accepted"]),
          f"{what}: more than {most_false} of the accepted are false")
    check(told["accepted"] < 40 or told["nees_correct"]["mean"] <= MOST_NEES, f"{what}: covariances are too small")


def check_none(what, told, allowed=0):
    """Frames of which none has its ground in the window: every fix is a false one."""
    print(f"{what}: {told['accepted']} of {told['frames']} accepted", flush=True)
    check(told["accepted"] <= allowed, f"{what}: {told['accepted']} accepted, not at most {allowed}")


def whole_map(pilotage, raster, path, footprint_m, gsd_m=None, build_args=()):
    tile_args = ("--gsd-m", gsd_m) if gsd_m else ()
    make_whole_map(pilotage, raster, path, (footprint_m,), CAMERA, tile_args, build_args)
    return path
