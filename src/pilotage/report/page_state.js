// What the page is about and what it shows now. The scripts page_*.js are joined in this order and share one scope.
const data = JSON.parse(document.getElementById('data').textContent);
const report = data.report;
const display = data.display;
const tiles = report.tiles.rows;
const flown = Boolean(report.route);  // a survey has ground and no route
const column = {};
report.tiles.columns.forEach((name, i) => { column[name] = i; });
const valueOf = (row, name) => row[column[name]];

// Whether ground is told apart by classes, and the first measure that has values: the one to judge by.
const hasClasses = display.classes.some((known) => known !== null);
const firstMeasured = report.measures.findIndex((measure) => measure.least !== null);
const levels = [...new Set(tiles.map((row) => valueOf(row, 'level')))].sort((a, b) => a - b);
const state = {
  measure: firstMeasured < 0 && hasClasses ? -1 : Math.max(0, firstMeasured),  // -1: the decision
  whole: false,     // shares that rank the ground are coloured from 0 to 1
  level: levels.length ? levels[0] : 0,
  threshold: null,  // a value of the measure, or null
  tile: -1,         // index into tiles
  along: null,      // metres along the route
  printing: false,  // map and chart are drawn for paper
};

// Whether the ground can be counted on: classes instead of a scale, and no threshold.
const decision = { label: 'Decision: go, marginal, no-go', unit: '1', meaning: display.class_meaning };
const isDecision = () => state.measure < 0;
const scaleNow = () => (isDecision() ? decision : report.measures[state.measure]);
const ranksNow = () => !isDecision() && display.ranks[state.measure];
// The values at the ends of the colours.
const rangeNow = () => (ranksNow() && state.whole ? { low: 0, high: 1 } : scaleNow());
// Index of the colour of a tile, -1 where it has no value.
function shadeOf(i) {
  if (!(ranksNow() && state.whole)) return display.shades[state.measure][i];
  const value = measuredValue(i);
  return value === null ? -1 : Math.round(255 * Math.min(1, Math.max(0, value)));
}
const isUntested = new Set(display.untested);
const decimalsNow = () => display.decimals[state.measure];
const measuredValue = (i) => valueOf(tiles[i], scaleNow().name);
const className = (i) => (display.classes[i] === null ? 'not known' : display.class_names[display.classes[i]]);
function passes(i) {
  const value = measuredValue(i);
  return state.threshold === null || (value !== null && value >= state.threshold);
}

// ---- Words and numbers ----
function formatted(value, decimals) {
  return value === null || value === undefined ? '–' : value.toFixed(decimals);
}
// As percent_text: what is not complete is not 100 %, what is something is not 0 %.
const percentWords = (fraction) => (fraction > 0 && fraction < 0.01 ? 'less than 1' : Math.floor(fraction * 100 + 1e-9)) + ' %';
function withUnit(text, unit) {
  return unit && unit !== '1' ? text + ' ' + unit : text;
}
function fieldText(value, name, unit) {
  if (value === null) return '–';
  if (typeof value === 'boolean') return value ? 'yes' : 'no';
  if (typeof value === 'string') return name === 'status' ? value.replaceAll('_', ' ') : value;
  return withUnit(String(value), unit);
}
// What the map shows of a tile: its class, or its value without the unit.
function shownText(i) {
  return isDecision() ? className(i) : formatted(measuredValue(i), decimalsNow());
}
function element(tag, text, className) {
  const node = document.createElement(tag);
  if (text !== undefined) node.textContent = text;
  if (className) node.className = className;
  return node;
}
function svgElement(tag, attributes) {
  const node = document.createElementNS(document.querySelector('svg').namespaceURI, tag);
  for (const [name, value] of Object.entries(attributes)) node.setAttribute(name, String(value));
  return node;
}
