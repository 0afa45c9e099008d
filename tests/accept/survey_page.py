"""What `pilotage survey` writes, as a planner and a GIS analyst look at it: the page in a real browser held against survey.json, the
layers and rasters with GDAL.

survey_page.py PILOTAGE SOURCE_FOLDER FOLDER_OF_SCREENSHOTS"""

import csv
import json
import pathlib
import re
import sys
import xml.etree.ElementTree
import zipfile

from acceptance import SKIP, check, main, need_gdal, need_sample, run
from browser import Browser, missing_programs
from page_design import asks_for_nothing, fits_width

gdal = need_gdal()
COLORS = {"go": "#0072b2", "marginal": "#e69f00", "no-go": "#d5008a"}
TILE_PLACE = """const box = document.getElementById('map').getBoundingClientRect(); const f = pilotage.display.cells_m[arguments[0]];
const p = pilotage.map.latLngToContainerPoint(pilotage.toLatLng((f[0] + f[4]) / 2, (f[1] + f[5]) / 2));
return [box.left + p.x, box.top + p.y]"""
# Colour [r, g, b, a] that the heat map has at the middle of a tile, from a copy (reading the page's own canvas makes the browser talk).
CHOOSE_MEASURE = """const list = document.getElementById('measure'); list.value = arguments[0];
list.dispatchEvent(new Event('change'))"""
HEAT_COLOR = """const layer = pilotage.layers.heat; const view = layer.view(); const f = pilotage.display.cells_m[arguments[0]];
const small = document.createElement('canvas'); small.width = small.height = 1; const context = small.getContext('2d', {willReadFrequently: true});
context.drawImage(layer.canvas, -Math.round(view.x((f[0] + f[4]) / 2)), -Math.round(view.y((f[1] + f[5]) / 2)));
return [...context.getImageData(0, 0, 1, 1).data]"""


class Survey:
    """survey.json, and its tiles by name."""

    def __init__(self, folder):
        self.json = json.loads((folder / "survey.json").read_text(encoding="utf-8"))
        columns = self.json["tiles"]["columns"]
        self.tiles = [dict(zip(columns, row)) for row in self.json["tiles"]["rows"]]


def numbers_add_up(survey, folder):
    """The shares are those of the tiles, whose classes are those of the route report: P from 0.5, from 0.2, below."""
    def named(tile):
        if tile["status"] != "scored":
            return "no-go"
        p = tile["p_correct_fix"]
        return "go" if p >= 0.5 else "marginal" if p >= 0.2 else "no-go"
    check(all(tile["class"] == named(tile) for tile in survey.tiles), "a tile's class does not follow from its P")
    area = survey.json["area"]
    counts = {name: sum(1 for tile in survey.tiles if tile["class"] == name) for name in COLORS}
    check(counts == {"go": area["go_tiles"], "marginal": area["marginal_tiles"], "no-go": area["no_go_tiles"]}, f"{counts}: {area}")
    check(min(counts.values()) > 0, f"the area does not have all classes: {counts}")
    share = int(100 * counts["go"] / len(survey.tiles) + 1e-9)
    check(f"over {share} % of the area: " in survey.json["headline"], survey.json["headline"])
    level = survey.json["grid"]["levels"][0]
    cell_km2 = (level["stride_px"] * level["gsd_m"] / 1000) ** 2
    check(abs(area["area_km2"] - len(survey.tiles) * cell_km2) < 1e-4, f"{area['area_km2']} km²")
    squares = survey.json["squares"]
    for key in ("tiles", "go_tiles", "marginal_tiles", "no_go_tiles"):
        check(sum(square[key] for square in squares) == area[key], f"the squares have not all {key}")
    with open(folder / "survey_squares.csv", newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    check(len(rows) == len(squares), "survey_squares.csv has other squares")
    for row, square in zip(rows, squares):
        for key in ("east_km", "north_km", "tiles", "go_share", "median_p_correct_fix"):
            check(float(row[key]) == square[key], f"{key}: {row[key]} in the table, {square[key]} in survey.json")


def layers_are_styled(survey, folder):
    layers = gdal.OpenEx(str(folder / "survey.gpkg"))
    names = [layers.GetLayer(i).GetName() for i in range(layers.GetLayerCount())]
    check(names == ["decision", "squares", "tiles", "survey", "layer_styles"], f"layers {names}")
    styles = {row["f_table_name"]: row for row in layers.GetLayerByName("layer_styles")}
    check(set(styles) == {"decision", "squares", "tiles"}, f"styles of {set(styles)}")
    for name, row in styles.items():
        root = xml.etree.ElementTree.fromstring(re.sub(r"<!DOCTYPE[^>]*>", "", row["styleQML"]))
        check(row["useAsDefault"] == 1 and root.find("renderer-v2") is not None, f"{name} comes up unstyled")
        check("selected" not in row["styleQML"], f"the style of {name} asks for a selection, which a survey does not have")
    legend = styles["decision"]["styleQML"]
    for color in COLORS.values():
        rgb = ",".join(str(int(color[k:k + 2], 16)) for k in (1, 3, 5))
        check(rgb in legend, f"{color} is not in the legend of the decision")
    tiles = layers.GetLayerByName("tiles")
    check(tiles.GetFeatureCount() == len(survey.tiles), "the layer has other tiles")
    check([feature["class"] for feature in tiles] == [tile["class"] for tile in survey.tiles], "its classes differ")
    area_m2 = {name: 0.0 for name in COLORS}
    for feature in layers.GetLayerByName("decision"):
        area_m2[feature["class"]] += feature.GetGeometryRef().GetArea()
    for name, key in (("go", "go_share"), ("marginal", "marginal_share"), ("no-go", "no_go_share")):
        wanted = survey.json["area"][key] * survey.json["area"]["area_km2"] * 1e6
        check(abs(area_m2[name] - wanted) <= 1e-3 * wanted, f"{name}: {area_m2[name]} m² drawn, {wanted} m² said")
    for square, feature in zip(survey.json["squares"], layers.GetLayerByName("squares")):
        check(abs(feature.GetGeometryRef().GetArea() - 1e6) < 1 and feature["go_share"] == square["go_share"], "a square differs")

    classes = gdal.Open(str(folder / "survey_classes.tif")).ReadAsArray()
    for value, name in enumerate(COLORS):
        check(int((classes == value).sum()) == sum(1 for tile in survey.tiles if tile["class"] == name), f"{name} in the raster")
    for raster in ("survey_classes", "survey_scores"):
        metadata = gdal.Open(str(folder / f"{raster}.tif")).GetMetadata("IMAGE_STRUCTURE")
        check(metadata.get("LAYOUT") == "COG", f"{raster}.tif is no Cloud-Optimised GeoTIFF")
        xml.etree.ElementTree.fromstring(re.sub(r"<!DOCTYPE[^>]*>", "", (folder / f"{raster}.qml").read_text(encoding="utf-8")))
    with zipfile.ZipFile(folder / "survey.kmz") as kmz:
        document = kmz.read("doc.kml").decode()
        folders = re.findall(r"<Folder[^>]*>\s*<name>([^<]*)</name>", document)
        check(folders[0] == "Decision: go, marginal, no-go" and "files/legend.png" in kmz.namelist(), f"{folders}")
        check(not re.search(r"<href>(https?:|/)", document), "the KMZ asks for something outside it")


def page_says_the_same(page, survey, path):
    page.console()
    page.devtools("Network.enable")
    page.devtools("Network.emulateNetworkConditions", offline=True, latency=0, downloadThroughput=0, uploadThroughput=0)
    page.addresses()
    page.open(path)
    page.wait("const image = pilotage.layers.imagery.getElement(); return image.complete && image.naturalWidth > 0", "the imagery")
    asks_for_nothing(page)
    told = page.run("return document.querySelector('.verdict').textContent")
    for said in [survey.json["headline"], survey.json["detail"], survey.json["not_looked_at"], *survey.json["assumptions"]]:
        check(said[1:] in told, f"under the headline is not said: {said}")
    check(not re.search(r"\bGO\b|NO-GO", told), "an area has a verdict")
    check(page.run("return document.getElementById('measure').value") == "0", "the map does not open on P(correct fix)")
    page.run(CHOOSE_MEASURE, -1)
    legend = page.run("return document.getElementById('scale-classes').textContent")
    for name in COLORS:
        i = next(i for i, tile in enumerate(survey.tiles) if tile["class"] == name)
        drawn, wanted = page.run(HEAT_COLOR, i), [int(COLORS[name][k:k + 2], 16) for k in (1, 3, 5)]
        check(max(abs(a - b) for a, b in zip(drawn, wanted)) <= 4, f"{name}: drawn {drawn}, wanted {wanted}")
        check(f"{name}: {sum(1 for tile in survey.tiles if tile['class'] == name)} tile" in legend, f"{name} in {legend}")


def map_works(page, survey):
    for name in ("imagery", "heat", "classes", "squares"):
        for expected in (False, True):
            page.run("document.getElementById('show-' + arguments[0]).click()", name)
            shown = page.run("return pilotage.map.hasLayer(pilotage.layers[arguments[0]])", name)
            check(shown is expected, f"layer {name}: shown {shown}, its box says {expected}")
    page.run(CHOOSE_MEASURE, 0)
    measure = survey.json["measures"][0]
    ends = page.run("return ['scale-low', 'scale-high'].map((id) => document.getElementById(id).textContent)")
    check([float(end.strip("≤≥ ")) for end in ends] == [round(measure[end], 2) for end in ("low", "high")],
          f"the scale's ends are {ends}, and the ground's own {measure}")
    page.run("document.getElementById('whole').click()")
    ends = page.run("return ['scale-low', 'scale-high'].map((id) => document.getElementById(id).textContent)")
    check(ends == ["0.00", "1.00"], f"from 0 to 1 the scale's ends are {ends}")
    page.run("const slider = document.getElementById('threshold'); slider.value = 100; slider.dispatchEvent(new Event('input'))")
    counted = page.run("return document.getElementById('threshold-count').textContent")
    above = sum(1 for tile in survey.tiles if (tile["p_correct_fix"] or 0) >= 0.5)
    check(counted == f"{above} of {len(survey.tiles)} tiles at or above 0.50", f"the threshold says: {counted}")
    page.run("document.getElementById('whole').click()")
    buttons = page.run("return [...document.querySelectorAll('button.show-tile')].map((node) => Number(node.dataset.tile))")
    check(len(buttons) == 2, f"{len(buttons)} places are named, not the strongest and the weakest")
    for button, pick in zip(buttons, (max, min)):
        extreme = pick(tile["p_correct_fix"] for tile in survey.tiles if tile["p_correct_fix"] is not None)
        page.run("document.querySelector('button.show-tile[data-tile=\"' + arguments[0] + '\"]').click()", button)
        check(page.run("return pilotage.state.tile") == button, f"Show does not show tile {button}")
        check(survey.tiles[button]["p_correct_fix"] == extreme, f"{pick.__name__} of P is {extreme}, not of tile {button}")
    page.run("document.getElementById('map').scrollIntoView({block: 'center'})")
    i = next(i for i, tile in enumerate(survey.tiles) if tile["class"] == "no-go" and tile["reasons"])
    page.click(*page.run(TILE_PLACE, i))
    check(page.run("return pilotage.state.tile") == i, f"a click on tile {i} shows {page.run('return pilotage.state.tile')}")
    shown = page.run("return document.getElementById('tile').textContent")
    for said in (f"Tile {survey.tiles[i]['tile_id']}", "no-go", survey.tiles[i]["reasons"]):
        check(said in shown, f"the tile does not say {said}: {shown[:300]}")
    check("chosen" not in shown and "refused" not in shown, "a survey chooses nothing")
    page.press("Escape")
    rows = page.run("return [...document.querySelectorAll('#squares tr')].map((row) => row.textContent)")
    check(len(rows) == len(survey.json["squares"]), f"{len(rows)} squares in the table")
    for row, square in zip(rows, survey.json["squares"]):
        check(f"E{square['east_km']} N{square['north_km']}" in row and f"{int(100 * square['go_share'] + 1e-9)} %" in row, row)
    before = page.run("return pilotage.map.getZoom()")
    page.run("document.querySelector('button.show-square').click()")
    check(page.run("return pilotage.map.getZoom()") != before, "Show does not move the map")


def fits_screens_and_paper(page, pictures):
    for scheme in ("light", "dark"):
        page.prefer(scheme)
        page.screenshot(pictures / f"survey_{scheme}.png")
    page.prefer("light")
    page.full_screenshot(pictures / "survey_desktop.png")
    page.resize(390, 844)
    fits_width(page, "survey.html on a phone")
    page.full_screenshot(pictures / "survey_phone.png")
    page.resize(1400, 1000)
    (pictures / "survey.pdf").write_bytes(page.pdf())
    check(page.run("return document.getElementById('map').offsetWidth") > 700, "after printing the map stays as narrow as paper")


def test(pilotage, source, work, rest):
    need_sample(source)
    pictures = pathlib.Path(rest[0])
    pictures.mkdir(parents=True, exist_ok=True)
    # The lake and the town of the sample: ground of all classes.
    gdal.Translate(str(work / "ortho.tif"), str(source / "maps/sample/ortho.tif"), srcWin=[1200, 400, 2400, 1600])
    run(pilotage, "survey", work / "ortho.tif", "--camera", source / "maps/sample/camera.yaml", "--agl-m", "100",
        "--elevation", source / "maps/sample/elevation.tif", "-q", "-o", work / "out")
    survey = Survey(work / "out")
    numbers_add_up(survey, work / "out")
    layers_are_styled(survey, work / "out")
    if missing_programs():
        print(f"numbers and layers are right; the page was not looked at: {missing_programs()} not installed")
        sys.exit(SKIP)
    with Browser() as page:
        page_says_the_same(page, survey, work / "out/survey.html")
        map_works(page, survey)
        fits_screens_and_paper(page, pictures)
        said = page.console()
        check(not said, f"the console has: {said}")


main(test)
