"""What the thresholds of vegetation_share and water_share are worth: patches whose cover a person named from the picture.

Each patch is cut out of real imagery (PILOTAGE_DATA) at some 0.6 m/px (Sentinel-2: 10 m/px) and measured by `pilotage score
--measures ground_cover` as one tile. Prints a Markdown table; docs/methods/reasons.md has it.

    PILOTAGE_DATA=FOLDER /usr/bin/python3 studies/ground_cover_patches.py build/dev/bin/pilotage
"""

import csv
import os
import subprocess
import sys
import tempfile
from pathlib import Path

PORT = [("muddy river", [(100, 560, 180, 620), (280, 690, 340, 730), (330, 740, 420, 790), (480, 830, 540, 870)]),
        ("forest", [(470, 200, 560, 280), (640, 190, 720, 260), (850, 400, 920, 460), (560, 740, 650, 800)]),
        ("grass", [(370, 390, 440, 420), (400, 620, 470, 670)]),
        ("felled wood", [(120, 440, 180, 490), (320, 300, 360, 340)]),
        ("coal", [(640, 345, 720, 375), (460, 485, 500, 545), (250, 505, 300, 545)])]
HONG_KONG = [("sea", [(250, 530, 380, 640), (470, 60, 530, 150)]), ("harbour", [(20, 500, 70, 570)]),
             ("forest", [(200, 270, 270, 340), (280, 60, 330, 120), (180, 420, 240, 450)]),
             ("town", [(260, 160, 340, 210), (20, 220, 80, 280)]), ("bare", [(50, 150, 100, 200)])]
# Picture, width of the picture that the coordinates refer to, width to measure at, patches (left, top, right, bottom).
PICTURES = [
    ("port/port_2019-08.tif", 1000, 1976, PORT),
    ("port/port_2020-07_registered.tif", 1000, 1976, PORT[:1] + [
        ("forest", [(470, 120, 560, 200), (640, 290, 720, 320), (850, 400, 920, 460), (580, 760, 650, 820)]),
        ("grass", [(200, 470, 230, 530)]), PORT[4]]),
    ("autzen/autzen.jpg", 800, 1650, [
        ("river", [(230, 930, 400, 980), (20, 930, 180, 970), (400, 1000, 500, 1040)]), ("lake", [(700, 870, 790, 950)]),
        ("forest", [(380, 740, 440, 880), (130, 780, 240, 830), (580, 950, 640, 1070)]),
        ("grass", [(60, 240, 180, 320), (100, 680, 200, 760), (300, 130, 390, 170)]), ("dry grass", [(230, 480, 310, 510)]),
        ("parking", [(640, 250, 700, 360), (620, 430, 720, 600), (430, 540, 500, 620)]), ("gray roof", [(230, 345, 290, 385)])]),
    ("zanzibar/zanzibar_z20.tif", 1000, 1000, [
        ("forest", [(470, 360, 600, 440), (120, 190, 200, 260), (540, 100, 650, 220)]),
        ("grass", [(0, 250, 40, 380), (100, 420, 200, 480)]), ("dry grass", [(895, 90, 970, 240)]),
        ("bare", [(0, 70, 80, 130), (760, 370, 870, 440), (760, 450, 860, 490)]), ("village", [(360, 200, 500, 300)])]),
    ("twodate/sentinel2/hongkong_1.png", 540, 540, HONG_KONG),
    ("twodate/sentinel2/hongkong_2.png", 540, 540, HONG_KONG),
    ("twodate/sentinel2/beihai_1.png", 772, 772, [
        ("green ponds", [(645, 830, 668, 875)]), ("fields", [(150, 150, 300, 300)]),
        ("dark fields", [(530, 180, 560, 240), (390, 280, 430, 320)]), ("bare", [(560, 740, 640, 790)]),
        ("town", [(390, 640, 440, 680)])])]


def run(*arguments):
    subprocess.run([str(argument) for argument in arguments], check=True, capture_output=True)


def shares(program, picture, scale, patch, folder):
    """Vegetation and water share of the largest square around the patch's centre; NaN is ''."""
    left, top, right, bottom = (round(value * scale) for value in patch)
    side = min(right - left, bottom - top)
    halo = 20  # what surrounds the square belongs to the question too
    window = [(left + right - side) // 2 - halo, (top + bottom - side) // 2 - halo, side + 2 * halo, side + 2 * halo]
    cut = folder / "cut.tif"
    run("gdal_translate", "-q", "-a_srs", "EPSG:32633", "-a_ullr", 0, 600, 600, 0, "-srcwin", *window, picture, cut)
    run(program, "score", cut, "--measures", "ground_cover", "--tile-size-px", side, "--stride-px", halo, "-o",
        folder / "s.tif", "--table", folder / "t.csv", "--overwrite", "-q")
    row = next(row for row in csv.DictReader((folder / "t.csv").open()) if (row["column"], row["row"]) == ("1", "1"))
    return float(row["vegetation_share"]), float(row["water_share"]), side * side


def main():
    program, data = Path(sys.argv[1]).resolve(), Path(os.environ["PILOTAGE_DATA"])
    print("| picture | ground | patches | pixels | green | water |\n|---|---|---:|---:|---:|---:|")
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for file, drawn, wide, kinds in PICTURES:
            picture = folder / "picture.tif"
            bands = ["-b", 1, "-b", 2, "-b", 3]
            run("gdal_translate", "-q", *bands, "-r", "average", "-outsize", wide, 0, data / file, picture)
            for kind, patches in kinds:
                found = [shares(program, picture, wide / drawn, patch, folder) for patch in patches]
                pixels = sum(share[2] for share in found)
                green, water = (sum(share[i] * share[2] for share in found) / pixels for i in (0, 1))
                print(f"| {Path(file).stem} | {kind} | {len(found)} | {pixels} | {100 * green:.0f} % | {100 * water:.0f} % |")


if __name__ == "__main__":
    main()
