"""What all pages have in common: six sizes of text and three weights, no more than twelve controls in sight, nothing beyond the window, no network."""

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
const root = getComputedStyle(document.documentElement), unit = parseFloat(root.fontSize);
const allowed = ['word', 'figure', 'heading', 'text', 'note', 'fine'].map((name) => parseFloat(root.getPropertyValue('--size-' + name)) * unit);
return {sizes: [...sizes].filter(([size]) => !allowed.some((one) => Math.abs(one - parseFloat(size)) < 0.01)), weights: [...weights].filter(([weight]) =>
  !['400', '600', '700'].includes(weight)), seen: sizes.size, allowed: allowed}"""

CONTROLS = """return [...document.querySelectorAll('button, input, select, summary, a[href]')].filter((node) => {
  const box = node.getBoundingClientRect();
  return box.width > 1 && box.height > 1 && box.bottom > 0 && box.top < window.innerHeight && box.right > 0 && getComputedStyle(node).visibility === 'visible' &&
    !node.disabled && !node.matches('h2 .fold');
}).map((node) => node.id || node.getAttribute('aria-label') || node.title || node.textContent.trim())"""


def asks_for_nothing(page):
    """Nothing but the page itself was asked for since addresses() was last called."""
    foreign = [address for address in page.addresses() if not address.startswith(("file:", "data:", "chrome:", "about:"))]
    check(not foreign, f"the page asks for {foreign}")


def design_holds(page, what):
    """On the page that is open, at its first screen."""
    page.run("window.scrollTo(0, 0)")
    letters = page.run(LETTERS)
    check(len(letters["allowed"]) == 6 and min(letters["allowed"]) > 9 and letters["seen"] > 2, f"{what}: {letters}")
    check(not letters["sizes"], f"{what}: sizes that are none of the six: {letters['sizes']}")
    check(not letters["weights"], f"{what}: weights that are none of the three: {letters['weights']}")
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
    for spaced in ("", "* { letter-spacing: .12em !important; word-spacing: .16em !important; }"):
        page.run(SPACED, spaced)
        width, window = page.run("return [document.documentElement.scrollWidth, window.innerWidth]")
        check(width <= window, f"{what}{', spaced' if spaced else ''}: the page is {width} px wide, the window {window} px; beyond it: {page.run(BEYOND)}")
    page.run(SPACED, "")
