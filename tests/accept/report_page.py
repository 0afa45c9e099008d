"""report.html in a real browser: what a planner does with it, held against report.json.

report_page.py PILOTAGE SOURCE_FOLDER WRITE_REPORT_SCENE FOLDER_OF_SCREENSHOTS"""

import json
import math
import pathlib
import re
import shutil
import sys

from acceptance import SKIP, check, main, run
from browser import Browser, missing_programs
from page_design import asks_for_nothing, fits_width

if missing_programs():
    print(f"skipped: {missing_programs()} not installed: apt-get install chromium chromium-driver")
    sys.exit(SKIP)

FOCUSED = """const e = document.activeElement; const s = getComputedStyle(e);
return {id: e.id || e.className.toString() || e.tagName, outline: parseFloat(s.outlineWidth), style: s.outlineStyle}"""

# Where things are in the window, in CSS pixels.
TILE_PLACE = """const box = document.getElementById('map').getBoundingClientRect(); const f = pilotage.display.cells_m[arguments[0]];
const p = pilotage.map.latLngToContainerPoint(pilotage.toLatLng((f[0] + f[4]) / 2, (f[1] + f[5]) / 2));
return [box.left + p.x, box.top + p.y]"""
ROUTE_PLACE = """const box = document.getElementById('map').getBoundingClientRect();
const p = pilotage.map.latLngToContainerPoint(pilotage.toLatLng(...pilotage.placeAlong(arguments[0])));
return [box.left + p.x, box.top + p.y]"""
CHART_PLACE = """const chart = document.getElementById('chart'); const box = chart.getBoundingClientRect(); const d = chart.dataset;
const x = Number(d.left) + arguments[0] / Number(d.distanceM) * (Number(d.right) - Number(d.left));
return [box.left + x / chart.viewBox.baseVal.width * box.width, box.top + box.height / 3]"""
# A copy to read pixels from: reading the page's own canvases makes the browser write advice to the console.
COPY = """const copy = (canvas, x, y, width, height) => { const small = document.createElement('canvas'); small.width = width;
small.height = height; const context = small.getContext('2d', {willReadFrequently: true}); context.drawImage(canvas, -x, -y);
return [...context.getImageData(0, 0, width, height).data]; };
"""
CHOOSE_MEASURE = """const list = document.getElementById('measure'); list.value = arguments[0];
list.dispatchEvent(new Event('change'))"""
# Colour [r, g, b, a] that a layer has drawn at a place of the plane.
LAYER_COLOR = COPY + """const layer = pilotage.layers[arguments[0]]; const view = layer.view(); const ratio = window.devicePixelRatio;
return copy(layer.canvas, Math.round(view.x(arguments[1]) * ratio), Math.round(view.y(arguments[2]) * ratio), 1, 1)"""


def into_view(page, identity):
    page.run("document.getElementById(arguments[0]).scrollIntoView({block: 'center'})", identity)


def cell_center(page, i):
    return page.run("const f = pilotage.display.cells_m[arguments[0]]; return [(f[0] + f[4]) / 2, (f[1] + f[5]) / 2]", i)


def text_of(page, identity):
    return page.run("return document.getElementById(arguments[0]).textContent", identity)


class Report:
    """report.json, and a tile's numbers by name."""

    def __init__(self, path):
        self.json = json.loads(pathlib.Path(path).read_text(encoding="utf-8"))
        self.columns = self.json["tiles"]["columns"]
        self.rows = [dict(zip(self.columns, row)) for row in self.json["tiles"]["rows"]]

    def first(self, holds):
        return next(i for i, row in enumerate(self.rows) if holds(row))


def opens_quietly(page, path, report):
    page.console()
    page.devtools("Network.enable")
    page.devtools("Network.emulateNetworkConditions", offline=True, latency=0, downloadThroughput=0, uploadThroughput=0)
    page.addresses()
    page.open(path)
    check(not page.run("return navigator.onLine"), "the browser is not cut off")
    page.wait("const image = pilotage.layers.imagery.getElement(); return image.complete && image.naturalWidth > 0",
              "the imagery")
    asks_for_nothing(page)
    word, answer, sentence, assumed = page.run("""return ['.word', '.answer', '.sentence', '.assumes']
      .map((what) => document.querySelector('.verdict ' + what).textContent)""")
    verdict = report.json["verdict"]
    judged = f"{answer[:-1]}; " if "P = " in answer else ""  # without probabilities the text is the sentence alone
    check(f"{word}: {judged}{sentence}" == verdict["text"], f"verdict: {word}: {answer} {sentence}")
    check(assumed == verdict["assumptions"] and assumed.startswith("assumes: "), f"assumptions: {assumed}")
    top = page.run("return document.querySelector('.verdict').getBoundingClientRect().bottom")
    check(top < 300, f"the verdict reaches down to {top} px")


def every_layer_toggles(page, more=()):
    for name in ("imagery", "heat", "classes", "selected", "refused", "route", "gaps", "grid", *more):
        for expected in (True, False) if name in ("grid", "classes") else (False, True):
            page.run("document.getElementById('show-' + arguments[0]).click()", name)
            shown = page.run("return pilotage.map.hasLayer(pilotage.layers[arguments[0]])", name)
            check(shown is expected, f"layer {name}: shown {shown}, its box says {expected}")
    page.run("""const slider = document.getElementById('opacity'); slider.value = 35;
      slider.dispatchEvent(new Event('input', {bubbles: true}))""")
    opacity = float(page.run("return getComputedStyle(document.querySelector('.leaflet-heat-pane')).opacity"))
    check(abs(opacity - 0.35) < 1e-6, f"the opacity slider at 35 % gives {opacity}")


def heat_color(report, display, measure, value):
    """The colour that report.json and the scale of a measure ask for."""
    scale = report.json["measures"][measure]
    share = min(1, max(0, (value - scale["low"]) / (scale["high"] - scale["low"])))
    color = display["colors"][display["color_maps"][measure]][int(share * 255 + 0.5)]
    return [int(color[k:k + 2], 16) for k in (1, 3, 5)]


def probability_comes_first(page, report):
    """What ranks the ground is shown first; go, marginal and no-go ground by choice, in the colours of legs and gaps."""
    check(page.run("return document.getElementById('measure').value") == "0", "the map does not open on P(correct fix)")
    untested = set(page.run("return pilotage.display.untested"))  # the scene's pixels are coarser than what P was tested on
    check(untested == {i for i, row in enumerate(report.rows) if row["p_correct_fix"] is not None}, "tiles beyond the tested")
    check(page.run("return document.getElementById('scale-untested').offsetParent !== null"), "the legend does not say the light hatch")
    page.run(CHOOSE_MEASURE, -1)
    classes, names, colors = page.run("const d = pilotage.display; return [d.classes, d.class_names, d.class_colors]")
    check(names == ["go", "marginal", "no-go"] and colors == ["#0072b2", "#e69f00", "#d5008a"], f"{names} are {colors}")
    check(len(set(classes)) >= 2, f"all tiles are of one class: {set(classes)}")
    for known in set(classes) - {None}:
        i = next(i for i, row in enumerate(report.rows) if row["level"] == 0 and classes[i] == known)
        drawn = page.run(LAYER_COLOR, "heat", *cell_center(page, i))
        wanted = [int(colors[known][k:k + 2], 16) for k in (1, 3, 5)]
        check(max(abs(a - b) for a, b in zip(drawn, wanted)) <= 4, f"class {names[known]}: drawn {drawn}, wanted {wanted}")
    told = text_of(page, "scale-classes")
    for known, name in enumerate(names):
        count = sum(1 for i, row in enumerate(report.rows) if row["level"] == 0 and classes[i] == known)
        check(f"{name}: {count} tile" in told, f"{name}: {count} tiles, the scale says {told}")
    check(not page.run("return document.getElementById('threshold').offsetParent"), "classes have a threshold")


def every_measure_is_drawn(page, report):
    display = page.run("return {colors: pilotage.display.colors, color_maps: pilotage.display.color_maps}")
    i = report.first(lambda row: row["status"] == "scored" and row["level"] == 0 and 0.2 < row["p_correct_fix"] < 0.8)
    x, y = cell_center(page, i)
    offered = page.run("return [...document.querySelectorAll('#measure option')].map((option) => Number(option.value))")
    measured = [m for m, measure in enumerate(report.json["measures"]) if measure["least"] is not None]
    check(offered == [-1] + measured and len(measured) >= 7, f"measures {offered} are offered, {measured} have values")
    for m in measured:
        measure = report.json["measures"][m]
        page.run(CHOOSE_MEASURE, m)
        drawn = page.run(LAYER_COLOR, "heat", x, y)
        wanted = heat_color(report, display, m, report.rows[i][measure["name"]])
        near = max(abs(a - b) for a, b in zip(drawn, wanted))
        check(drawn[3] == 255 and near <= 4, f"{measure['name']}: drawn {drawn}, wanted {wanted}")
        check(text_of(page, "scale-name") == measure["label"], f"the scale does not say {measure['label']}")
        unit = text_of(page, "scale-unit")
        check(unit == (measure["unit"] if measure["unit"] != "1" else "(no unit)"), f"{measure['name']}: unit {unit}")
    page.run(CHOOSE_MEASURE, 0)


def shown(value):
    """A value of report.json as the page writes it: the shortest decimal text, as JavaScript has it."""
    return json.dumps(value)


def tile_click_shows_the_numbers(page, report):
    for wanted in (False, True):
        i = report.first(lambda row: row["selected"] is wanted and row["status"] == "scored" and row["level"] == 0)
        row = report.rows[i]
        into_view(page, "map")
        page.click(*page.run(TILE_PLACE, i))
        check(text_of(page, "tile-title") == f"Tile {row['tile_id']}", "a click shows another tile")
        check(text_of(page, "tile-state") == ("chosen" if wanted else "refused"), text_of(page, "tile-state"))
        cells = page.run("""return Object.fromEntries([...document.querySelectorAll('#tile-table td')]
          .map((cell) => [cell.dataset.name, cell.textContent]))""")
        named = {name for name in report.columns if any(row[name] is not None for row in report.rows)}
        named -= {"tile_id", "reason", "reasons", "selected"}
        check(set(cells) == named, f"the table misses {named - set(cells)}, has more {set(cells) - named}")
        for name, text in cells.items():
            value = row[name]
            if value is None:
                check(text == "–", f"{name}: {text} for no value")
            elif isinstance(value, str):
                check(text == value.replace("_", " "), f"{name}: {text}, not {value}")
            else:
                number = float(text.split(" ")[0])
                check(number == value, f"{name}: {text}, not {shown(value)}")
        reasons = text_of(page, "tile-reasons")
        for part in (row["reason"], row["reasons"]):
            check(part in reasons, f"the reasons \"{reasons}\" lack \"{part}\"")
        page.wait("return !document.getElementById('tile-picture').hidden", "the tile's picture")
        colors = page.run(COPY + """const canvas = document.getElementById('tile-picture');
          return new Set(copy(canvas, 0, 0, canvas.width, canvas.height)).size""")
        check(colors > 8, f"the tile's picture has {colors} values")
        page.press("Escape")
        check(page.run("return document.getElementById('tile').hidden"), "Escape does not close the tile")


def counted(report, measure, level, threshold):
    rows = [row for row in report.rows if row["level"] == level]
    above = [row for row in rows if row[measure["name"]] is not None and row[measure["name"]] >= threshold]
    below = sum(1 for row in rows if row["selected"]) - sum(1 for row in above if row["selected"])
    return len(above), len(rows), below


def threshold_recounts(page, report):
    into_view(page, "threshold")
    page.run("document.getElementById('threshold').focus()")
    last = ""
    for level in (0, 1):
        page.run("document.querySelectorAll('input[name=level]')[arguments[0]].click()", level)
        for m in (0, 1, 3):
            measure = report.json["measures"][m]
            page.run(CHOOSE_MEASURE, m)
            page.run("document.getElementById('threshold').focus()")
            page.press(*["Right"] * 7)
            position = int(page.run("return document.getElementById('threshold').value"))
            threshold = measure["low"] + (measure["high"] - measure["low"]) * position / 200
            if m == 0:
                threshold = math.floor(100 * threshold + 0.5) / 100  # of P, to what the page says
            text = text_of(page, "threshold-count")
            told = re.match(r"(\d+) of (\d+) tiles at or above ([-\d.]+)[^;]*; (\d+) chosen tiles below; (?:less than )?\d+ % of the route", text)
            wanted = counted(report, measure, level, threshold)
            check(told and tuple(int(told.group(k)) for k in (1, 2, 4)) == wanted, f"{measure['name']} at {threshold}: {text}, not {wanted}")
            check(abs(float(told.group(3)) - threshold) <= 0.51 * 10 ** -len(told.group(3).partition(".")[2]), f"threshold {text}")
            check(text != last, "the count does not change")
            last = text
            i = report.first(lambda row: row["level"] == level and row[measure["name"]] is not None
                             and row[measure["name"]] < threshold)
            drawn = page.run(LAYER_COLOR, "heat", *cell_center(page, i))
            check(max(abs(a - b) for a, b in zip(drawn, (48, 52, 58, 140))) <= 4, f"below the threshold: {drawn}")
    page.run("""document.getElementById('threshold-on').click();
      document.querySelectorAll('input[name=level]')[0].click()""")
    page.run(CHOOSE_MEASURE, 0)
    check(text_of(page, "threshold-count") == "", "the count stays when the threshold is off")


def yellow(color):
    return color[0] > 200 and color[1] > 180 and color[2] < 140 and color[3] > 200


def chart_and_map_are_linked(page, report):
    length = report.json["route"]["length_m"]
    profile = report.json["route"]["error_profile"]["rows"]
    for share in (0.2, 0.55):
        into_view(page, "chart")
        page.move(*page.run(CHART_PLACE, share * length))
        along = page.run("return pilotage.state.along")
        check(abs(along - share * length) < 0.003 * length, f"hovering {share * length} m shows {along} m")
        check(yellow(page.run("return ((...arguments) => { " + LAYER_COLOR + " })('marks', ...pilotage.placeAlong(pilotage.state.along))")),
              "there is no marker on the map at the place of the chart")
        before = max((row for row in profile if row[0] <= along), key=lambda row: row[0])
        after = min((row for row in profile if row[0] >= along), key=lambda row: row[0])
        error = float(re.search(r"error ([\d.]+) m", text_of(page, "along-text")).group(1))
        heights = page.run("return pilotage.display.heights.findLast((row) => row[0] <= pilotage.state.along)")
        said = float(re.search(r"(\d+) m above ground", text_of(page, "along-text")).group(1))
        check(abs(said - (heights[2] - heights[1])) < 2, f"{said} m above ground at {along} m, where it is {heights}")
        check(page.run("return document.getElementById('heights-cursor').getAttribute('x1')") ==
              page.run("return document.querySelector('#chart-cursor line').getAttribute('x1')"), "the heights' cursor is elsewhere")
        check(min(before[1], after[1]) - 0.06 <= error <= max(before[1], after[1]) + 0.06, f"error {error} at {along} m")
    for share in (0.35, 0.8):
        into_view(page, "map")
        page.move(*page.run(ROUTE_PLACE, share * length))
        along = page.run("return pilotage.state.along")
        check(abs(along - share * length) < 0.01 * length, f"hovering the route at {share * length} m shows {along} m")
        x, left, right = page.run("""const d = document.getElementById('chart').dataset;
          return [Number(document.querySelector('#chart-cursor line').getAttribute('x1')), Number(d.left), Number(d.right)]""")
        reached = float(page.run("return document.getElementById('chart').dataset.distanceM"))
        check(abs(x - (left + along / reached * (right - left))) < 0.5, "the chart's cursor is elsewhere")
        check(page.run("return document.getElementById('chart-cursor').getAttribute('visibility')") == "visible", "no cursor")


def places_can_be_shown_and_copied(page, report):
    gap = report.json["route"]["gaps"][0]
    copied = page.run("return [...document.querySelectorAll('#gaps button.copy')].slice(0, 2).map((b) => b.dataset.copy)")
    wanted = [f"{gap[key]['lat_deg']:.6f}, {gap[key]['lon_deg']:.6f}" for key in ("from", "to")]
    check(copied == wanted, f"a map's search gets {copied}, not one place of {wanted} at a time")
    page.run("document.querySelector('#gaps button.show').click()")
    check(abs(page.run("return pilotage.state.along") - gap["to_distance_m"]) < 1, "Show does not go to the gap")
    for key in ("from", "to"):
        place = gap[key]
        code = page.run("return [...document.querySelectorAll('#gaps code')].slice(0, 2).map((c) => c.textContent).join(' ')")
        check(f"{place['lat_deg']:.6f}, {place['lon_deg']:.6f}" in code, f"{code} lacks {place}")
    page.run("document.querySelector('#gaps button.copy').click()")
    page.wait("return document.querySelector('#gaps button.copy').textContent === 'Copied'", "the coordinates to be copied")
    page.run("pilotage.map.fitBounds(pilotage.map.options.maxBounds)")


def keyboard_reaches_everything(page, report):
    page.run("document.querySelector('.skip').focus()")
    seen = []
    for _ in range(60):
        page.press("Tab")
        focused = page.run(FOCUSED)
        seen.append(focused["id"])
        check(focused["outline"] >= 2 and focused["style"] != "none", f"the focus on {focused['id']} cannot be seen")
        if focused["id"] == "more":
            page.press("Enter")
        if focused["id"] == "along":
            break
    order = [name for name in seen if name in ("theme", "map", "measure", "opacity", "threshold", "show-imagery",
                                               "show-gaps", "tile-number", "tile-next", "along")]
    check(order == ["theme", "map", "measure", "opacity", "threshold", "show-imagery", "show-gaps", "tile-number",
                    "tile-next", "along"], f"order of the focus: {seen}")
    page.press("Home", "Right", "Right", "Right")
    reached = float(page.run("return document.getElementById('chart').dataset.distanceM"))
    along = page.run("return pilotage.state.along")
    check(abs(along - 0.003 * reached) < 1e-6 * reached, f"three steps to the right lead to {along} m")
    spoken = page.run("return document.getElementById('along').getAttribute('aria-valuetext')")
    check(spoken == text_of(page, "along-text"), "the slider does not say what the chart shows")
    wanted = report.rows[len(report.rows) // 3]["tile_id"]
    page.run("document.getElementById('tile-number').focus(); document.getElementById('tile-number').select()")
    page.press(*str(wanted), "Enter")
    check(text_of(page, "tile-title") == f"Tile {wanted}", "the tile's number does not show the tile")
    page.run("document.getElementById('tile-next').focus()")
    page.press("Enter")
    check(text_of(page, "tile-title") == f"Tile {wanted + 1}", "Next does not show the next tile")
    page.press("Escape")
    page.run("document.getElementById('map').focus()")
    before = page.run("return pilotage.map.getZoom()")
    page.press("+")
    page.wait("return pilotage.map.getZoom() > arguments[0]", "the map to zoom by the keyboard", before)
    page.press("-")


def prints(page, work):
    size = page.run("return pilotage.map.getSize()")
    pdf = page.pdf()
    (work / "printed.pdf").write_bytes(pdf)
    pages = len(re.findall(rb"/Type /Page\b(?!s)", pdf))
    check(pdf.startswith(b"%PDF-") and 2 <= pages <= 6, f"the printed page has {pages} sheets")
    check(b"/DCTDecode" in pdf, "the imagery is not on the printed page")
    check(page.run("return pilotage.map.getSize()") == size and not page.run("return pilotage.state.printing"),
          "the map does not come back from printing")


SMALL_TARGETS = """const touched = [...document.querySelectorAll('button, select, input[type=range], input[type=number], summary, .leaflet-bar a')]
  .concat([...document.querySelectorAll('input[type=checkbox], input[type=radio]')].map((box) => box.closest('label')));
return touched.filter((e) => e.offsetParent && e.getBoundingClientRect().height < 40)
  .map((e) => (e.id || e.className || e.tagName) + ' ' + e.getBoundingClientRect().height)"""
HIDDEN_TO_THE_SIDE = """return [...document.querySelectorAll('table.cards')].filter((t) => t.scrollWidth > document.documentElement.clientWidth ||
  [...t.querySelectorAll('th, td')].some((c) => c.offsetParent && c.getBoundingClientRect().right > window.innerWidth + 1)).map((t) => t.tBodies[0].id)"""
LETTERS = """return Math.min(...[...document.querySelectorAll('.chart svg text')].map((t) => t.getBoundingClientRect())
  .filter((box) => box.width > 0).map((box) => box.height))"""


def fits_small_screens(page):
    """A phone and a tablet held upright: the map on the first screen, tables without side scroll, things to touch."""
    page.run("window.scrollTo(0, 0)")
    for name, width, height in (("phone", 390, 844), ("upright tablet", 768, 1024)):
        page.resize(width, height)
        fits_width(page, name)
        top = page.run("return document.getElementById('map').getBoundingClientRect().top + window.scrollY")
        check(top < 0.75 * height, f"{name}: the map begins at {top} px of {height}")
        aside = page.run(HIDDEN_TO_THE_SIDE)
        check(not aside, f"{name}: tables beyond the side: {aside}")
        small = page.run(SMALL_TARGETS)
        check(not small, f"{name}: too low to touch: {small}")
        letters = page.run(LETTERS)
        check(letters >= 11, f"{name}: letters of the chart are {letters} px high")
        chart = page.run("return document.getElementById('chart').getBoundingClientRect().height")
        check(chart >= 190, f"{name}: the chart is {chart} px high")
    page.resize(1400, 1000)


def looks(page, folder):
    """Pictures for people to look at; they are judged by no program."""
    folder.mkdir(parents=True, exist_ok=True)
    page.run("document.activeElement.blur(); window.scrollTo(0, 0)")
    for name, width, height in (("wide", 1920, 1080), ("desktop", 1280, 900), ("tablet", 768, 1024), ("phone", 390, 844)):
        page.resize(width, height)
        fits_width(page, name)
        for theme in ("light", "dark", "sun"):
            page.run("""const theme = document.getElementById('theme'); theme.value = arguments[0];
              theme.dispatchEvent(new Event('change'))""", theme)
            page.full_screenshot(folder / f"{name}-{theme}.png")
    page.run("const theme = document.getElementById('theme'); theme.value = ''; theme.dispatchEvent(new Event('change'))")
    for scheme, wanted in (("dark", "dark"), ("light", None)):
        page.prefer(scheme)
        page.wait("return (document.documentElement.dataset.theme || null) === arguments[0]", f"the {scheme} system", wanted)


def loss_anywhere_is_drawn(page, pilotage, source, work, pictures):
    """The P of the flight by where GNSS is lost, below the chart and in words; its band can be taken off the map."""
    mission = work / "anywhere"
    mission.mkdir()
    run("sh", source / "tests/data/small_mission/make", cwd=mission)
    run(pilotage, "prepare", "mission.json", "--denied", "anywhere", "--ins-grade", "consumer",
        "--max-error-m", "25", "-q", "-o", "out", cwd=mission)
    loss = Report(mission / "out/report.json").json["route"]["loss_anywhere"]
    page.open(mission / "out/report.html")
    check(page.run("return document.querySelectorAll('#chart .loss').length") == 1, "P by the place of loss is not drawn")
    drawn = page.run("return document.querySelector('#chart .loss').getAttribute('d')")
    places = re.findall(r"[ML]([0-9.]+) ([0-9.]+)", drawn)
    check(len(places) == len(loss["rows"]), f"{len(places)} points drawn of {len(loss['rows'])}")
    ys = [float(y) for _, y in places]
    ps = [row[2] for row in loss["rows"]]
    check(min(ps) < 0.9 < max(ps), f"P is the same wherever GNSS is lost: {min(ps)} to {max(ps)}")
    for y, p in zip(ys, ps):
        check(abs((356 - y) / 50 - p) < 0.002, f"P = {p} is drawn at {y}")
    check(page.run("const c = document.getElementById('chart'); return c.viewBox.baseVal.height") == 402, "the chart's height")
    into_view(page, "chart")
    for at in (len(ps) // 2, -1):
        page.move(*page.run(CHART_PLACE, loss["rows"][at][0] + 0.5))
        said = text_of(page, "along-text")
        rounded_down = math.floor(ps[at] * 1000 + 1e-9) / 1000
        check(f"if GNSS is lost here, with P = {rounded_down:.3f}" in said, f"at {loss['rows'][at]} the page says {said}")
    every_layer_toggles(page, ["denied"])
    for width, theme in ((1400, "light"), (390, "light"), (1400, "dark")):
        page.resize(width, 1000)
        page.prefer(theme)
        into_view(page, "chart")
        page.screenshot(pictures / f"loss_anywhere_{width}_{theme}.png")
    page.prefer("light")
    page.resize(1400, 1000)


def frame_follows_the_slider(page, pictures):
    """On a prepared mission: what the camera will see, the tile turned the same way, and where both come from."""
    page.run("pilotage.map.invalidateSize()")
    frames = page.run("return pilotage.display.seen.frames")
    check(2 <= len(frames) <= 48, f"{len(frames)} frames")
    check(len(page.run("return pilotage.display.seen.jpeg")) < 4e5 + 100, "the frames take more than 300 kB")
    last = None
    for k in (0, len(frames) // 2, len(frames) - 1):
        page.run("""const along = document.getElementById('along'); along.value = 1000 * arguments[0] / document.getElementById('chart').dataset.distanceM;
          along.dispatchEvent(new Event('input'))""", frames[k][0])
        said = text_of(page, "seen-frame-text")
        check(said.startswith(f"The camera at {frames[k][0] / 1000:.2f} km") and f"{frames[k][1]:.0f}°" in said, f"frame {k}: {said}")
        grays = [page.run(COPY + """const canvas = document.getElementById(arguments[0]);
          return copy(canvas, 0, 0, canvas.width, canvas.height).filter((_, n) => n % 64 === 0)""", name) for name in ("seen-frame", "seen-tile")]
        check(all(len(set(values)) > 8 for values in grays), f"frame {k}: a picture shows nothing")
        check(grays[0] != last, f"frame {k} is that of another place")
        last = grays[0]
        tile = page.run("return pilotage.report.tiles.rows[arguments[0]][pilotage.report.tiles.columns.indexOf('tile_id')]", frames[k][4])
        check(text_of(page, "seen-tile-text").startswith(f"Tile {tile} "), f"frame {k}: {text_of(page, 'seen-tile-text')}")
    check("from the very imagery of the map" in text_of(page, "seen-note"), "the page does not say what the frame is rendered from")
    check("No other date" in text_of(page, "seen-found"), "another date is named, and there was none")
    for width in (1280, 390):
        page.resize(width, 900)
        into_view(page, "seen")
        page.screenshot(pictures / f"seen_{width}.png")
    page.resize(1400, 1000)


def printed_by_the_program(pilotage, source, work):
    """report --pdf on a crop of the sample mission, twice: the same bytes."""
    mission = work / "mission"
    mission.mkdir()
    run("sh", source / "tests/data/small_mission/make", cwd=mission)
    run(pilotage, "prepare", "mission.json", "-q", "-o", "out", cwd=mission)
    check((mission / "out/report.html").stat().st_size <= 3e6, "report.html is larger than 3 MB")
    for name in ("a", "b"):
        run(pilotage, "report", "out/plan.json", "--table", "out/tiles.csv", "--selection", "out/selection.json",
            "-o", f"{name}.html", "--pdf", f"{name}.pdf", cwd=mission)
    first, second = ((mission / f"{name}.pdf").read_bytes() for name in ("a", "b"))
    check(first.startswith(b"%PDF-") and first == second, "two PDFs of one page differ")
    pages = len(re.findall(rb"/Type\s*/Page\b(?!s)", first))
    check(1 <= pages <= 4, f"on paper the report has {pages} pages")
    check((mission / "a.html").read_bytes() == (mission / "b.html").read_bytes(), "two pages of one plan differ")
    check(len(list(mission.glob(".*partial*"))) == 0, "something is left over")


def test(pilotage, source, work, rest):
    write_report_scene, pictures = pathlib.Path(rest[0]), pathlib.Path(rest[1])
    run(write_report_scene, work, "no-go")
    report = Report(work / "report.json")
    with Browser() as page:
        opens_quietly(page, work / "report.html", report)
        probability_comes_first(page, report)
        every_layer_toggles(page)
        every_measure_is_drawn(page, report)
        tile_click_shows_the_numbers(page, report)
        threshold_recounts(page, report)
        chart_and_map_are_linked(page, report)
        places_can_be_shown_and_copied(page, report)
        keyboard_reaches_everything(page, report)
        prints(page, work)
        fits_small_screens(page)
        looks(page, pictures)
        said = page.console()
        check(not said, f"the console has: {said}")
        run(write_report_scene, work, "polar")
        page.open(work / "report.html")
        check("not drawn" in text_of(page, "map"), "beyond 85° the page does not say that there is no map")
        said = page.console()
        check(not said, f"without a map the console has: {said}")
        if (source / "maps/sample/ortho.tif").exists() and shutil.which("gdal_translate"):
            loss_anywhere_is_drawn(page, pilotage, source, work, pictures)
            frame_follows_the_slider(page, pictures)
            said = page.console()
            check(not said, f"with GNSS lost anywhere the console has: {said}")
    shutil.copy(work / "printed.pdf", pictures / "printed.pdf")
    if (source / "maps/sample/ortho.tif").exists() and shutil.which("gdal_translate"):
        printed_by_the_program(pilotage, source, work)


main(test)
