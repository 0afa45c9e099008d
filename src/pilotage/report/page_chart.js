// The chart along the route, linked with the map both ways.
const chart = $('chart');
const axes = ['left', 'right', 'top', 'bottom', 'distanceM', 'errorM'].reduce((all, name) => {
  all[name] = Number(chart.dataset[name]);
  return all;
}, {});

// The flight that the chart shows: the report's, or one with other settings (page_what_if.js).
const plannedFlight = { whatIf: false, limit_m: report.route.max_error_m, rows: report.route.error_profile.rows, p: display.profile_p,
  denied: report.route.denied, losses: report.route.loss_anywhere ? report.route.loss_anywhere.rows : [] };
let shownFlight = plannedFlight;

function alongText(distance, error) {
  const rows = shownFlight.rows;
  const parts = [(shownFlight.whatIf ? 'What if: ' : '') + (distance / 1000).toFixed(2) + ' km'];
  const leg = report.route.legs.find((entry) => entry.from_distance_m !== null && distance >= entry.from_distance_m &&
    distance <= entry.from_distance_m + entry.length_m);
  if (leg) parts.push('leg ' + leg.leg);
  parts.push(error === null ? 'error unknown' : 'error ' + error.toFixed(1) + ' m of ' + shownFlight.limit_m + ' m');
  const p = rows.length ? shownFlight.p[lastBefore(rows, distance)] : [null, null];
  const fix = report.route.fixes.some((stretch) => distance >= stretch.from_distance_m && distance <= stretch.to_distance_m);
  const aided = shownFlight.denied && !shownFlight.denied.some((stretch) => distance >= stretch.from_distance_m &&
    distance <= stretch.to_distance_m);
  parts.push(aided ? 'with GNSS' : fix ? 'over a chosen tile' + (p[0] === null ? '' : ', P(correct fix) ' + p[0].toFixed(2)) : 'no fix');
  if (display.heights.length) {
    parts.push((between(display.heights, distance, 2) - between(display.heights, distance, 1)).toFixed(0) + ' m above ground');
  }
  if (p[1] !== null) parts.push('within the limit so far with P = ' + p[1].toFixed(3));
  if (!shownFlight.whatIf && display.simulated.length) {
    const [, cep50, r95, within] = display.simulated[Math.max(0, lastBefore(display.simulated, distance))];
    parts.push('simulated: CEP50 ' + cep50.toFixed(1) + ' m' + (r95 === null ? '' : ', R95 ' + r95.toFixed(1) + ' m') +
      ', within the limit so far ' + within.toFixed(3));
  }
  const losses = shownFlight.losses;
  const lost = losses.length ? losses[lastBefore(losses, distance)] : null;
  if (lost && lost[2] !== null) parts.push('all the way, if GNSS is lost here, with P = ' + (Math.floor(lost[2] * 1000 + 1e-6) / 1000).toFixed(3));
  return parts.join(' · ');
}
// `source`: 'map', 'chart', 'slider' or 'button'; the map follows all but itself.
function setAlong(distance, source) {
  state.along = distance;
  const rows = shownFlight.rows;
  const error = rows.length ? between(rows, distance, 1) : null;
  const x = axes.left + distance / axes.distanceM * (axes.right - axes.left);
  const share = error === null ? 1 : Math.min(1, error / axes.errorM);
  const y = axes.bottom - share * (axes.bottom - axes.top);
  const cursor = $('chart-cursor');
  cursor.setAttribute('visibility', 'visible');
  cursor.querySelector('line').setAttribute('x1', x);
  cursor.querySelector('line').setAttribute('x2', x);
  cursor.querySelector('circle').setAttribute('cx', x);
  cursor.querySelector('circle').setAttribute('cy', y);
  const heights = $('heights-cursor');
  if (heights) {
    heights.setAttribute('visibility', 'visible');
    heights.setAttribute('x1', x);
    heights.setAttribute('x2', x);
  }
  const text = alongText(distance, error);
  $('along-text').textContent = text;
  $('along').setAttribute('aria-valuetext', text);
  if (source !== 'slider') $('along').value = String(Math.round(1000 * distance / axes.distanceM));
  showSeen(distance);
  redrawMarks();
  if (!map || source === 'map' || !display.places_m.length) return;
  const point = toLatLng(...placeAlong(distance));
  if (!map.getBounds().contains(point)) map.panTo(point, { animate: false });
}
function linkChart() {
  const follow = (event) => {
    const box = chart.getBoundingClientRect();
    const x = (event.clientX - box.left) / box.width * chart.viewBox.baseVal.width;
    const share = (x - axes.left) / (axes.right - axes.left);
    if (share >= 0 && share <= 1) setAlong(share * axes.distanceM, 'chart');
  };
  chart.addEventListener('pointermove', follow);
  chart.addEventListener('pointerdown', follow);
  chart.addEventListener('click', () => $('along').focus({ preventScroll: true }));  // from here the arrow keys go on
  $('along').addEventListener('input', () => setAlong(Number($('along').value) / 1000 * axes.distanceM, 'slider'));
}
