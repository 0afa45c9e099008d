"""The what-if of report.html, held against the program: 24 settings of limit, inertial grade, speed and interval between tries,
each predicted by the page's script in a real browser and by `select` and `report` over the same tiles.

what_if.py PILOTAGE SOURCE_FOLDER FOLDER_OF_SCREENSHOTS"""

import json
import pathlib
import random
import re
import shutil
import sys

from acceptance import SKIP, check, main, run
from browser import Browser, missing_programs

if missing_programs():
    print(f"skipped: {missing_programs()} not installed: apt-get install chromium chromium-driver")
    sys.exit(SKIP)

GRADES = ["consumer", "industrial", "tactical", "navigation", "visual-odometry"]
ASK = """const [limit, ins, speed, interval] = arguments;
const fill = (name, value) => { document.getElementById('what-if-' + name).value = value; };
fill('limit', limit); fill('ins', ins); fill('speed', speed); fill('interval', interval);
pilotage.whatIf.predicted = null;
document.getElementById('what-if-form').requestSubmit()"""
ANSWERED = "return pilotage.whatIf.predicted !== null && document.getElementById('what-if-state').textContent === ''"
PREDICTED = """const p = pilotage.whatIf.predicted; const d = (what) => document.querySelector('#chart ' + what).getAttribute('d');
return {text: p.text, assumptions: p.assumptions, p: p.probability ? p.probability.p_within_limit : null,
  errors: p.profile.map((s) => [s.distance_m, s.error_m]), largest: p.largest_error_m,
  legs: p.legs.map((l) => [l.status, l.max_error_m, l.p_within_limit]),
  gaps: p.gaps.map((g) => [g.from_distance_m, g.to_distance_m, g.error_m, g.p_first_excess, g.status]),
  curve: d('.curve:not(.loss)'), loss: document.querySelector('#chart .loss') ? d('.loss') : null,
  legTypes: [...document.querySelectorAll('#chart .leg')].map((l) => l.getAttribute('class')),
  word: document.getElementById('what-if-word').textContent,
  shown: ['answer', 'detail', 'assumes'].map((name) => document.getElementById('what-if-' + name).textContent)}"""
STATUSES = ["good", "marginal", "bad"]


def near(a, b, share=2e-5):
    """report.json carries six digits."""
    if a is None or b is None:
        return a is b
    return abs(a - b) <= share * max(abs(a), abs(b)) + 1e-7


def points_of(path):
    return [(float(x), float(y)) for x, y in re.findall(r"[ML]([-\d.e]+) ([-\d.e]+)", path)]


def drawn_alike(first, second, what):
    """Two curves of the chart, in units of a pixel or so; they are rounded to 0.1."""
    first, second = points_of(first), points_of(second)
    check(len(first) == len(second), f"{what}: {len(first)} points drawn, the program draws {len(second)}")
    apart = max(max(abs(a[0] - b[0]), abs(a[1] - b[1])) for a, b in zip(first, second))
    check(apart < 0.11, f"{what}: drawn {apart} units apart")


def settings_of(draw, planned_grade):
    """One to four changes."""
    others = [grade for grade in GRADES if grade != planned_grade]
    setting = {"limit": None, "grade": None, "speed": None, "interval": None}
    for name in draw.sample(sorted(setting), draw.randint(1, 4)):
        setting[name] = {"limit": lambda: round(10 ** draw.uniform(1.1, 2.5), draw.randint(0, 1)), "grade": lambda: draw.choice(others),
                         "speed": lambda: round(draw.uniform(6, 45), 1),
                         "interval": lambda: round(10 ** draw.uniform(-0.3, 1.5), 2)}[name]()
    return setting


class Prepared:
    """A prepared mission whose plan can be flown with other settings over the same scores."""

    def __init__(self, pilotage, folder, out):
        self.pilotage, self.folder, self.out = pilotage, folder, folder / out
        self.plan = json.loads((self.out / "plan.json").read_text(encoding="utf-8"))
        self.asked = 0

    def predicted_by_the_program(self, setting, draw_page):
        """report.json, and the page where it is wanted, which takes longest; else nothing."""
        plan = json.loads(json.dumps(self.plan))
        if setting["grade"]:
            plan["ins"]["grade"] = setting["grade"]
        for sample in plan["route_samples"] if setting["speed"] else []:
            sample["speed_mps"] = setting["speed"]
        self.asked += 1
        name = f"{self.out.name}_asked{self.asked}"
        (self.folder / f"{name}_plan.json").write_text(json.dumps(plan), encoding="utf-8")
        options = [f"--max-error-m={setting['limit']}"] if setting["limit"] else []
        options += [f"--fix-interval-s={setting['interval']}"] if setting["interval"] else []
        options += ["--min-p-correct-fix", "0"] if self.folder.name == "crop" else []  # as the mission has it
        run(self.pilotage, "select", f"{name}_plan.json", "--table", self.out / "tiles.csv", "-o", f"{name}_selection.json", "-q",
            *options, cwd=self.folder)
        run(self.pilotage, "report", f"{name}_plan.json", "--table", self.out / "tiles.csv", "--selection", f"{name}_selection.json",
            "--outputs", "html,json" if draw_page else "json", "-o", f"{name}.html", "-q", cwd=self.folder)
        return (json.loads((self.folder / f"{name}.json").read_text(encoding="utf-8")),
                (self.folder / f"{name}.html").read_text(encoding="utf-8") if draw_page else None)

    def predicted_by_the_page(self, page, setting):
        planned = page.run("return pilotage.whatIf.planned")
        page.run(ASK, setting["limit"] or planned["limit_m"], str(1 + GRADES.index(setting["grade"]) if setting["grade"] else 0),
                 setting["speed"] or "", setting["interval"] or planned["interval_s"])
        page.wait(ANSWERED, f"the prediction of {setting}")
        return page.run(PREDICTED)


def same_prediction(setting, found, report, html):
    verdict = report["verdict"]
    check(found["text"] == verdict["text"], f"{setting}: the page says\n{found['text']}\nthe program\n{verdict['text']}")
    check(found["assumptions"] == verdict["assumptions"], f"{setting}: {found['assumptions']}, not {verdict['assumptions']}")
    check(found["word"] == "What if: " + verdict["text"].split(":")[0], f"{setting}: the badge says {found['word']}")
    check(found["shown"][2] == verdict["assumptions"] and found["shown"][1] in verdict["text"], f"{setting}: shown is {found['shown']}")
    route = report["route"]
    check(near(found["p"], route["probability"]["p_within_limit"] if route["probability"] else None), f"{setting}: P {found['p']}")
    check(near(found["largest"], route["largest_error_m"]), f"{setting}: largest error {found['largest']}")
    rows = route["error_profile"]["rows"]
    check(len(rows) == len(found["errors"]), f"{setting}: {len(found['errors'])} samples, not {len(rows)}")
    for row, (distance, error) in zip(rows, found["errors"]):
        check(near(row[0], distance) and near(row[1], error), f"{setting}: error {error} at {distance}, the program has {row}")
    for leg, (status, error, p) in zip(route["legs"], found["legs"]):
        check(leg["status"] == STATUSES[status] and near(leg["max_error_m"], error) and near(leg["p_within_limit"], p),
              f"{setting}: leg {leg['leg']}: {STATUSES[status]}, {error} m, P {p}, not {leg}")
    check([f"leg {leg['status']}" for leg in route["legs"]] == found["legTypes"], f"{setting}: legs are drawn {found['legTypes']}")
    check(len(route["gaps"]) == len(found["gaps"]), f"{setting}: {len(found['gaps'])} gaps")
    for gap, (begin, end, error, p, status) in zip(route["gaps"], found["gaps"]):
        same = near(gap["from_distance_m"], begin) and near(gap["to_distance_m"], end) and near(gap["error_m"], error)
        check(same and gap["status"] == STATUSES[status] and near(gap["p_first_excess"], p, 1e-4), f"{setting}: gap {begin} to {end} m: {gap}")
    if html is None:
        return
    drawn_alike(found["curve"], re.search(r'class="curve" d="([^"]+)"', html).group(1), f"{setting}: the error")
    if found["loss"]:
        drawn_alike(found["loss"], re.search(r'class="curve loss" d="([^"]+)"', html).group(1), f"{setting}: P by the place of loss")


def about_first(page, pilotage, sample):
    """A route so long that one would wait: the sample's, there and back and there again."""
    route = json.loads((sample / "route.plan").read_text(encoding="utf-8"))
    points = [item["params"][5:3:-1] for item in route["mission"]["items"] if item.get("command") in (16, 22) and item["params"][4]]
    line = points + points[-2::-1] + points[1:]
    (sample / "long.geojson").write_text(json.dumps({"type": "LineString", "coordinates": line}), encoding="utf-8")
    run(pilotage, "prepare", "mission.json", "--route", "long.geojson", "--agl-m", "120", "-q", "-o", "long", cwd=sample)
    page.open(sample / "long/report.html")
    page.run(ASK, 50, "0", "", 2)
    page.wait("return pilotage.whatIf.predicted !== null", "an answer at once")
    state, word, answer, p = page.run("""const p = pilotage.whatIf.predicted;
      return [...['state', 'word', 'answer'].map((name) => document.getElementById('what-if-' + name).textContent),
              p.about && p.probability.interval === null ? p.probability.p_within_limit : null]""")
    check("may be off by 0.15" in state, f"nothing says how good the first answer is: {state}")
    check(word.startswith("What if: about ") and answer.startswith("About: "), f"the first answer is not marked: {word}, {answer}")
    page.wait(ANSWERED, "the answer in full")
    full, word = page.run("return [pilotage.whatIf.predicted.probability, document.getElementById('what-if-word').textContent]")
    check(full["interval"] and "about" not in word, f"the answer in full is {full}, {word}")
    check(p is not None and abs(p - full["p_within_limit"]) <= 0.15, f"at once {p}, in full {full['p_within_limit']}")


def planned_stays(page, path):
    """What the report itself says while something is asked, on paper, and after a reset."""
    header = "return document.querySelector('.verdict').textContent + document.title"
    curve = "return document.querySelector('#chart .curve').getAttribute('d')"
    page.open(path)
    page.run("const along = document.getElementById('along'); along.value = 300; along.dispatchEvent(new Event('input'))")
    said, drawn = page.run(header), page.run(curve)
    page.run(ASK, 15, "1", "", 2)
    page.wait(ANSWERED, "a prediction")
    check(page.run(header) == said, "asking changes the report's verdict")
    asked = page.run(curve)
    check(asked != drawn, "the chart is not drawn anew")
    check(page.run("return document.getElementById('what-if-chart-words').textContent").startswith("What if: limit 15 m"), "the chart is not marked")
    check(page.run("return document.getElementById('along-text').textContent").startswith("What if: "), "the place on the chart is not marked")
    page.run("window.dispatchEvent(new Event('beforeprint'))")
    check(page.run(curve) == drawn and page.run("return document.getElementById('what-if-on-chart').hidden"), "what is asked is printed")
    page.run("window.dispatchEvent(new Event('afterprint'))")
    check(page.run(curve) == asked, "after printing the answer is gone")
    page.devtools("Emulation.setEmulatedMedia", media="print")
    check(not page.run("return document.getElementById('what-if').offsetParent"), "the settings are on paper")
    page.devtools("Emulation.setEmulatedMedia", media="")
    # By keyboard: from field to field, and a reset.
    page.run("document.getElementById('what-if-limit').focus()")
    order = []
    for _ in range(4):
        page.press("Tab")
        order.append(page.run("return document.activeElement.id || document.activeElement.className"))
    check(order == ["what-if-ins", "what-if-speed", "what-if-interval", "what-if-reset"], f"order of the focus: {order}")
    page.press("Enter")
    check(page.run(curve) == drawn and page.run(header) == said, "a reset does not bring the report back")
    check(page.run("return document.getElementById('what-if-verdict').hidden"), "the answer stays after a reset")
    page.run("const limit = document.getElementById('what-if-limit'); limit.value = '-3'; limit.dispatchEvent(new Event('input'))")
    page.wait("return document.getElementById('what-if-state').textContent.includes('outside')", "a refusal of -3 m")
    check(page.run("return document.getElementById('what-if-verdict').hidden"), "-3 m has an answer")
    page.run("document.querySelector('#what-if .what-if-reset').click()")


def nothing_where_nothing_is_known(page, prepared, work):
    """A selection that does not say when a flight tries to fix; numbers that are not those of the report."""
    selection = json.loads((prepared.out / "selection.json").read_text(encoding="utf-8"))
    kept = selection.pop("tries")
    for name, change in (("without", {}), ("other", {"tries": {"interval_s": 40 * kept["interval_s"]}})):
        (work / f"{name}.json").write_text(json.dumps({**selection, **change}), encoding="utf-8")
        run(prepared.pilotage, "report", prepared.out / "plan.json", "--table", prepared.out / "tiles.csv", "--selection", work / f"{name}.json",
            "-o", work / f"{name}.html", "-q", cwd=prepared.folder)
    page.open(work / "without.html")
    check(page.run("return document.getElementById('what-if').hidden"), "settings are offered that nothing can be predicted from")
    page.open(work / "other.html")
    page.run(ASK, 30, "0", "", 2)
    page.wait("return document.getElementById('what-if-state').textContent.startsWith('Not offered')", "a refusal")
    check(page.run("return document.getElementById('what-if-verdict').hidden"), "another prediction than the report's is shown")


def looks(page, path, folder):
    folder.mkdir(parents=True, exist_ok=True)
    for width, height, theme in ((1280, 900, "light"), (1280, 900, "dark"), (390, 844, "light"), (390, 844, "dark")):
        page.open(path)
        page.resize(width, height)
        page.run("const theme = document.getElementById('theme'); theme.value = arguments[0]; theme.dispatchEvent(new Event('change'))", theme)
        page.run(ASK, 35, "2", 22, 5)
        page.wait(ANSWERED, "a prediction")
        wide = page.run("return [document.documentElement.scrollWidth, window.innerWidth]")
        check(wide[0] <= wide[1], f"{width} px: the page is {wide[0]} px wide")
        small = page.run("""return [...document.querySelectorAll('#what-if input, #what-if select, .what-if-reset')]
          .filter((e) => e.offsetParent && e.getBoundingClientRect().height < 40).map((e) => e.id || e.className)""")
        check(width > 1000 or not small, f"{width} px: too low to touch: {small}")
        page.run("document.getElementById('chart-heading').scrollIntoView()")
        page.screenshot(folder / f"chart_{width}_{theme}.png")
        page.run("document.getElementById('what-if').scrollIntoView({block: 'center'})")
        page.screenshot(folder / f"answer_{width}_{theme}.png")
    page.resize(1400, 1000)


def test(pilotage, source, work, rest):
    if not (source / "maps/sample/ortho.tif").exists() or not shutil.which("gdal_translate"):
        print("skipped: the sample's imagery is not made (target sample_mission), or there is no gdal_translate")
        sys.exit(SKIP)
    pilotage = pilotage.resolve()
    crop = work / "crop"
    crop.mkdir()
    run("sh", source / "tests/data/small_mission/make", cwd=crop)
    run(pilotage, "prepare", "mission.json", "--denied", "0.1-0.25", "-q", "-o", "denied", cwd=crop)
    run(pilotage, "prepare", "mission.json", "--denied", "anywhere", "--ins-grade", "consumer", "--max-error-m", "25",
        "--second-epoch", source.resolve() / "maps/sample/ortho_second_epoch.tif", "-q", "-o", "anywhere", cwd=crop)
    sample = work / "sample"
    shutil.copytree(source / "maps/sample", sample, ignore=shutil.ignore_patterns("country", "out", "frames"))
    run(pilotage, "prepare", "mission.json", "-q", "-o", "out", cwd=sample)
    draw = random.Random("what_if")
    words = set()
    between = 0
    with Browser() as page:
        for prepared, count in ((Prepared(pilotage, sample, "out"), 14), (Prepared(pilotage, crop, "denied"), 5),
                                (Prepared(pilotage, crop, "anywhere"), 5)):
            page.open(prepared.out / "report.html")
            check(page.run("return !document.getElementById('what-if').hidden"), "no settings are offered")
            for number in range(count):
                setting = settings_of(draw, prepared.plan["ins"]["grade"])
                report, html = prepared.predicted_by_the_program(setting, draw_page=number % 5 == 0)
                same_prediction(setting, prepared.predicted_by_the_page(page, setting), report, html)
                words.add(report["verdict"]["text"].split(":")[0])
                between += 0.001 < report["route"]["probability"]["p_within_limit"] < 0.999
        check({"GO", "NO-GO"} <= words and between >= 5, f"the settings give {words}, {between} of them a P between 0 and 1")
        planned_stays(page, sample / "out/report.html")
        nothing_where_nothing_is_known(page, Prepared(pilotage, sample, "out"), work)
        about_first(page, pilotage, sample)
        looks(page, sample / "out/report.html", pathlib.Path(rest[0]))
        said = page.console()
        check(not said, f"the console has: {said}")
    print(f"24 settings: the page says what the program says ({', '.join(sorted(words))}; P between 0.001 and 0.999 in {between})")


main(test)
