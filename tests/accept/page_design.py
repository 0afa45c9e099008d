"""What all pages have in common: at most six sizes of text and three weights, and no more than twelve controls in sight."""

from acceptance import check

# Letters of charts scale with the chart, and those of the zoom buttons are signs.
LETTERS = """const sizes = new Map(), weights = new Map();
const walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
for (let node = walker.nextNode(); node; node = walker.nextNode()) {
  const at = node.parentElement;
  if (!node.textContent.trim() || !at.getClientRects().length || at.closest('svg, script, style, option, .leaflet-control-zoom')) continue;
  const style = getComputedStyle(at);
  const said = at.tagName + ' ' + node.textContent.trim().slice(0, 30);
  if (!sizes.has(style.fontSize)) sizes.set(style.fontSize, said);
  if (!weights.has(style.fontWeight)) weights.set(style.fontWeight, said);
}
return [[...sizes], [...weights]]"""

CONTROLS = """return [...document.querySelectorAll('button, input, select, summary, a[href]')].filter((node) => {
  const box = node.getBoundingClientRect();
  return box.width > 1 && box.height > 1 && box.bottom > 0 && box.top < window.innerHeight && box.right > 0 && getComputedStyle(node).visibility === 'visible' &&
    !node.matches('h2 .fold');
}).map((node) => node.id || node.getAttribute('aria-label') || node.title || node.textContent.trim())"""


def design_holds(page, what):
    """On the page that is open, at its first screen."""
    page.run("window.scrollTo(0, 0)")
    sizes, weights = page.run(LETTERS)
    check(1 < len(sizes) <= 6, f"{what}: {len(sizes)} sizes of text: {sizes}")
    check(1 < len(weights) <= 3, f"{what}: {len(weights)} weights of text: {weights}")
    controls = page.run(CONTROLS)
    check(0 < len(controls) <= 12, f"{what}: {len(controls)} controls in sight: {controls}")


# Of what does not scroll in a box of its own.
BEYOND = """return [...document.querySelectorAll('body *')].filter((node) => !node.closest('.scroll:has(table:not(.cards)), #map, details:not([open])')).map((node) =>
  [node.tagName + '#' + node.id + '.' + (node.getAttribute('class') || ''), Math.round(node.getBoundingClientRect().right),
   node.textContent.trim().slice(0, 40)]).filter((row) => row[1] > window.innerWidth).slice(0, 12)"""
SPACED = """const name = 'spaced-letters', style = document.getElementById(name) || document.head.appendChild(Object.assign(document.createElement('style'), {id: name}));
style.textContent = arguments[0]"""


def fits_width(page, what):
    """Nothing lies beyond the window's right side, nor with letters and words spaced as WCAG 2.1 (1.4.12) asks, which other fonts need, too."""
    for spaced in ("", "* { letter-spacing: .12em; word-spacing: .16em; }"):
        page.run(SPACED, spaced)
        width, window = page.run("return [document.documentElement.scrollWidth, window.innerWidth]")
        check(width <= window, f"{what}{', spaced' if spaced else ''}: the page is {width} px wide, the window {window} px; beyond it: {page.run(BEYOND)}")
    page.run(SPACED, "")
