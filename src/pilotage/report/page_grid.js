// Meridians and parallels over the map, with their degrees at its edges.
const gridSteps_s = [0.1, 0.2, 0.5, 1, 2, 5, 10, 15, 30, 60, 120, 300, 600, 900, 1800, 3600, 7200, 18000, 36000];

function degreesText(seconds, step_s, letters) {
  const whole = Math.round(Math.abs(seconds) * 10) / 10;
  const minutes = Math.floor(whole / 60) % 60;
  const rest = whole - 60 * Math.floor(whole / 60);
  let text = Math.floor(whole / 3600) + '°';
  if (step_s < 3600) text += String(minutes).padStart(2, '0') + "'";
  if (step_s < 60) text += rest.toFixed(step_s < 1 ? 1 : 0).padStart(step_s < 1 ? 4 : 2, '0') + '"';
  return text + ' ' + letters[seconds < 0 ? 1 : 0];
}
// The smallest step of which at most `most` fit.
function gridStep_s(from_deg, to_deg, most) {
  const extent_s = 3600 * (to_deg - from_deg);
  return gridSteps_s.find((step) => extent_s / step <= most) || gridSteps_s[gridSteps_s.length - 1];
}
function gridLabel(context, text, x, y) {
  context.strokeText(text, x, y);
  context.fillText(text, x, y);
}
function drawGrid(context, view) {
  const seen = map.getBounds();
  // The canvas reaches a sixth of itself beyond each edge of the map.
  const left = view.width / 6, top = view.height / 6, right = view.width - left;
  const place = (lat, lng) => L.Projection.SphericalMercator.project(L.latLng(lat, lng));
  context.font = '600 11px system-ui, sans-serif';
  context.textBaseline = 'top';
  const lines = new Path2D();
  const labels = [];
  const lng_s = gridStep_s(seen.getWest(), seen.getEast(), 5);
  for (let k = Math.ceil(3600 * seen.getWest() / lng_s); k * lng_s <= 3600 * seen.getEast(); ++k) {
    const x = view.x(place(0, k * lng_s / 3600).x);
    lines.moveTo(x, 0);
    lines.lineTo(x, view.height);
    const wrapped = ((k * lng_s + 648000) % 1296000 + 1296000) % 1296000 - 648000;
    labels.push([degreesText(wrapped, lng_s, 'EW'), x + 3, top + 3]);
  }
  const lat_s = gridStep_s(seen.getSouth(), seen.getNorth(), 4);
  for (let k = Math.ceil(3600 * seen.getSouth() / lat_s); k * lat_s <= 3600 * seen.getNorth(); ++k) {
    const y = view.y(place(k * lat_s / 3600, 0).y);
    lines.moveTo(0, y);
    lines.lineTo(view.width, y);
    const text = degreesText(k * lat_s, lat_s, 'NS');
    labels.push([text, right - 4 - context.measureText(text).width, y + 2]);
  }
  strokeTwice(context, lines, ['rgba(255, 255, 255, 0.7)', 2.5], ['rgba(0, 0, 0, 0.75)', 0.8]);
  context.lineWidth = 3;
  context.strokeStyle = '#fff';
  context.fillStyle = '#000';
  const buttons_px = state.printing ? 0 : 48;  // of the map's corner
  labels.filter(([text, x]) => x >= left + buttons_px && x + context.measureText(text).width <= right).forEach(([text, x, y]) => gridLabel(context, text, x, y));
}
