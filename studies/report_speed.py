"""How fast the page of a long route is: 200 km, 5,208 tiles. Run by hand; judges nothing.

report_speed.py WRITE_REPORT_SCENE [HOW_MANY_TIMES_SLOWER]

Opening is the time until the second frame after the page's load event. Frames are those of 2 s of dragging the map."""

import pathlib
import sys
import tempfile

sys.path.append(str(pathlib.Path(__file__).resolve().parents[1] / "tests/accept"))  # helpers shared with the tests
from acceptance import run  # noqa: E402
from browser import Browser  # noqa: E402

OPENED = """return new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(() => done(performance.now()))))"""
RECORD = """window.frameTimes = []; const step = (now) => { window.frameTimes.push(now); if (!window.stopped) requestAnimationFrame(step); };
window.stopped = false; requestAnimationFrame(step)"""
FRAMES = "window.stopped = true; return window.frameTimes.slice(1).map((time, k) => time - window.frameTimes[k])"
TIMED = """const start = performance.now(); %s; return performance.now() - start"""
GO_TO = "pilotage.map.setView(pilotage.toLatLng(...pilotage.placeAlong(pilotage.report.route.length_m / 2)), arguments[0])"


def middle(values):
    return sorted(values)[len(values) // 2]


def drag(page):
    """Two seconds with the button held down over the middle of the map."""
    x, y = page.run("""const map = document.getElementById('map'); map.scrollIntoView({block: 'center'});
      const box = map.getBoundingClientRect(); return [box.left + box.width / 2, box.top + box.height / 2]""")
    moves = [{"type": "pointerMove", "duration": 500, "x": round(x + dx), "y": round(y + dy)}
             for dx, dy in ((-250, -120), (200, 100), (-150, 140), (0, 0))]
    page.run(RECORD)
    page.pointer([{"type": "pointerMove", "duration": 0, "x": round(x), "y": round(y)},
                  {"type": "pointerDown", "button": 0}, *moves, {"type": "pointerUp", "button": 0}])
    return page.run(FRAMES)


def main(write_report_scene, slower):
    with tempfile.TemporaryDirectory() as folder, Browser() as page:
        run(write_report_scene, folder, "very-long")
        path = pathlib.Path(folder) / "report.html"
        print(f"report.html: {path.stat().st_size / 1e6:.2f} MB")
        opened = []
        for _ in range(5):
            page.open("about:blank")
            page.devtools("Emulation.setCPUThrottlingRate", rate=slower)
            page.open(path)
            opened.append(page.run(OPENED))
        print(f"opened after {middle(opened):.0f} ms ({min(opened):.0f} … {max(opened):.0f})")
        for zoom in (None, 13, 16):
            if zoom is not None:
                page.run(GO_TO, zoom)
            frames = sorted(drag(page))
            print(f"dragging at zoom {page.run('return pilotage.map.getZoom()')}: {len(frames)} frames, median {middle(frames):.1f} ms, "
                  f"95 % within {frames[int(0.95 * len(frames))]:.1f} ms, longest {frames[-1]:.1f} ms")
        page.run("pilotage.map.fitBounds(pilotage.map.options.maxBounds)")
        measure = [page.run(TIMED % "const list = document.getElementById('measure'); list.selectedIndex = arguments[0]; "
                        "list.dispatchEvent(new Event('change'))", k % 7)
                   for k in range(1, 15)]
        print(f"another measure: {middle(measure):.1f} ms")
        threshold = [page.run(TIMED % """const slider = document.getElementById('threshold'); slider.value = arguments[0];
          slider.dispatchEvent(new Event('input'))""", 10 * k) for k in range(1, 20)]
        print(f"threshold moved: {middle(threshold):.1f} ms")


if __name__ == "__main__":
    main(sys.argv[1], float(sys.argv[2]) if len(sys.argv) > 2 else 1)
