#!/usr/bin/python3
"""What surfaces at every second or fourth lag cost in truth: scores of the same tiles with and without --every-lag.

  lattice_of_lags.py PILOTAGE RASTER... [--tile 256] [--stride 64] [--radius 256]

Prints a row of a Markdown table for each raster: tiles, the share of them whose rival differs by less than 1e-4, the 99.9th
percentile and the largest difference, and the largest relative difference of the PSR.
numpy only. docs/methods/uniqueness.md holds the table."""
import argparse
import csv
import os
import subprocess
import tempfile

import numpy as np


def columns(path):
    with open(path, encoding="utf-8") as file:
        rows = list(csv.DictReader(line for line in file if not line.startswith("#")))
    return {name: np.array([float(row[name]) if row[name] else np.nan for row in rows])
            for name in rows[0] if name.startswith("clean_")}


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("pilotage")
    parser.add_argument("rasters", nargs="+")
    parser.add_argument("--tile", default="256")
    parser.add_argument("--stride", default="64")
    parser.add_argument("--radius", default="256")
    options = parser.parse_args()
    print("| raster | tiles | rival within 1e-4 | 99.9 % within | largest | PSR, largest |")
    print("|---|---|---|---|---|---|")
    for raster in options.rasters:
        with tempfile.TemporaryDirectory() as folder:
            scores = []
            for name, extra in (("lattice", []), ("all", ["--every-lag"])):
                table = os.path.join(folder, name + ".csv")
                subprocess.run(
                    [options.pilotage, "score", raster, "-q", "--tile-size-px", options.tile, "--stride-px", options.stride,
                     "--search-radius-px", options.radius, "--measures", "uniqueness", "-o",
                     os.path.join(folder, name + ".tif"), "--table", table, *extra],
                    check=True, stdout=subprocess.DEVNULL)
                scores.append(columns(table))
        lattice, every = scores
        rival = np.abs(lattice["clean_rival"] - every["clean_rival"])
        psr = np.abs(lattice["clean_psr"] / every["clean_psr"] - 1)
        known = rival[~np.isnan(rival)]
        print(f"| {os.path.basename(raster)} | {known.size} | {np.mean(known < 1e-4) * 100:.1f} % | "
              f"{np.percentile(known, 99.9):.4f} | {known.max():.4f} | {np.nanmax(psr) * 100:.1f} % |")


if __name__ == "__main__":
    main()
