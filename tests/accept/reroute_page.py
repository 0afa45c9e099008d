"""The page of `reroute` in a real browser: one design with the other pages, figures of the JSON beside it, no network.

reroute_page.py PILOTAGE SOURCE_FOLDER FOLDER_OF_SCREENSHOTS"""

import json
import pathlib
import sys

from acceptance import SKIP, check, main, need_gdal, need_sample, run
from browser import Browser, missing_programs
from page_design import asks_for_nothing, design_holds, fits_width

ROWS = """return Object.fromEntries([...document.querySelectorAll('#lines tr')].map((row) =>
  [row.cells[0].textContent, [...row.cells].slice(1).map((cell) => cell.textContent)]))"""


def test(pilotage, source, work, rest):
    need_sample(source)
    need_gdal()
    if missing_programs():
        print(f"the page was not looked at: {missing_programs()} not installed")
        sys.exit(SKIP)
    pictures = pathlib.Path(rest[0])
    pictures.mkdir(parents=True, exist_ok=True)
    run("sh", source / "tests/data/small_mission/make", cwd=work)
    run(pilotage, "reroute", "mission.json", "--max-error-m", "25", "-q", "-o", "better.plan", cwd=work)
    done = json.loads((work / "better.json").read_text(encoding="utf-8"))
    with Browser() as page:
        page.console()
        page.addresses()
        page.resize(1440, 900)
        page.open(work / "better.html")
        asks_for_nothing(page)
        check(page.run("return document.querySelector('.word').textContent") == done["new"]["verdict"], "another verdict than the file's")
        answer, planned, rest = (page.run("return document.querySelector(arguments[0]).textContent", name)
                                 for name in (".answer", "#planned", ".because-below .sentence"))
        new = done["new"]["verdict_text"].partition(": ")[2]
        check(f"{answer[:-1]}; {rest}".lower() == new.lower() and len(rest) > 20 and done["planned"]["verdict_text"] in planned, f"{answer}, {rest}, {planned}")
        length = page.run(ROWS)["Length"]
        wanted = [f"{done[line]['length_m'] / 1000:.2f} km" for line in ("planned", "new")]
        check(length[:2] == wanted, f"lengths are {length}, not {wanted}")
        map_px = page.run("const box = document.querySelector('svg.lines').getBoundingClientRect(); return [box.top, box.bottom]")
        check(map_px[0] < 450 and map_px[1] > 600, f"the map reaches from {map_px[0]} to {map_px[1]} px")
        design_holds(page, "reroute's page on a desktop")
        for scheme in ("light", "dark"):
            page.prefer(scheme)
            page.wait("return (document.documentElement.dataset.theme || 'light') === arguments[0]", f"a page that is {scheme}", scheme)
            page.full_screenshot(pictures / f"reroute_{scheme}.png")
        page.prefer("light")
        page.run("const theme = document.getElementById('theme'); theme.value = 'sun'; theme.dispatchEvent(new Event('change'))")
        check(page.run("return getComputedStyle(document.body).color") == "rgb(0, 0, 0)", "in sunlight letters are not black")
        page.full_screenshot(pictures / "reroute_sun.png")
        page.run("const theme = document.getElementById('theme'); theme.value = ''; theme.dispatchEvent(new Event('change'))")
        page.devtools("Emulation.setEmulatedMedia", media="print")
        page.full_screenshot(pictures / "reroute_paper.png")
        check(page.run("return document.querySelector('.appearance').offsetParent") is None, "on paper there are controls")
        page.devtools("Emulation.setEmulatedMedia", media="")
        page.resize(390, 844)
        fits_width(page, "reroute's page on a phone")
        design_holds(page, "reroute's page on a phone")
        bottom = page.run("return document.querySelector('.lines').getBoundingClientRect().bottom")
        check(bottom <= 844, f"on a phone the map ends at {bottom} px")
        letters = page.run("return Math.min(...[...document.querySelectorAll('.lines text')].map((text) => text.getBoundingClientRect().height))")
        check(letters >= 11, f"letters of the map are {letters} px high")
        page.full_screenshot(pictures / "reroute_phone.png")
        run(pilotage, "reroute", "mission.json", "--max-error-m", "2", "-q", "-o", "none.plan", cwd=work, expect=3)
        check(not json.loads((work / "none.json").read_text(encoding="utf-8"))["found_go"], "a line keeps within 2 m")
        page.open(work / "none.html")
        check("No line was found that is GO" in page.run("return document.getElementById('planned').textContent"), "the page hides that no line is GO")
        said = page.console()
        check(not said, f"the console has: {said}")


main(test)
