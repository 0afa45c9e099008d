"""The page that `pilotage capture --quality` writes, in a real browser: its numbers held against --json, its pictures, both colour
schemes, a telephone's screen.

quality_page.py PILOTAGE SOURCE_FOLDER CUT_FLIGHT_FRAMES FOLDER_OF_SCREENSHOTS"""

import json
import pathlib
import sys

from acceptance import SKIP, check, main, need_gdal, need_sample, run
from browser import Browser, missing_programs
from page_design import asks_for_nothing, design_holds, fits_width

gdal = need_gdal()
COLOR_OF = """const image = document.querySelector(arguments[0]); const canvas = document.createElement('canvas'); canvas.width = image.naturalWidth;
canvas.height = image.naturalHeight; const context = canvas.getContext('2d'); context.drawImage(image, 0, 0); const found = new Set();
const data = context.getImageData(0, 0, canvas.width, canvas.height).data;
for (let i = 0; i < data.length; i += 4) found.add(data.slice(i, i + 3).join()); return [...found]"""


def page_says_the_same(page, done):
    shifts = page.run("return document.querySelector('section[aria-labelledby=alignment-heading] tbody').textContent")
    told = page.run("return document.querySelector('.verdict').textContent")
    sigma = done["map_sigma"]["median_m"]
    digits = 3 if sigma < 0.1 else 2 if sigma < 1 else 1
    check(f"± {sigma:.{digits}f} m" in told and f"each axis: {sigma:.{digits}f} m in the middle" in told, told)
    for assumption in done["assumptions"]:
        check(assumption[1:] in told, f"beside the headline is not said: {assumption}")
    rows = page.run("return [...document.querySelectorAll('#quality tr')].map((row) => row.textContent)")
    for said in (f"{len(done['frames'])} of {done['frames_given']}", f"{done['reprojection_rms_px']:.2f} px",
                 f"{int(100 * done['frames_seen']['by_three'] + 1e-9)} %; {done['frames_seen']['median']:.0f} frames",
                 f"another map ({done['alignment']['ties']} ties)", f"{done['ground_spread_m']:.2f} m from {done['ground']}"):
        check(any(said in row for row in rows), f"no row says {said}: {rows}")
    for said in (f"{done['alignment']['before']['median_shift_m'][0]:.2f} m", f"{done['alignment']['after']['shift_m']['quantile_95']:.2f} m"):
        check(said in shifts, f"the shifts do not say {said}")
    frames = page.run("return [...document.querySelectorAll('section[aria-labelledby=frames-heading] tbody tr')].map((row) => row.textContent)")
    check(len(frames) == len(done["frames"]), f"{len(frames)} frames")
    for row, frame in zip(frames, done["frames"]):
        check(frame["file"] in row and f"{frame['residual_east_m']:.2f} m" in row and f"{frame['agl_m']:.1f} m" in row, row)


def pictures_are_drawn(page, work):
    count = page.run("return [...document.images].filter((image) => image.complete && image.naturalWidth > 100).length")
    check(count == 5, f"{count} pictures, not frames, overlap, error, shifts before and after")
    colors = page.run(COLOR_OF, "img[alt=Overlap]")
    layers = gdal.Open(str(work / "map.map_sigma.tif"))  # bands live as long as it
    seen = layers.GetRasterBand(3).ReadAsArray()
    classes = {min(5, int(value)) for value in seen[seen == seen]}
    check(len(colors) == len(classes) + 1, f"{len(colors)} colours for {classes} and nothing")


def test(pilotage, source, work, rest):
    need_sample(source)
    pictures = pathlib.Path(rest[1])
    pictures.mkdir(parents=True, exist_ok=True)
    gdal.Translate(str(work / "part.tif"), str(source / "maps/sample/ortho.tif"), srcWin=[2400, 1500, 900, 700])
    run(rest[0], work / "part.tif", "--frames", "30", "--footprint-m", "150", "--prior-offset-m", "3", "--prior-sigma-m", "2", "-o", work / "block")
    told = run(pilotage, "capture", work / "block/frames.csv", "--camera-hfov-deg", "60", "--camera-width-px", "640", "--camera-height-px", "480",
               "--align", work / "part.tif", "--quality", work / "quality.html", "--json", "-q", "-o", work / "map.tif", streams="stdout")
    done = json.loads(told)
    if missing_programs():
        print(f"the page was not looked at: {missing_programs()} not installed")
        sys.exit(SKIP)
    with Browser() as page:
        page.console()
        page.addresses()
        page.open(work / "quality.html")
        asks_for_nothing(page)
        page_says_the_same(page, done)
        pictures_are_drawn(page, work)
        for scheme in ("light", "dark"):
            page.prefer(scheme)
            page.wait("return (document.documentElement.dataset.theme || 'light') === arguments[0]", f"a page that is {scheme}", scheme)
            page.full_screenshot(pictures / f"quality_{scheme}.png")
        page.prefer("light")
        design_holds(page, "quality.html on a desktop")
        page.resize(390, 844)
        fits_width(page, "quality.html on a phone")
        design_holds(page, "quality.html on a phone")
        page.full_screenshot(pictures / "quality_phone.png")
        said = page.console()
        check(not said, f"the console has: {said}")


main(test)
