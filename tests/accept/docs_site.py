"""The site of the documentation: every link of every page leads to a file of it, nothing is fetched, and its search finds.

docs_site.py SOURCE_FOLDER VERSION FOLDER_OF_WRITTEN_HEADERS"""

import html.parser
import pathlib
import shutil
import subprocess
import sys
import tempfile
import urllib.parse

SKIP = 77


class Links(html.parser.HTMLParser):
    def __init__(self):
        super().__init__()
        self.targets, self.anchors = [], set()

    def handle_starttag(self, tag, attributes):
        for name, value in attributes:
            if name in ("href", "src") and value and tag != "base":
                self.targets.append((tag, value))
            if name in ("id", "name") and value:
                self.anchors.add(value)


def links_of(page):
    links = Links()
    links.feed(page.read_text(encoding="utf-8", errors="replace"))
    return links


def check_links(site):
    """Returns what is wrong, and how many links there are."""
    pages = {page.resolve(): links_of(page) for page in site.rglob("*.html")}
    problems, count = [], 0
    for page, links in pages.items():
        for tag, target in links.targets:
            parts = urllib.parse.urlsplit(target)
            if parts.scheme == "javascript":
                continue
            if parts.scheme or target.startswith("//"):
                if tag not in ("a", "link") or (tag == "link" and parts.scheme in ("http", "https")):
                    problems.append(f"{page.relative_to(site)}: fetches {target}")
                continue
            count += 1
            file = (page.parent / urllib.parse.unquote(parts.path)).resolve() if parts.path else page
            if not file.exists():
                problems.append(f"{page.relative_to(site)}: {target} leads nowhere")
            elif parts.fragment and file in pages and "api" not in file.parts and urllib.parse.unquote(parts.fragment) not in pages[file].anchors:
                problems.append(f"{page.relative_to(site)}: {target}: no such place on the page")
    return problems, count


def search(site, words):
    """What a browser shows of the search, from files alone."""
    browser = shutil.which("chromium")
    if browser is None:
        print("skipped in part: chromium is not installed, the search is not tried")
        return None
    with tempfile.TemporaryDirectory() as home:
        address = (site / "search.html").as_uri() + "?q=" + urllib.parse.quote(words)
        return subprocess.run([browser, "--headless", "--no-sandbox", "--disable-gpu", f"--user-data-dir={home}", "--virtual-time-budget=15000",
                               "--dump-dom", address], capture_output=True, text=True, check=False, timeout=120).stdout


def main():
    source, version = pathlib.Path(sys.argv[1]).resolve(), sys.argv[2]
    with tempfile.TemporaryDirectory() as folder:
        build = pathlib.Path(folder).resolve()
        told = []
        shutil.copytree(sys.argv[3], build / "include")  # written headers
        for script in ("ApiDocs", "DocsSite"):
            done = subprocess.run(["cmake", f"-DSOURCE={source}", f"-DBUILD={build}", f"-DVERSION={version}", "-P", source / f"cmake/{script}.cmake"],
                                  capture_output=True, text=True, check=False)
            told.append(done.stdout + done.stderr)
            if "skipped: " in told[-1]:
                print(told[-1])
                sys.exit(SKIP)
            assert done.returncode == 0, told[-1]
        site = build / "site"
        problems, count = check_links(site)
        assert not problems, "\n".join(problems[:40]) + f"\n{len(problems)} of {count} links"
        assert count > 5000, f"only {count} links"
        found = search(site, "uniqueness of the correlation surface")
        assert found is None or "docs/methods/uniqueness" in found, "the search finds nothing: " + found[-2000:]
        pages = len(list(site.rglob("*.html")))
        print(f"{pages} pages, {count} links")


main()
