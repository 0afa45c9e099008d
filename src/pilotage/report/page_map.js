// The map: imagery, heat map, areas, route, and the marks that link it to the chart and to a tile.
let map = null;
const layers = {};  // by the word of its checkbox, "show-…"
const moreLayers = [];  // of one page alone: [name, pane, draw]

const legStyles = {
  good: { color: '#0072b2', width: 4, dash: [] },
  marginal: { color: '#e69f00', width: 4, dash: [12, 7] },
  bad: { color: '#d5008a', width: 6, dash: [4, 5] },
};
// Lines keep off the cells beside them: from a distance, where a corridor is a few pixels wide, they become thinner.
function lineShare(view) {
  return Math.min(1, Math.max(0.3, bucketSize_m * view.scale / 16));
}
function drawGaps(context, view) {
  const share = lineShare(view);
  display.gap_lines_m.forEach((flat, i) => {
    context.lineWidth = 18 * share;
    context.globalAlpha = 0.6;
    const status = report.route.gaps[i].status;
    context.strokeStyle = legStyles[status].color;
    strokeLine(context, view, flat, status === 'bad' ? [7, 4] : []);
  });
  context.globalAlpha = 1;
}
// A wide band, so that it shows beside the gaps.
function drawDenied(context, view) {
  context.globalAlpha = 0.45;
  context.strokeStyle = '#6a3d9a';
  context.lineWidth = 30;
  display.denied_lines_m.forEach((flat) => strokeLine(context, view, flat, []));
  context.globalAlpha = 1;
}
// Where most flights are lost, of a route on which too many are; null else.
const mostLost = flown && report.route.probability && report.route.probability.p_within_limit < report.route.probability.min_p_within_limit
  ? report.route.probability.worst : null;
function drawLost(context, view) {
  const { from_distance_m, to_distance_m } = mostLost;
  const line = Array.from({ length: 101 }, (_, k) => placeAlong(from_distance_m + (to_distance_m - from_distance_m) * k / 100)).flat();
  for (const [color, width] of [['#fff', 34], ['#c3003c', 28]]) {
    context.globalAlpha = 0.5;
    context.strokeStyle = color;
    context.lineWidth = width * lineShare(view);
    strokeLine(context, view, line, []);
  }
  context.globalAlpha = 1;
}
// Where 95 of 100 simulated flights are, at marks along the route.
function drawTruePlaces(context, view) {
  context.strokeStyle = '#8b3a00';
  context.fillStyle = 'rgba(230, 110, 20, 0.16)';
  context.lineWidth = 1.5;
  display.true_place_lines_m.forEach((flat) => {
    const path = new Path2D();
    tracePath(path, view, flat, true);
    context.fill(path);
    context.stroke(path);
  });
}
function drawRoute(context, view) {
  context.lineJoin = 'round';
  const share = lineShare(view);
  display.leg_lines_m.forEach((flat, i) => {
    const style = legStyles[report.route.legs[i].status];
    context.globalAlpha = 0.9;
    context.strokeStyle = '#fff';
    context.lineWidth = 8 * share;
    strokeLine(context, view, flat, []);
    context.globalAlpha = 1;
    context.strokeStyle = style.color;
    context.lineWidth = Math.max(1.5, style.width * share);
    strokeLine(context, view, flat, style.dash);
  });
  labelLegs(context, view);
}
function disc(context, x, y, text, fill, ink) {
  context.beginPath();
  context.arc(x, y, 10, 0, 2 * Math.PI);
  context.fillStyle = fill;
  context.fill();
  context.lineWidth = 1.5;
  context.strokeStyle = ink;
  context.stroke();
  context.fillStyle = ink;
  context.fillText(text, x, y + 0.5);
}
// The number of each leg in its middle, where there is room, and where the route begins and ends.
function labelLegs(context, view) {
  context.font = '700 11px system-ui, sans-serif';
  context.textAlign = 'center';
  context.textBaseline = 'middle';
  report.route.legs.forEach((leg, i) => {
    const flat = display.leg_lines_m[i];
    const length = Math.hypot(view.x(flat[flat.length - 2]) - view.x(flat[0]), view.y(flat[flat.length - 1]) - view.y(flat[1]));
    if (length < 48 || leg.from_distance_m === null) return;
    const [x, y] = placeAlong(leg.from_distance_m + leg.length_m / 2);
    disc(context, view.x(x), view.y(y), String(leg.leg), '#fff', '#000');
  });
  if (!display.places_m.length) return;
  const first = display.places_m[0];
  const last = display.places_m[display.places_m.length - 1];
  disc(context, view.x(last[1]), view.y(last[2]), '■', '#fff', '#000');
  disc(context, view.x(first[1]), view.y(first[2]), '▶', '#000', '#fff');
}

// The tile itself is larger than its cell by tile size / stride.
function tileOutline(i) {
  const flat = display.cells_m[i];
  const grow = 1 / cellShare(i);
  const cx = (flat[0] + flat[2] + flat[4] + flat[6]) / 4;
  const cy = (flat[1] + flat[3] + flat[5] + flat[7]) / 4;
  return flat.map((value, k) => (k % 2 === 0 ? cx + (value - cx) * grow : cy + (value - cy) * grow));
}
function drawMarks(context, view) {
  if (state.tile >= 0) {
    const path = new Path2D();
    tracePath(path, view, tileOutline(state.tile), true);
    strokeTwice(context, path, ['#000', 5], ['#ffe94d', 2.5]);
  }
  if (state.along === null || !flown || !display.places_m.length) return;
  const [x, y] = placeAlong(state.along);
  context.beginPath();
  context.arc(view.x(x), view.y(y), 8, 0, 2 * Math.PI);
  context.fillStyle = '#ffe94d';
  context.fill();
  context.lineWidth = 3;
  context.strokeStyle = '#000';
  context.stroke();
}

function addControls() {
  const north = L.control({ position: 'topright' });
  north.onAdd = () => {
    const node = element('div', undefined, 'north');
    node.append(element('div', '▲'), element('div', 'N'));
    return node;
  };
  north.addTo(map);
  L.control.scale({ imperial: false, maxWidth: 180 }).addTo(map);
  const pointed = L.control({ position: 'bottomright' });
  const node = element('div', '', 'pointed');
  pointed.onAdd = () => node;
  pointed.addTo(map);
  map.on('mousemove', (event) => {
    const point = event.latlng.wrap();
    const place = L.Projection.SphericalMercator.project(event.latlng);
    const i = tileAt(place.x, place.y, state.level);
    node.textContent = (i < 0 ? '' : 'tile ' + valueOf(tiles[i], 'tile_id') + ': ' + (isDecision() ? '' : scaleNow().label + ' ') +
      withUnit(shownText(i), scaleNow().unit) + ' · ') + point.lat.toFixed(6) + ', ' + point.lng.toFixed(6);
  });
}

// Metres of the plane that `pixels` of the screen are.
const metresOf = (pixels) => pixels * 2 * Math.PI * earthRadius_m / (256 * Math.pow(2, map.getZoom()));

function wholeBounds() {
  const [minX, minY, maxX, maxY] = display.edges_m;
  return L.latLngBounds(toLatLng(minX, minY), toLatLng(maxX, maxY));
}
function setOpacity() {
  if (map) map.getPane('heat').style.opacity = String(Number($('opacity').value) / 100);
}
function addLayer(name, pane, draw) {
  layers[name] = new CanvasLayer(pane, draw);
  const box = $('show-' + name);
  if (!box || box.checked) layers[name].addTo(map);
}
function makeMap() {
  const [minX, minY, maxX, maxY] = display.edges_m;
  $('map').style.setProperty('--mission-aspect', String((maxX - minX) / (maxY - minY)));
  // Zooming is drawn at once instead of animated: every layer is a canvas that is drawn anew anyway.
  map = L.map('map', { attributionControl: false, zoomSnap: 0.25, zoomDelta: 0.5, maxZoom: 23, maxBoundsViscosity: 0.6,
    fadeAnimation: false, zoomAnimation: false });
  const bounds = wholeBounds();
  map.fitBounds(bounds);
  map.setMaxBounds(bounds.pad(0.6));
  map.setMinZoom(map.getZoom() - 2);
  ['imagery', 'detail', 'heat', 'outline', 'route', 'cursor'].forEach((name, k) => { map.createPane(name).style.zIndex = 250 + 20 * k; });
  if (display.imagery) layers.imagery = L.imageOverlay(display.imagery, bounds, { pane: 'imagery', alt: flown ? 'Imagery of the corridor' : 'Imagery of the area' }).addTo(map);
  addLayer('detail', 'detail', drawDetail);
  addLayer('heat', 'heat', drawHeat);
  addLayer('untested', 'heat', drawUntested);
  addLayer('classes', 'outline', drawClasses);
  if (flown) {
    addLayer('refused', 'outline', drawRefused);
    addLayer('selected', 'outline', drawSelected);
    if (display.denied_lines_m.length) addLayer('denied', 'route', drawDenied);
    if (display.true_place_lines_m.length) addLayer('true-places', 'route', drawTruePlaces);
    if (mostLost && display.places_m.length) addLayer('lost', 'route', drawLost);
    addLayer('gaps', 'route', drawGaps);
    addLayer('route', 'route', drawRoute);
  }
  moreLayers.forEach(([name, pane, draw]) => addLayer(name, pane, draw));
  addLayer('grid', 'route', drawGrid);
  addLayer('marks', 'cursor', drawMarks);
  addControls();
  setOpacity();
  map.on('click', (event) => {
    if (sketchTakes(event)) return;
    const place = L.Projection.SphericalMercator.project(event.latlng);
    const found = tileAt(place.x, place.y, state.level);
    if (found >= 0) showTile(found, false);
    if (flown) hoverRoute(event);
  });
  if (flown) map.on('mousemove', hoverRoute);
  if (layers.imagery) layers.imagery.on('load', () => layers.detail.redraw());
  window.requestAnimationFrame(() => loadSheet(() => layers.detail.redraw()));
}
function hoverRoute(event) {
  const place = L.Projection.SphericalMercator.project(event.latlng);
  const nearest = nearestAlong(place.x, place.y);
  if (nearest.away <= metresOf(14)) setAlong(nearest.along, 'map');
}
function recolor() {
  if (layers.heat) layers.heat.redraw();
}
// Another measure, or another range of its colours.
function showMeasure() {
  for (const name of ['untested', 'classes']) if (layers[name]) layers[name].redraw();
}
function redrawMarks() {
  if (layers.marks) layers.marks.redraw();
}
function showStretch(from_m, to_m) {
  setAlong(to_m, 'button');
  if (!map || !display.places_m.length) return;
  const bounds = L.latLngBounds([]);
  for (let k = 0; k <= 40; ++k) bounds.extend(toLatLng(...placeAlong(from_m + (to_m - from_m) * k / 40)));
  map.fitBounds(bounds.pad(0.35), { maxZoom: 18 });
  $('map').scrollIntoView({ block: 'center' });
  $('map').focus({ preventScroll: true });
}
