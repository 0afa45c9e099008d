"""A route drawn on the pages of `survey` and `prepare`, as a planner draws it in a real browser: mouse, keyboard, files. What the page
predicts is held against `prepare` of what was saved.

sketch_page.py PILOTAGE SOURCE_FOLDER FOLDER_OF_SCREENSHOTS [NUMBER_OF_SKETCHES [SURVEY_FOLDER …]]"""

import json
import pathlib
import random
import sys
import zipfile

from acceptance import SKIP, check, main, need_sample, run
from browser import Browser, missing_programs
from page_design import design_holds, fits_width

if missing_programs():
    print(f"skipped: {missing_programs()} not installed: apt-get install chromium chromium-driver")
    sys.exit(SKIP)

AGREES = 0.01  # of P, page against program
ANSWERED = """return pilotage.sketch.predicted !== null && !pilotage.sketch.predicted.about && document.getElementById('sketch-state').textContent === ''"""
TOLD = """const { predicted: p, flight: f } = pilotage.sketch; return {p: p.probability.p_within_limit, interval: p.probability.interval,
verdict: p.verdict, largest_error_m: p.largest_error_m, length_m: f.length_m, matchable: f.matchable_fraction, unknown_m: f.unknown_m,
word: document.getElementById('sketch-word').textContent, answer: document.getElementById('sketch-answer').textContent,
assumes: document.getElementById('sketch-assumes').textContent, on_map: document.querySelector('.sketch-on-map').textContent}"""
POINTS = "return pilotage.sketch.points.map((point) => [point.lng, point.lat, point.agl_m, point.speed_mps])"
PLACE = """const box = document.getElementById('map').getBoundingClientRect();
const p = pilotage.map.latLngToContainerPoint(arguments[0]); return [box.left + p.x, box.top + p.y]"""
FILL = """for (const [name, value] of Object.entries(arguments[0])) document.getElementById('sketch-' + name).value = value;
pilotage.sketch.points = arguments[1].map(([lng, lat, agl_m, speed_mps]) => ({ lng, lat, agl_m, speed_mps }));
pilotage.sketch.predicted = null;
document.getElementById('sketch-limit').dispatchEvent(new Event('input'))"""
# Instead of a download, which a browser under test asks about.
KEEP_SAVED = """window.saved = {}; const make = URL.createObjectURL; let last = null;
URL.createObjectURL = (blob) => { last = blob; return make(blob); };
HTMLAnchorElement.prototype.click = function () { window.saved[this.download] = last; }"""
ENDINGS = {"plan": ".plan", "waypoints": ".waypoints", "kml": ".kml", "geojson": ".geojson", "mission": ".json"}


def saved(page, kind, folder):
    """The file, by the name that the page gives it."""
    page.run("window.saved = {}; document.querySelector('[data-save=\"' + arguments[0] + '\"]').click()", kind)
    name = page.run("return Object.keys(window.saved)[0]")
    check(name.startswith("sketch_") and name.endswith(ENDINGS[kind]), f"{kind} is saved as {name}")
    (folder / name).write_text(page.run("return window.saved[arguments[0]].text()", name), encoding="utf-8")
    return folder / name


def count(page):
    return page.run("return pilotage.sketch.points.length")


def answered(page):
    page.wait(ANSWERED, "the prediction of a sketch")
    return page.run(TOLD)


def place_of(page, share_x, share_y):
    """On the screen, of a place given by shares of the ground that the page shows, from its south-west corner."""
    corner = page.run("""const e = pilotage.display.edges_m; const [x, y] = arguments;
      return pilotage.toLatLng(e[0] + x * (e[2] - e[0]), e[1] + y * (e[3] - e[1]))""", share_x, share_y)
    return page.run(PLACE, corner)


def drag(page, from_, to):
    (x, y), (u, v) = from_, to
    moves = [{"type": "pointerMove", "duration": 20, "x": round(x + (u - x) * k / 5), "y": round(y + (v - y) * k / 5)} for k in range(6)]
    page.pointer([moves[0], {"type": "pointerDown", "button": 0}, *moves[1:], {"type": "pointerUp", "button": 0}])


def drawn_by_hand(page):
    """Mouse and keyboard: each thing that a planner does, and that it can be undone."""
    check(not page.run("return document.getElementById('sketch').hidden"), "nothing can be sketched")
    page.run("document.getElementById('map').scrollIntoView({block: 'center'}); document.getElementById('sketch-draw').click()")
    page.run("document.getElementById('map').scrollIntoView({block: 'center'})")
    shares = [(0.2, 0.3), (0.5, 0.6), (0.8, 0.35)]
    for share in shares[:2]:
        page.click(*place_of(page, *share))
    check(count(page) == 2, f"two clicks made {count(page)} points")
    check(page.run("return pilotage.state.tile") == -1, "a click that draws shows a tile, too")
    drawing = "return document.getElementById('sketch-draw').getAttribute('aria-pressed') === 'true'"
    page.press("Escape")
    check(not page.run(drawing), "Escape does not end the drawing")
    page.run("document.getElementById('sketch-draw').click()")
    page.run("document.getElementById('map').scrollIntoView({block: 'center'})")
    for _ in range(2):
        page.click(*place_of(page, *shares[2]))
    check(count(page) == 3 and not page.run(drawing), f"a double click made {count(page) - 2} points; drawing goes on: {page.run(drawing)}")
    first = answered(page)
    check(first["word"] in ("GO", "MARGINAL", "NO-GO") and first["word"] in first["on_map"], f"{first['word']}; on the map: {first['on_map']}")
    drawn = page.run("return document.querySelector('#sketch-chart .loss').getAttribute('d')")
    page.click(*place_of(page, 0.5, 0.2))
    check(count(page) == 3 and page.run("return pilotage.state.tile") >= 0, "after drawing a click does not show a tile")
    page.press("Escape")  # closes the tile

    before = page.run(POINTS)
    drag(page, page.run(PLACE, before[1][1::-1]), place_of(page, 0.5, 0.8))
    moved = page.run(POINTS)
    check(moved[0] == before[0] and moved[2] == before[2] and moved[1] != before[1], f"a drag made {moved} of {before}")
    check(answered(page)["length_m"] > first["length_m"], "a longer line is not longer")
    check(page.run("return document.querySelector('#sketch-chart .loss').getAttribute('d')") != drawn, "the curve is not drawn anew")
    middle = page.run("""const b = document.querySelector('.sketch-middle').getBoundingClientRect(); return [b.x + b.width / 2, b.y + b.height / 2]""")
    drag(page, middle, (middle[0], middle[1] + 60))
    check(count(page) == 4, f"a leg that is dragged has {count(page) - 2} points inside")
    answered(page)

    page.run("document.querySelectorAll('.sketch-point')[1].focus()")
    at = page.run(POINTS)[1]
    page.press("Right")
    right = page.run(POINTS)[1]
    check(right[0] > at[0] and abs(right[1] - at[1]) < 1e-9, f"the right arrow moves {at} to {right}")
    check(page.run("return document.activeElement.classList.contains('sketch-point')"), "the focus is lost by a move")
    page.press("\ue017")  # Delete
    check(count(page) == 3, "Delete takes no point out")
    page.press("\ue016")  # Insert
    check(count(page) == 4, "Insert adds no point")
    for _ in range(3):
        page.run("document.getElementById('sketch-undo').click()")
    undone = page.run(POINTS)
    check(len(undone) == 4 and undone[1] == at, f"three steps back is {undone}, not {at}")
    page.run("document.activeElement.blur()")
    page.run("""document.dispatchEvent(new KeyboardEvent('keydown', { key: 'z', ctrlKey: true }))""")
    check(page.run(POINTS) == moved, "Ctrl+Z does not take the new point back")
    page.run("document.getElementById('sketch-clear').click()")
    check(count(page) == 0 and page.run("return document.getElementById('sketch-verdict').hidden"), "Clear leaves something")
    page.run("document.querySelector('.sketch-bar button').click(); document.getElementById('map').focus()")
    page.press("Enter")
    page.press("Right", "Right", "Enter")
    check(count(page) == 2, f"by keyboard {count(page)} points are set, not two")
    page.press("Escape")
    for _ in range(3):
        page.run("document.getElementById('sketch-undo').click()")
    check(page.run(POINTS) == moved, "Clear cannot be undone")
    said = answered(page)
    page.run("const limit = document.getElementById('sketch-limit'); limit.value = '-3'; limit.dispatchEvent(new Event('input'))")
    page.wait("return document.getElementById('sketch-state').textContent.includes('outside')", "a refusal of -3 m")
    check(page.run("return document.getElementById('sketch-verdict').hidden"), "-3 m has an answer")
    page.run("const limit = document.getElementById('sketch-limit'); limit.value = '50'; limit.dispatchEvent(new Event('input'))")
    check(answered(page) == said, "the same sketch has another answer")
    check("15 m/s (default), a try every 2 s" in said["assumes"], f"assumed is {said['assumes']}")
    # On paper is the survey, not the sketch.
    page.devtools("Emulation.setEmulatedMedia", media="print")
    check(not page.run("return document.getElementById('sketch').offsetParent"), "the sketch is on paper")
    check(not page.run("return document.querySelector('.sketch-on-map').offsetParent"), "its verdict is on the printed map")
    page.devtools("Emulation.setEmulatedMedia", media="")


def files_say_the_same(page, pilotage, folder):
    """Each format, read by the program: the same places, heights above ground and speeds."""
    page.run("document.getElementById('sketch-speed').value = ''")
    points = [[lng, lat, agl, speed] for (lng, lat, agl, _), speed in zip(page.run(POINTS), (15, 12.5, 20))]
    page.run(FILL, {"limit": 50}, points)
    answered(page)
    for kind in ("plan", "waypoints", "kml", "geojson"):
        options = {"kml": ["--speed-mps", "15"], "geojson": ["--speed-mps", "15", "--agl-m", f"{points[0][2]}"]}.get(kind, [])
        told = json.loads(run(pilotage, "inspect", saved(page, kind, folder), "--json", *options, streams="stdout"))
        vertices = told["vertices"]
        check(len(vertices) == len(points), f"{kind}: {len(vertices)} points, drawn were {len(points)}")
        for vertex, (lng, lat, agl, speed) in zip(vertices, points):
            check(abs(vertex["lon_deg"] - lng) < 2e-8 and abs(vertex["lat_deg"] - lat) < 2e-8, f"{kind}: {vertex}, drawn was {lng}, {lat}")
            check(abs(vertex["agl_m"] - agl) < 1e-6, f"{kind}: {vertex}, {agl} m above ground")
            if kind in ("plan", "waypoints") and vertex is not vertices[0]:
                check(vertex["speed_mps"] == speed, f"{kind}: {vertex}, {speed} m/s")


def dropped(page, name, content):
    """What the page says of a file that is dropped on the map, a sentence each."""
    page.run("""const [name, bytes] = arguments; document.getElementById('sketch-notes').replaceChildren();
      const data = new DataTransfer(); data.items.add(new File([new Uint8Array(bytes)], name));
      document.getElementById('map').dispatchEvent(new DragEvent('drop', { dataTransfer: data, bubbles: true, cancelable: true }))""", name, list(content))
    page.wait("return document.getElementById('sketch-notes').children.length", f"what {name} is")
    return page.run("return [...document.querySelectorAll('#sketch-notes li')].map((item) => item.textContent)")


DJI = """<?xml version="1.0" encoding="UTF-8"?><kml xmlns="http://www.opengis.net/kml/2.2" xmlns:wpml="http://www.dji.com/wpmz/1.0.2"><Document>
<Folder><wpml:executeHeightMode>relativeToStartPoint</wpml:executeHeightMode><wpml:autoFlightSpeed>7</wpml:autoFlightSpeed>{marks}</Folder></Document></kml>"""


def files_come_back(page, pilotage, source, folder):
    """What was saved, opened again; other formats; and what cannot be read."""
    before = page.run(POINTS)
    for kind in ("plan", "waypoints", "kml", "geojson"):
        page.run("document.getElementById('sketch-clear').click()")
        file = next(file for file in folder.glob("sketch_*") if file.suffix == ENDINGS[kind])
        notes = dropped(page, file.name, file.read_bytes())
        check(notes[0] == f"{file.name}: {len(before)} points", f"{kind}: {notes}")
        for was, now in zip(before, page.run(POINTS)):
            check(abs(was[0] - now[0]) < 2e-8 and abs(was[1] - now[1]) < 2e-8, f"{kind}: {now}, saved was {was}")
            check(kind not in ("plan", "waypoints") or was is before[0] or was[3] == now[3], f"{kind}: {now[3]} m/s, saved were {was[3]}")
    # The sample's mission: takeoff from home and the return to it, as the program reads them.
    plan = source / "maps/sample/route.plan"
    dropped(page, "route.plan", plan.read_bytes())
    vertices = json.loads(run(pilotage, "inspect", plan, "--json", streams="stdout"))["vertices"]
    read = page.run(POINTS)
    check(len(read) == len(vertices), f"route.plan: {len(read)} points, the program has {len(vertices)}")
    for point, vertex in zip(read, vertices):
        check(abs(point[0] - vertex["lon_deg"]) < 1e-9 and abs(point[1] - vertex["lat_deg"]) < 1e-9, f"route.plan: {point}, by the program {vertex}")
        check(vertex is vertices[0] or point[3] == vertex["speed_mps"], f"route.plan: {point[3]} m/s, by the program {vertex['speed_mps']}")
    marks = "".join(f"<Placemark><Point><coordinates>{lng},{lat}</coordinates></Point><wpml:index>{i}</wpml:index><wpml:executeHeight>80</wpml:executeHeight>"
                    f"{'<wpml:waypointSpeed>9</wpml:waypointSpeed>' if i else ''}</Placemark>" for i, (lng, lat, _, _) in enumerate(before))
    with zipfile.ZipFile(folder / "dji.kmz", "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("wpmz/template.kml", "<kml/>")
        archive.writestr("wpmz/waylines.wpml", DJI.format(marks=marks))
    litchi = "latitude,longitude,altitude(m),curvesize(m),speed(m/s)\n" + "".join(f"{lat},{lng},80,5,9\n" for lng, lat, _, _ in before)
    gpx = '<gpx xmlns="http://www.topografix.com/GPX/1/1"><trk><trkseg>' + "".join(
        f'<trkpt lat="{before[0][1] + 1e-6 * k}" lon="{before[0][0] + 2e-5 * (k % 7)}"/>' for k in range(900)) + "</trkseg></trk></gpx>"
    for name, content, count_, speed in (("dji.kmz", (folder / "dji.kmz").read_bytes(), 3, 9), ("litchi.csv", litchi.encode(), 3, 9), ("track.gpx", gpx.encode(), None, None)):
        notes = dropped(page, name, content)
        read = page.run(POINTS)
        check(len(read) == count_ if count_ else 2 <= len(read) <= 200, f"{name}: {len(read)} points; {notes}")
        check(speed is None or read[-1][3] == speed, f"{name}: {read[-1]}")
        check(name != "track.gpx" or any("thinned from 900 points" in note for note in notes), f"{name}: {notes}")
        check(any("165 m above ground" in note for note in notes) or page.run("return pilotage.sketchData.agl_m") != 165, f"{name}: {notes}")
    read = page.run(POINTS)
    for name, content, said in (("no.plan", b'{"fileType": "Plan"', "no JSON"), ("empty.geojson", b'{"type": "Point", "coordinates": [1, 2]}', "no line"),
                                ("cut.kmz", (folder / "dji.kmz").read_bytes()[:200], "archive"), ("bad.gpx", b"<gpx><trk>", "XML"),
                                ("table.csv", b"a,b\n1,2\n", "latitude"), ("patterns.plan", json.dumps({"fileType": "Plan", "version": 1, "mission": {
                                    "version": 2, "items": [{"type": "ComplexItem", "complexItemType": "survey"}]}}).encode(), "fewer than two")):
        notes = dropped(page, name, content)
        check(len(notes) == 1 and notes[0].startswith(f"{name} cannot be read") and said in notes[0], f"{name}: {notes}")
        check(page.run(POINTS) == read, f"{name} changed the sketch")
    page.run("document.getElementById('sketch-file').focus()")
    check(page.run("return document.activeElement.id") == "sketch-file", "files cannot be opened by keyboard")


def agrees_with_prepare(page, pilotage, work, draws, number):
    """P of drawn sketches, and of `prepare` on the mission that the page saves; how far apart they are."""
    edges = page.run("""const e = pilotage.display.edges_m; return [pilotage.toLatLng(e[0], e[1]), pilotage.toLatLng(e[2], e[3])]""")
    agl_m = page.run("return pilotage.sketchData.agl_m")
    apart = []
    for index in range(number):
        def inside(name):
            low, high = edges[0][name], edges[1][name]
            return draws.uniform(low + 0.06 * (high - low), high - 0.06 * (high - low))
        speed = draws.choice([10, 15, 20, 25])
        points = [[inside("lng"), inside("lat"), agl_m, speed] for _ in range(draws.randint(2, 6))]
        limit_m = draws.choice([30, 40, 50, 60])
        page.run(FILL, {"limit": limit_m, "ins": str(draws.choice([1, 2, 3])), "speed": speed}, points)
        told = answered(page)
        what = f"sketch {index} ({len(points)} points, limit {limit_m} m, {speed} m/s)"
        folder = work / f"sketch{index}"
        folder.mkdir()
        plan, file = saved(page, "plan", folder), saved(page, "mission", folder)
        mission = json.loads(file.read_text(encoding="utf-8"))
        check(mission["max_error_m"] == limit_m and mission["route"] == plan.name, f"the mission is {mission}")
        check(f"pilotage prepare {file.name} " in page.run("return document.getElementById('sketch-commands').textContent"), "the command names another file")
        mission.update({"flights": 0, "outputs": ["json"]})
        file.write_text(json.dumps(mission), encoding="utf-8")
        uncovered = "--allow-uncovered"  # the page says so where a line leaves its tiles
        said = uncovered in page.run("return document.getElementById('sketch-commands').textContent")
        check(said == (told["unknown_m"] > 0), f"{what}: {uncovered} said {said}, {told['unknown_m']} m lie outside")
        run(pilotage, "prepare", file.name, *([uncovered] if said else []), "-q", "-o", "out", cwd=folder)
        report = json.loads((folder / "out/report.json").read_text(encoding="utf-8"))
        p = report["route"]["probability"]["p_within_limit"]
        apart.append(abs(told["p"] - p))
        print(f"{what}: page {told['p']:.4f}, prepare {p:.4f}, {report['route']['length_m'] / 1000:.2f} km, outside {told['unknown_m']:.0f} m", flush=True)
        check(abs(told["length_m"] - report["route"]["length_m"]) <= 1e-5 * told["length_m"], f"{what}: {told['length_m']} m long")
        check(apart[-1] <= AGREES, f"{what}: P {told['p']} on the page, {p} by prepare")
    return apart


def planned_route_is_the_reports(page, out):
    """The report's own route, sketched: the report's numbers."""
    report = json.loads((out / "report.json").read_text(encoding="utf-8"))
    page.open(out / "report.html")
    page.run("document.getElementById('sketch-planned').click()")
    told = answered(page)
    check(abs(told["p"] - report["route"]["probability"]["p_within_limit"]) < 1e-3, f"P {told['p']}, the report has {report['route']['probability']}")
    check(abs(told["largest_error_m"] - report["route"]["largest_error_m"]) < 1e-2, f"{told['largest_error_m']} m, not {report['route']['largest_error_m']}")
    check(abs(told["length_m"] - report["route"]["length_m"]) < 0.05, f"{told['length_m']} m long, not {report['route']['length_m']}")
    check(told["assumes"].startswith(report["verdict"]["assumptions"]) and "18 m/s, a try every 2 s" in told["assumes"], f"assumed is {told['assumes']}, by the report {report['verdict']['assumptions']}")


def lost_flights_have_cures(page):
    """The sample's NO-GO: the stretch is on map and chart, and each cure leads to its answer."""
    check(page.run("return pilotage.map.hasLayer(pilotage.layers.lost)") and page.run("return document.querySelectorAll('#chart .lost').length") == 1,
          "where flights are lost is not shown")
    cures = page.run("return [...document.querySelectorAll('.cures li')].map((item) => item.textContent)")
    check([cure.split(":")[0] for cure in cures] == ["Another line", "A better inertial system", "A second date of this ground"], f"cures: {cures}")
    page.run("document.querySelector('#cure-ins button').click()")
    page.wait("return pilotage.whatIf.predicted !== null && document.getElementById('what-if-state').textContent === ''", "P with a better system")
    planned = page.run("return pilotage.report.route.probability.p_within_limit")
    check(page.run("return pilotage.whatIf.predicted.probability.p_within_limit") > planned, "a better inertial system does not help")
    page.run("document.getElementById('sketch-clear').click(); document.getElementById('cure-line').click()")
    check(count(page) == len(page.run("return pilotage.sketchData.points")), "another line does not begin at the planned one")
    answered(page)


def unknown_ground_has_no_verdict(page):
    """On a report's page, which knows its corridor: beside it P is a bound, and no NO-GO (a planner was told one at P 0.1 where prepare found 0.82)."""
    points = page.run(POINTS)
    points[4][0] += 0.002
    points[4][1] += 0.0025
    page.run(FILL, {"limit": 60}, points)
    told = answered(page)
    check(told["unknown_m"] > 500 and told["word"] == "NOT KNOWN" and "NOT KNOWN" in told["on_map"], f"{told}")
    check(told["answer"].startswith("P is at least 0.") and "NO-GO" not in told["answer"], told["answer"])
    check("--allow-uncovered" in page.run("return document.getElementById('sketch-commands').textContent"), "prepare would refuse the line")


def begins_on_one_screen(page, path, pictures):
    """On a phone: headline and map on the first screen, the page at most six screens long until something is unfolded, nothing lost on paper."""
    page.resize(390, 844)
    page.open(path)
    bottom, height = page.run("return [document.getElementById('map').getBoundingClientRect().bottom, document.documentElement.scrollHeight]")
    check(bottom <= 844 and height <= 6 * 844, f"{path.name}: the map ends at {bottom} px, the page at {height} px")
    fits_width(page, f"{path.name} on a phone")
    page.full_screenshot(pictures / f"{path.stem}_phone_folded.png")
    design_holds(page, f"{path.name} on a phone")
    shown = """return [...document.querySelectorAll('main > section')].filter((section) => section.offsetParent && section.querySelector('.fold'))
      .map((section) => [section.querySelector('h2').textContent.trim(), section.querySelector('.fold').getAttribute('aria-expanded'), section.offsetHeight])"""
    folded = {name: height for name, expanded, height in page.run(shown) if expanded == "false"}
    check("Inputs" in folded and "Warnings" not in folded, f"{path.name}: folded are {list(folded)}")
    page.run("[...document.querySelectorAll('.fold[aria-expanded=\"false\"]')].forEach((button) => button.click())")
    check(all(expanded == "true" and height > folded.get(name, 0) for name, expanded, height in page.run(shown)), f"{path.name}: {page.run(shown)}")
    page.run("[...document.querySelectorAll('h2 .fold')].forEach((button) => button.click())")
    page.devtools("Emulation.setEmulatedMedia", media="print")
    hidden = page.run("""return [...document.querySelectorAll('main > section:not(#sketch, #what-if)')].filter((section) =>
      [...section.children].every((child) => child.matches('h2') || !child.offsetParent)).map((section) => section.textContent.trim().slice(0, 30))""")
    check(not hidden, f"{path.name}: folded on paper: {hidden}")
    page.devtools("Emulation.setEmulatedMedia", media="")
    page.resize(1440, 900)
    page.open(path)
    design_holds(page, f"{path.name} on a desktop")
    page.resize(1400, 1000)


def test(pilotage, source, work, rest):
    need_sample(source)
    pictures = pathlib.Path(rest[0])
    pictures.mkdir(parents=True, exist_ok=True)
    number = int(rest[1]) if len(rest) > 1 else 3
    surveys = [pathlib.Path(folder).resolve() for folder in rest[2:]]
    sample = source / "maps/sample"
    if not surveys:
        run(pilotage, "survey", sample / "ortho.tif", "--camera", sample / "camera.yaml", "--agl-m", "165", "--elevation", sample / "elevation.tif",
            "-q", "-o", work / "survey")
        surveys = [work / "survey"]
        run(pilotage, "prepare", sample / "mission.json", "-q", "--flights", "0", "--outputs", "html,json", "-o", work / "prepared")
    draws = random.Random(1)
    with Browser() as page:
        for survey in surveys:
            page.open(survey / "survey.html")
            page.run(KEEP_SAVED)
            drawn_by_hand(page)
            page.screenshot(pictures / "sketch.png")
            page.full_screenshot(pictures / "sketch_page.png")
            sketches = work / survey.name
            sketches.mkdir(exist_ok=True)
            files_say_the_same(page, pilotage, sketches)
            files_come_back(page, pilotage, source, sketches)
            apart = agrees_with_prepare(page, pilotage, sketches, draws, number)
            print(f"{survey.name}: P differs by {sum(apart) / len(apart):.4f} in the mean, {max(apart):.4f} at most")
            page.resize(390, 844)
            fits_width(page, "a sketch on a phone")
            page.full_screenshot(pictures / "sketch_phone.png")
            page.resize(1400, 1000)
        if not rest[2:]:
            begins_on_one_screen(page, surveys[0] / "survey.html", pictures)
            begins_on_one_screen(page, work / "prepared/report.html", pictures)
            planned_route_is_the_reports(page, work / "prepared")
            lost_flights_have_cures(page)
            unknown_ground_has_no_verdict(page)
        said = page.console()
        check(not said, f"the console has: {said}")


main(test)
