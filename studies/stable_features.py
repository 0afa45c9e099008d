"""What `build --keep-features stable` drops on the port, and what that does to fixes.

stable_features.py PILOTAGE CUT_FLIGHT_FRAMES FOLDER [FRAMES]

The map is of 2019, the second date and the frames are of 2020: the frames show the very day that chose the features, so
these fixes say how well it can go, not what to expect of a third day. Beside all features and the stable ones: about as
many as the stable ones, chosen by --features-per-mpx alone, and the stable ones of five times as many candidates."""

import os
import pathlib
import re
import sys

sys.path.append(str(pathlib.Path(__file__).resolve().parents[1] / "tests/accept"))  # helpers shared with the tests
from acceptance import need_gdal  # noqa: E402
from match_flights import CAMERA, cut, fly, tell  # noqa: E402
from registered_truth import correct_truth  # noqa: E402
from whole_map import make_whole_map  # noqa: E402

need_gdal()

FEATURES_PER_MPX = 20000
FOOTPRINTS = ((154, 0.6), (80, 0.45))  # metres, metres per pixel


def measure(pilotage, tool, port, work, footprint_m, gsd_m, frames):
    first, second = port / "port_2019-08.tif", port / "port_2020-07_registered.tif"
    folder = cut(tool, second, work / f"frames_{footprint_m}", frames=frames, footprint_m=footprint_m, also=first)
    correct_truth(folder, second, first)
    counts = {}

    def fly_over(name, *build_args):
        path = work / f"{name}_{footprint_m}.gpkg"
        said = make_whole_map(pilotage, first, path, (footprint_m,), CAMERA, ("--gsd-m", gsd_m), build_args)
        print(said[re.search(r"\d+ tiles, \d+ descriptors", said).start():].strip())
        counts[name] = int(re.search(r"(\d+) descriptors", said).group(1))
        tell(f"{footprint_m} m, {name}", fly(pilotage, path, folder))

    fly_over("all")
    stable = ("--keep-features", "stable", "--second-epoch", port / "port_2020-07_asdelivered.tif")
    fly_over("stable", *stable)
    fly_over("fewer", "--features-per-mpx", round(FEATURES_PER_MPX * counts["stable"] / counts["all"]))
    fly_over("stable_of_more", "--features-per-mpx", 5 * FEATURES_PER_MPX, *stable)


if __name__ == "__main__":
    scratch = pathlib.Path(sys.argv[3])
    scratch.mkdir(parents=True, exist_ok=True)
    for footprint in FOOTPRINTS:
        measure(sys.argv[1], sys.argv[2], pathlib.Path(os.environ["PILOTAGE_DATA"]) / "port", scratch, *footprint,
                sys.argv[4] if len(sys.argv) > 4 else 500)
