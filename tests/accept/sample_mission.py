"""The sample mission end to end, looked at with other people's programs.

sample_mission.py PILOTAGE SOURCE_FOLDER [again]

With `again`: the same files come from the stages alone, and from 1 and 4 threads."""

import csv
import json
import pathlib
import shutil
import sys

from acceptance import check, main, need_gdal, run

gdal = need_gdal()

FILES = ["map.gpkg", "plan.json", "report.gpkg", "report.html", "report.json", "report_classes.qml",
         "report_classes.tif", "report_classes.tif.aux.xml", "scores.qml", "scores.tif", "selection.json",
         "simulation.json", "tiles.csv"]
BANDS = ["valid_fraction", "gray_variance", "frieden_entropy", "frieden_deficit", "clean_peak_margin",
         "degraded_peak_margin"]


def map_is_a_geopackage(path):
    listing = run("ogrinfo", "-ro", path)
    layers = [line.split(": ")[1].split(" (")[0] for line in listing.splitlines() if line[:1].isdigit()]
    check(layers == ["tiles", "route", "legs", "map_info"], listing)
    for text in (listing, run("ogrinfo", "-ro", "-al", path)):
        check("warning" not in text.lower() and "error 1" not in text.lower(), text[:2000])
    told = run(sys.executable, "-m", "osgeo_utils.samples.validate_gpkg", "--extra", "--warning-as-error", path)
    check(told == "", told)


def scores_are_cloud_optimised(path):
    run(sys.executable, "-m", "osgeo_utils.samples.validate_cloud_optimized_geotiff", path)
    dataset = gdal.Open(str(path))
    check(dataset.GetMetadataItem("LAYOUT", "IMAGE_STRUCTURE") == "COG", "scores.tif does not say that it is a COG")
    described = [dataset.GetRasterBand(i + 1).GetDescription() for i in range(dataset.RasterCount)]
    check(all(name in described for name in BANDS), f"bands: {described}")
    for i, name in enumerate(described):
        band = dataset.GetRasterBand(i + 1)
        values = band.ReadAsArray()
        values = values[values == values]
        check(band.GetNoDataValue() != band.GetNoDataValue(), f"{name}: no data is not NaN")
        minimum, maximum = float(band.GetMetadataItem("STATISTICS_MINIMUM")), float(
            band.GetMetadataItem("STATISTICS_MAXIMUM"))
        check(abs(minimum - values.min()) <= 1e-9 * abs(minimum) + 1e-12, f"{name}: minimum {minimum}, {values.min()}")
        check(abs(maximum - values.max()) <= 1e-9 * abs(maximum) + 1e-12, f"{name}: maximum {maximum}, {values.max()}")
    check(not pathlib.Path(str(path) + ".aux.xml").exists(), "scores.tif.aux.xml")


def gis_files_agree(pilotage, work):
    """Every way in which a tile's P is handed on says what tiles.csv says."""
    out = work / "out"
    run(pilotage, "report", out / "plan.json", "--table", out / "tiles.csv", "--selection", out / "selection.json",
        "--outputs", "all", "-o", work / "all.html")
    with open(out / "tiles.csv", newline="") as table:
        expected = {int(row["tile_id"]): float(row["p_correct_fix"]) for row in csv.DictReader(table)}
    report = json.loads((work / "all.json").read_text())
    at = {name: i for i, name in enumerate(report["tiles"]["columns"])}
    told = {"report.json": {row[at["tile_id"]]: row[at["p_correct_fix"]] for row in report["tiles"]["rows"]}}
    for name in ("all.gpkg", "all_tiles.geojson"):
        dataset = gdal.OpenEx(str(work / name))
        told[name] = {feature["tile_id"]: feature["p_correct_fix"] for feature in dataset.GetLayerByName("tiles")}
    for name, found in told.items():
        check(found.keys() == expected.keys(), f"{name} has other tiles")
        wrong = [tile for tile, p in expected.items() if abs(found[tile] - p) > 5e-7]
        check(not wrong, f"{name}: tiles {wrong[:5]} have another P than tiles.csv")
    for name in ("all_scores.tif", "all_classes.tif"):
        run(sys.executable, "-m", "osgeo_utils.samples.validate_cloud_optimized_geotiff", work / name)
    check((work / "all_scores.tif").read_bytes() == (out / "scores.tif").read_bytes(), "all_scores.tif differs")
    classes = gdal.Open(str(work / "all_classes.tif")).ReadAsArray()
    for number, wanted in enumerate((lambda p: p >= 0.5, lambda p: 0.2 <= p < 0.5, lambda p: p < 0.2)):
        count = sum(wanted(p) for p in expected.values())
        check((classes == number).sum() == count, f"class {number}: {(classes == number).sum()} tiles, not {count}")
    run(sys.executable, "-m", "osgeo_utils.samples.validate_gpkg", "--extra", "--warning-as-error", work / "all.gpkg")
    compared = json.loads(run(pilotage, "report", "--compare", out / "report.json", work / "all.json", "--json"))
    check(not any(compared["areas"][key] for key in ("added", "removed", "changed")), "areas differ from themselves")


def flipped_byte_is_seen(pilotage, source, work):
    flipped = work / "flipped.gpkg"
    run(sys.executable, source / "tests/data/small_mission/flip_descriptor_byte.py", work / "out/map.gpkg", flipped)
    run(pilotage, "verify", flipped, expect=4)


def stages_alone_agree(pilotage, mission, work):
    stages = work / "stages"
    stages.mkdir()
    run(pilotage, "tile", mission, "-o", "plan.json", cwd=stages)
    run(pilotage, "score", "plan.json", "-o", "scores.tif", "--table", "tiles.csv", cwd=stages)
    run(pilotage, "select", "plan.json", "--table", "tiles.csv", "-o", "selection.json", cwd=stages)
    files = ["--table", "tiles.csv", "--selection", "selection.json"]
    run(pilotage, "simulate", "plan.json", *files, "--flights", "2000", "-o", "simulation.json", cwd=stages)
    run(pilotage, "build", "plan.json", *files, "-o", "map.gpkg", cwd=stages)
    run(pilotage, "report", "plan.json", *files, "-o", "report.html", "--report-json", "report.json", cwd=stages)
    for name in ("plan.json", "tiles.csv", "selection.json", "simulation.json", "scores.tif"):
        check((stages / name).read_bytes() == (work / "out" / name).read_bytes(), f"{name} of the stages is another")
    digests = [run(pilotage, "verify", folder / "map.gpkg").split("digest ")[1].strip()
               for folder in (stages, work / "out")]
    check(digests[0] == digests[1], f"the map of the stages is another: {digests}")


def threads_do_not_matter(pilotage, mission, work):
    for threads in (1, 4):
        run(pilotage, "prepare", mission, "--threads", threads, "-o", work / f"threads{threads}")
    for name in FILES:
        first, second = ((work / f"threads{threads}" / name).read_bytes() for threads in (1, 4))
        check(first == second, f"{name} differs between 1 and 4 threads")
        check(first == (work / "out" / name).read_bytes(), f"{name} differs between two runs")


def test(pilotage, source, work, rest):
    mission = source / "maps/sample/mission.json"
    run(pilotage, "prepare", mission, "-o", work / "out")
    if rest == ["again"]:
        stages_alone_agree(pilotage, mission, work)
        threads_do_not_matter(pilotage, mission, work)
        return
    check(sorted(path.name for path in (work / "out").iterdir()) == FILES, "the files are not those that are promised")
    # Others' programs get copies: opening a GeoPackage for validation must not be able to change what is compared.
    shutil.copy(work / "out/map.gpkg", work / "map.gpkg")
    map_is_a_geopackage(work / "map.gpkg")
    check("intact" in run(pilotage, "verify", work / "out/map.gpkg"), "verify does not say intact")
    scores_are_cloud_optimised(work / "out/scores.tif")
    gis_files_agree(pilotage, work)
    flipped_byte_is_seen(pilotage, source, work)


main(test)
