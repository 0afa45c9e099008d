# Configuration of Sphinx for the pages of the project (cmake/DocsSite.cmake): all Markdown of the repository as one site that needs no network.
import pathlib
import re

source = pathlib.Path(__file__).resolve().parents[2]
project = "Pilotage"
author = "Pilotage developers"
copyright = "Pilotage developers, Apache-2.0"
release = re.search(r"^project\(pilotage VERSION ([0-9.]+)", (source / "CMakeLists.txt").read_text(encoding="utf-8"), re.MULTILINE)[1]

extensions = ["myst_parser"]
root_doc = "docs/site/index"
include_patterns = ["*.md", "docs/**", "schemas/**", "maps/**", "studies/*.md", "tools/slurm/*.md", "tests/cli/cases/*.md"]
myst_heading_anchors = 5
highlight_language = "none"
suppress_warnings = ["misc.highlighting_failure"]  # of code with an ellipsis in it
html_theme = "alabaster"
html_theme_options = {"page_width": "1100px", "sidebar_width": "240px", "description": "Reference maps for aircraft without GNSS"}
html_show_sourcelink = False
html_copy_source = False
html_show_sphinx = False
html_extra_path = ["start"]
html_static_path = ["static"]
templates_path = ["templates"]
html_css_files = ["site.css"]
