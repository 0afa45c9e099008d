"""The pages of a mission, an area and a line that was sought under axe-core, which looks for contrast too low to read and controls without a name.

report_contrast.py PILOTAGE SOURCE_FOLDER WRITE_REPORT_SCENE FOLDER

axe-core comes from the npm registry into FOLDER, by tests/accept/axe/package-lock.json; without it the test is skipped."""

import pathlib
import shutil
import subprocess
import sys

from acceptance import SKIP, check, main, run
from browser import Browser, missing_programs


def axe_source(source, folder):
    """The text of axe-core; leaves with "skipped" when it cannot be got."""
    wanted = (source / "tests/accept/axe/package-lock.json").read_text(encoding="utf-8")
    folder.mkdir(parents=True, exist_ok=True)
    script, lock = folder / "node_modules/axe-core/axe.min.js", folder / "package-lock.json"
    if not (script.exists() and lock.exists() and lock.read_text(encoding="utf-8") == wanted):
        if shutil.which("npm") is None:
            print("skipped: axe-core comes by npm, which is not installed: apt-get install npm")
            sys.exit(SKIP)
        for name in ("package.json", "package-lock.json"):
            shutil.copy(source / "tests/accept/axe" / name, folder / name)
        try:
            done = subprocess.run(["npm", "ci", "--ignore-scripts", "--no-audit", "--no-fund"], cwd=folder, text=True,
                                  stdout=subprocess.PIPE, stderr=subprocess.STDOUT, check=False, timeout=240)
        except subprocess.TimeoutExpired:
            print("skipped: axe-core comes by npm, whose registry does not answer: try again with a network")
            sys.exit(SKIP)
        if done.returncode != 0:
            print(done.stdout[-1000:])
            print("skipped: axe-core could not be got by npm; what npm says is in the test's output")
            sys.exit(SKIP)
    return script.read_text(encoding="utf-8")


AXE = """return axe.run(document, {resultTypes: ['violations'], rules: {'color-contrast-enhanced': {enabled: arguments[0]}}})
  .then((result) => ({checked: result.passes.length, violations: result.violations.map((violation) => violation.id + ': ' + violation.help + ': ' +
    violation.nodes.map((node) => node.target.join(' ') + ' ' + (node.any[0] ? node.any[0].message : '')).slice(0, 4).join('; '))}))"""


# What this page has nothing to fill with: its letters and colours are looked at all the same.
REVEAL = """for (const name of ['seen', 'what-if', 'what-if-verdict', 'what-if-on-chart', 'sketch', 'sketch-planned', 'sketch-verdict', 'sketch-mission']) document.getElementById(name).hidden = false;
for (const name of ['seen-frame-text', 'seen-found', 'seen-note', 'what-if-changes', 'what-if-answer', 'what-if-detail', 'what-if-state',
  'what-if-chart-words', 'sketch-notes', 'sketch-state', 'sketch-figures', 'sketch-answer', 'sketch-detail', 'sketch-assumes',
  'sketch-commands']) document.getElementById(name).textContent = 'Words to look at';
document.getElementById('what-if-word').textContent = 'What if: NO-GO'; document.getElementById('what-if-word').className = 'badge bad';
document.getElementById('sketch-word').textContent = 'MARGINAL'; document.getElementById('sketch-word').className = 'badge marginal';
document.getElementById('sketch-notes').replaceChildren(Object.assign(document.createElement('li'), {textContent: 'Words to look at'}));
document.getElementById('sketch-chart').setAttribute('aria-label', 'A curve')"""


def choose(page, theme):
    page.run("const t = document.getElementById('theme'); t.value = arguments[0]; t.dispatchEvent(new Event('change'))", theme)


def judge(page, what, enhanced=False):
    result = page.run(AXE, enhanced)
    check(result["checked"] >= 10, f"{what}: axe-core checked {result['checked']} rules only")
    check(not result["violations"], f"{what}:\n" + "\n".join(result["violations"]))


def judge_themes(page, what):
    for theme in ("light", "dark"):
        choose(page, theme)
        judge(page, f"{what}, {theme}")
    choose(page, "sun")
    judge(page, f"{what}, sunlight", enhanced=True)  # 7 : 1
    choose(page, "light")


def other_pages(page, pilotage, source, work, axe):
    """Of `survey` and `reroute`, on a crop of the sample, as they open and on a phone."""
    if shutil.which("gdal_translate") is None or not (source / "maps/sample/ortho.tif").exists():
        print("the pages of survey and reroute were not looked at: they need the sample's imagery and gdal_translate")
        return
    run("sh", source / "tests/data/small_mission/make", cwd=work)
    run(pilotage, "survey", "ortho.tif", "--camera-hfov-deg", "60", "--camera-width-px", "640", "--camera-height-px", "480", "--agl-m", "60", "-q",
        "-o", "area", cwd=work)
    run(pilotage, "reroute", "mission.json", "--max-error-m", "25", "-q", "-o", "better.plan", cwd=work)
    for name in ("area/survey.html", "better.html"):
        page.resize(1440, 900)
        page.open(work / name)
        page.run(axe + "\nwindow.axe = axe;")
        page.run("document.querySelectorAll('details').forEach((node) => { node.open = true; })")
        judge_themes(page, name)
        page.resize(390, 844)
        judge(page, f"{name} on a phone")


def test(pilotage, source, work, rest):
    if missing_programs():
        print(f"skipped: {missing_programs()} not installed: apt-get install chromium chromium-driver")
        sys.exit(SKIP)
    axe = axe_source(source, pathlib.Path(rest[1]))
    run(rest[0], work, "no-go")
    with Browser() as page:
        page.open(work / "report.html")
        page.run(axe + "\nwindow.axe = axe;")
        page.run("document.querySelectorAll('details').forEach((node) => { node.open = true; }); document.getElementById('tile-next').click()")
        page.run(REVEAL)
        judge_themes(page, "report.html")
        page.resize(820, 1180)
        judge(page, "tablet")
        other_pages(page, pilotage, source, work, axe)
        # What axe-core finds must be found: a gray that cannot be read.
        page.run("document.querySelector('.answer').style.color = '#e0d0d8'")
        check(any("color-contrast" in text for text in page.run(AXE, False)["violations"]), "axe-core sees nothing")


main(test)
