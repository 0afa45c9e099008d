"""What the reasons are worth: how often tiles that have one are found on another date, beside all tiles of their place.

For every pair of rasters `pilotage score FIRST --evaluate SECOND` scores the first date and asks the matcher that flies about the
second. Prints a Markdown table; docs/methods/reasons.md has it.

    PILOTAGE_DATA=FOLDER /usr/bin/python3 studies/reasons_worth.py build/release/bin/pilotage port|sentinel2
"""

import csv
import os
import subprocess
import sys
import tempfile
from pathlib import Path

CODES = ["too_little_ground", "flat", "few_features", "repeats", "vegetation", "water", "edge_only", "coarse", "weak"]
PLACES = ["abudhabi", "beihai", "bercy", "bordeaux", "chongqing", "cupertino", "hongkong", "milano", "mumbai", "norcia", "pisa", "saclay_e"]


def run(*arguments):
    subprocess.run([str(argument) for argument in arguments], check=True, capture_output=True)


def scored(program, first, second, folder, options):
    """(reasons, found) of every tile that was judged."""
    run(program, "score", first, *options, "--evaluate", second, "-o", folder / "s.tif", "--table", folder / "t.csv", "--overwrite", "-q")
    reasons = {row["tile_id"]: row["reasons"].split(";") for row in csv.DictReader((folder / "t.csv").open())}
    judged = [row for row in csv.DictReader((folder / "evaluation.csv").open()) if row["outcome"] != "not_covered"]
    return [(reasons[row["tile_id"]], row["outcome"] == "correct") for row in judged]


def placed(picture, path):
    """A picture without a place, as if it had pixels of 1 m."""
    size = subprocess.run(["gdalinfo", picture], check=True, capture_output=True, text=True).stdout.split("Size is ")[1].split("\n")[0]
    width, height = (int(part) for part in size.split(","))
    run("gdal_translate", "-q", "-a_srs", "EPSG:32633", "-a_ullr", 500000, 5000000 + height, 500000 + width, 5000000, picture, path)


def print_table(places):
    everywhere = [tile for tiles in places for tile in tiles]
    print(f"{len(everywhere)} tiles, {100 * sum(found for _, found in everywhere) / len(everywhere):.0f} % found\n")
    print("| reason | tiles | found | all tiles of these places |\n|---|---:|---:|---:|")
    for code in CODES:
        found, expected = [], 0.0
        for tiles in places:
            mine = [found for reasons, found in tiles if code in reasons]
            found += mine
            expected += len(mine) * sum(found for _, found in tiles) / len(tiles)
        if found:
            print(f"| `{code}` | {len(found)} | {100 * sum(found) / len(found):.0f} % | {100 * expected / len(found):.0f} % |")


def main():
    program, data = Path(sys.argv[1]).resolve(), Path(os.environ["PILOTAGE_DATA"])
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        if sys.argv[2] == "port":
            for side in (96, 128):
                print(f"\nTiles of {side} px:", end=" ")
                options = ["--gsd-m", 0.6, "--tile-size-px", side, "--stride-px", 48, "--search-radius-px", 64]
                print_table([scored(program, data / "port/port_2019-08.tif", data / "port/port_2020-07_registered.tif", folder, options)])
            return
        places = []
        for place in PLACES:
            for date in (1, 2):
                placed(data / f"twodate/sentinel2/{place}_{date}.png", folder / f"{place}_{date}.tif")
            options = ["--tile-size-px", 64, "--stride-px", 32, "--search-radius-px", 48]
            places.append(scored(program, folder / f"{place}_1.tif", folder / f"{place}_2.tif", folder, options))
        print_table(places)


if __name__ == "__main__":
    main()
