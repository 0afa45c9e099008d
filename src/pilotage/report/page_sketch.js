// A route drawn on the map: points that are dragged, legs with a handle in the middle, the prediction beside it.
// `predicted` is of `flight`, `about`: at once, from few samples; `run` tells whether an answer is still asked for.
const sketch = { points: [], history: [], drawing: false, run: 0, timer: 0, frame: 0, predicted: null, flight: null, about: false,
  shift: { middle: 0, low: 0, high: 0 } };

// ---- Settings ----
function sketchSettings() {
  const fields = ['limit', 'interval', 'speed'].map((name) => $('sketch-' + name));
  if (!fields.every((field) => field.checkValidity())) return null;
  return { limit_m: Number($('sketch-limit').value), interval_s: Number($('sketch-interval').value), speed_mps: null,
    model: sketchData.models[Number($('sketch-ins').value)] };
}
const numberOrNull = (id) => ($(id).value === '' ? null : Number($(id).value));
// The points with what the form says for all of them.
function sketchPoints() {
  const speed_mps = numberOrNull('sketch-speed');
  return sketch.points.map((point) => (speed_mps === null ? point : { ...point, speed_mps }));
}

// ---- Editing ----
function keepForUndo() {
  sketch.history.push(sketch.points.map((point) => ({ ...point })));
  if (sketch.history.length > 200) sketch.history.shift();
}
// A point at a place on the leg that leads to `index`, or behind the last point; height and speed are its neighbours'.
function newPoint(latLng, index) {
  const { points } = sketch;
  const before = points[index - 1], after = points[index];
  const like = before || after;
  const agl_m = before && after ? (before.agl_m + after.agl_m) / 2 : like ? like.agl_m : sketchData.agl_m;
  const wrapped = latLng.wrap();
  return { lat: wrapped.lat, lng: wrapped.lng, agl_m, speed_mps: (after || like || sketchData).speed_mps };
}
function insertPoint(latLng, index) {
  keepForUndo();
  sketch.points.splice(index, 0, newPoint(latLng, index));
  sketchChanged();
}
function deletePoint(index) {
  keepForUndo();
  sketch.points.splice(index, 1);
  sketchChanged();
  focusPoint(Math.min(index, sketch.points.length - 1));
}
function movePoint(index, latLng) {
  const wrapped = latLng.wrap();
  Object.assign(sketch.points[index], { lat: wrapped.lat, lng: wrapped.lng });
}
function undoSketch() {
  if (!sketch.history.length) return;
  sketch.points = sketch.history.pop();
  sketchChanged();
}
function setSketch(points) {
  keepForUndo();
  sketch.points = points;
  sketchChanged();
}
const plannedPoints = () => sketchData.points.map(([lng, lat, agl_m, speed_mps], i) =>
  ({ lat, lng, agl_m, speed_mps: speed_mps === null ? (sketchData.points[1] || [])[3] : speed_mps }));

// ---- On the map ----
const sketchMarkers = { points: [], middles: [] };
const sketchIcon = (type, size) => L.divIcon({ className: 'sketch-' + type, iconSize: [size, size] });
const focusPoint = (index) => { if (sketchMarkers.points[index]) sketchMarkers.points[index].getElement().focus(); };
function nudge(index, event) {
  const steps = { ArrowUp: [0, -1], ArrowDown: [0, 1], ArrowLeft: [-1, 0], ArrowRight: [1, 0] };
  if (!steps[event.key]) return false;
  const by = event.shiftKey ? 40 : 8;  // pixels
  keepForUndo();
  const [dx, dy] = steps[event.key];
  movePoint(index, map.containerPointToLatLng(map.latLngToContainerPoint(sketch.points[index]).add([by * dx, by * dy])));
  sketchChanged();
  focusPoint(index);
  return true;
}
function pointKey(index, event) {
  const middle = () => map.containerPointToLatLng(map.latLngToContainerPoint(sketch.points[index]).add(
    map.latLngToContainerPoint(sketch.points[index + 1])).divideBy(2));
  if (event.key === 'Delete' || event.key === 'Backspace') deletePoint(index);
  else if (event.key === 'Insert' && index + 1 < sketch.points.length) {
    insertPoint(middle(), index + 1);
    focusPoint(index + 1);
  } else if (!nudge(index, event)) return;
  L.DomEvent.stop(event);
}
function addPointMarker(index) {
  const { points } = sketch;
  const marker = L.marker(points[index], { icon: sketchIcon('point', 18), draggable: true, keyboard: true, pane: 'sketch', bubblingMouseEvents: false });
  marker.on('dragstart', () => { keepForUndo(); });
  marker.on('drag', () => { movePoint(index, marker.getLatLng()); placeMiddles(); followDrag(); });
  marker.on('dragend', () => { sketchChanged(); });
  marker.on('contextmenu', () => deletePoint(index));
  marker.addTo(map);
  const node = marker.getElement();
  node.textContent = String(index + 1);
  node.setAttribute('role', 'button');
  node.setAttribute('aria-label', 'Point ' + (index + 1) + ' of ' + points.length + ': arrow keys move it, Delete takes it out, Insert adds one behind it');
  L.DomEvent.on(node, 'keydown', (event) => pointKey(index, event));
  sketchMarkers.points.push(marker);
}
const middleOf = (index) => map.containerPointToLatLng(map.latLngToContainerPoint(sketch.points[index]).add(
  map.latLngToContainerPoint(sketch.points[index + 1])).divideBy(2));
const hasRoomForMiddle = (index) => map.latLngToContainerPoint(sketch.points[index]).distanceTo(map.latLngToContainerPoint(sketch.points[index + 1])) > 60;
// The handle of a leg becomes a point when it is dragged.
function addMiddleMarker(index) {
  const marker = L.marker(middleOf(index), { icon: sketchIcon('middle', 14), draggable: true, keyboard: false, pane: 'sketch', bubblingMouseEvents: false });
  marker.on('dragstart', () => {
    keepForUndo();
    sketch.points.splice(index + 1, 0, newPoint(marker.getLatLng(), index + 1));
  });
  marker.on('drag', () => { movePoint(index + 1, marker.getLatLng()); followDrag(); });
  marker.on('dragend', () => { sketchChanged(); });
  marker.on('click', () => insertPoint(marker.getLatLng(), index + 1));
  marker.addTo(map);
  sketchMarkers.middles.push([index, marker]);
}
function placeMiddles() {
  sketchMarkers.middles.forEach(([index, marker]) => marker.setLatLng(middleOf(index)));
}
function placeMarkers() {
  [...sketchMarkers.points, ...sketchMarkers.middles.map(([, marker]) => marker)].forEach((marker) => marker.remove());
  sketchMarkers.points = [];
  sketchMarkers.middles = [];
  sketch.points.forEach((_, i) => addPointMarker(i));
  for (let i = 0; i + 1 < sketch.points.length; ++i) if (hasRoomForMiddle(i)) addMiddleMarker(i);
}
const sketchPlane = (point) => L.Projection.SphericalMercator.project(L.latLng(point.lat, point.lng));
function drawSketch(context, view) {
  const { points, predicted, flight } = sketch;
  if (points.length < 2 || state.printing) return;  // a sketch is not the report's
  const places = points.map(sketchPlane);
  for (const [color, width] of [['#000', 8], ['#fff', 6]]) {
    context.strokeStyle = color;
    context.lineWidth = width;
    strokeLine(context, view, places.flatMap(({ x, y }) => [x, y]), []);
  }
  places.slice(1).forEach((place, i) => {
    const leg = flight && predicted ? flight.legs.findIndex((one) => one.points[0] === i) : -1;
    const style = leg < 0 || !predicted.legs[leg] ? { color: '#555', dash: [] } : legStyles[statusNames[predicted.legs[leg].status]];
    context.strokeStyle = style.color;
    context.lineWidth = 3.5;
    strokeLine(context, view, [places[i].x, places[i].y, place.x, place.y], style.dash);
  });
  const worst = predicted && predicted.probability && predicted.verdict === 2 ? predicted.probability.worst : null;
  if (!worst || !flight) return;
  const stretch = flight.places.filter(([distance_m]) => distance_m >= worst.from_distance_m && distance_m <= worst.to_distance_m);
  context.globalAlpha = 0.45;
  context.strokeStyle = '#d5008a';
  context.lineWidth = 20;
  strokeLine(context, view, stretch.flatMap(([, x, y]) => [x, y]), []);
  context.globalAlpha = 1;
}
const sketchOnMap = element('div', '', 'sketch-on-map');

// ---- Prediction ----
function sayOnMap(words, type) {
  sketchOnMap.textContent = words;
  sketchOnMap.className = 'sketch-on-map' + (type ? ' badge ' + type : '');
}
function sketchChanged() {
  $('sketch-undo').disabled = !sketch.history.length;
  $('sketch-clear').disabled = !sketch.points.length;
  if (map) placeMarkers();
  askSketch();
}
function forgetSketch(words) {
  sketch.predicted = null;
  sketch.flight = null;
  $('sketch-verdict').hidden = true;
  $('sketch-state').textContent = words;
  sayOnMap('', '');
  if (layers.sketch) layers.sketch.redraw();
}
const plainShare = (predicted) => 'P ' + probabilityComparison(predicted.probability);
function toldOfSketch(flight) {
  return { ...sketchData, disagreement: null, others: [], matchable_fraction: flight.matchable_fraction };
}
function heightWords() {
  const heights_m = sketch.points.map((point) => point.agl_m);
  const [least, most] = [Math.min(...heights_m), Math.max(...heights_m)].map((height_m) => Math.round(height_m));
  return (least === most ? least : least + ' to ' + most) + ' m';
}
function saySketch(predicted, flight, about) {
  const status = statusNames[predicted.verdict];
  $('sketch-state').textContent = '';
  $('sketch-verdict').hidden = false;
  $('sketch-verdict').className = status;
  $('sketch-word').textContent = verdictNames[predicted.verdict];
  $('sketch-word').className = 'badge ' + status;
  $('sketch-figures').textContent = '· ' + lengthWords(flight.length_m) + ', ' + durationWords(flight.duration_s) + ', ' + heightWords() + ' above ground';
  $('sketch-answer').textContent = (about ? 'About: ' : '') + headlineSentence(predicted);
  $('sketch-detail').textContent = predicted.detail + (flight.unknown_m > 0 ? '; ' + lengthWords(flight.unknown_m) +
    ' of it lie outside the tiles of this page, where no fix is counted on' : '');
  $('sketch-assumes').textContent = predicted.assumptions + (flight.step_m > sketchStep_m ? '; looked at every ' +
    lengthWords(flight.step_m) + ' of the way' : '');
  sayOnMap((about ? 'about ' : '') + verdictNames[predicted.verdict] + ' · ' + plainShare(predicted) + ' · ' + lengthWords(flight.length_m), status);
  if (layers.sketch) layers.sketch.redraw();
}
// What wind, and whatever else an answer at once leaves out, did to the last answer in full: a shift of the logit of each share.
const logitOf = (p) => Math.log(p / (1 - p));
function shiftBetween(about, full) {
  const shift = logitOf(Math.min(1 - 1e-6, Math.max(1e-6, full))) - logitOf(Math.min(1 - 1e-6, Math.max(1e-6, about)));
  return Number.isFinite(shift) ? shift : 0;
}
const shifted = (p, shift) => (p <= 0 || p >= 1 ? p : 1 / (1 + Math.exp(-(logitOf(p) + shift))));
function shiftShares(predicted, { middle, low, high }) {
  const route = predicted.probability;
  const p = shifted(route.p_within_limit, middle);
  const interval = route.interval && { low: Math.min(p, shifted(route.interval.low, low)), high: Math.max(p, shifted(route.interval.high, high)) };
  return { ...predicted, probability: { ...route, p_within_limit: p, interval },
    profile: predicted.profile.map((sample) => ({ ...sample, p_within_limit: shifted(sample.p_within_limit, middle) })) };
}
function learnShift(about, full) {
  const [a, b] = [about.probability, full.probability];
  const ends = (name) => (a.interval && b.interval ? shiftBetween(a.interval[name], b.interval[name]) : 0);
  sketch.shift = { middle: shiftBetween(a.p_within_limit, b.p_within_limit), low: ends('low'), high: ends('high') };
}
// At once, from few samples and in calm; null where nothing can be asked.
function answerAbout() {
  const settings = sketchSettings();
  if (settings === null) {
    forgetSketch('A number lies outside what is allowed: limit 1 to 10000 m, speed 0.1 to 1000 m/s, interval 0.01 to 3600 s.');
    return null;
  }
  const points = sketchPoints();
  const flight = points.length < 2 ? null : flightOfSketch(points, settings, true);
  if (!flight || flight.count === 0) {
    forgetSketch(points.length === 1 ? 'A second point makes a route.' : '');
    return null;
  }
  const work = predictFlight(flight, settings);
  let step = work.next();
  while (!step.done) step = work.next();
  showSketch(shiftShares(step.value, sketch.shift), flight, settings, true);
  return { points, settings, about: step.value };
}
function showSketch(predicted, flight, settings, about) {
  sketch.flight = flight;
  sketch.predicted = judgeFlight(predicted, settings, toldOfSketch(flight));
  sketch.about = about;
  saySketch(sketch.predicted, flight, about);
  drawSketchChart(sketch.predicted, flight);
  sayCommands(sketch.predicted);
}
// About at once, then in full.
async function askSketch() {
  const run = ++sketch.run;
  clearTimeout(sketch.timer);
  const asked = answerAbout();
  if (asked === null) return;
  $('sketch-state').textContent = 'Computing …';
  const flight = flightOfSketch(asked.points, asked.settings, false);
  const predicted = await inSlices(predictFlight(flight, asked.settings), () => run !== sketch.run, () => {});
  if (predicted === null) return;
  learnShift(asked.about, predicted);
  showSketch(predicted, flight, asked.settings, false);
}
// While a point is dragged: once a frame, in full when it rests.
function followDrag() {
  ++sketch.run;
  clearTimeout(sketch.timer);
  sketch.timer = setTimeout(askSketch, 400);
  if (sketch.frame) return;
  sketch.frame = window.requestAnimationFrame(() => {
    sketch.frame = 0;
    answerAbout();
  });
}

// ---- Error and share of flights along the way ----
const sketchAxes = { left: 80, right: 1480, top: 14, bottom: 190, shareTop: 222, shareBottom: 292 };
function drawSketchChart(predicted, flight) {
  const { left, right, top, bottom, shareTop, shareBottom } = sketchAxes;
  const most_m = Math.max(predicted.max_error_m, 1, predicted.largest_error_m) * 1.08;
  const x = (distance_m) => left + distance_m / flight.length_m * (right - left);
  const y = (error_m) => bottom - Math.min(1, error_m / most_m) * (bottom - top);
  const shareY = (share) => shareBottom - share * (shareBottom - shareTop);
  const parts = [];
  for (const gap of predicted.gaps) {
    const band = svgElement('rect', { class: 'gap ' + statusNames[gap.status], x: chartNumber(x(gap.from_distance_m)), y: top,
      width: chartNumber(Math.max(1, x(gap.to_distance_m) - x(gap.from_distance_m))), height: bottom - top });
    const words = svgElement('title', {});
    words.textContent = 'gap of ' + gapWords(gap) + ', error at its end ' + comparisonWords(gap.error_m, predicted.max_error_m);
    band.append(words);
    parts.push(band);
  }
  const step_m = tickStep(most_m, 3);
  for (let i = 0; i * step_m <= most_m; ++i) {
    parts.push(chartLine('grid', left, y(i * step_m), right, y(i * step_m)), chartWords('tick-y', left - 8, y(i * step_m) + 5, Number((i * step_m).toPrecision(12)) + ' m'));
  }
  const profile = thinProfile(predicted.profile, 1500);
  parts.push(svgElement('path', { class: 'curve', d: curvePath(profile.map((sample) => [x(sample.distance_m), y(sample.error_m)])) }));
  parts.push(chartLine('limit', left, y(predicted.max_error_m), right, y(predicted.max_error_m)));
  parts.push(chartWords('limit-label', left + 8, y(predicted.max_error_m) - 6, 'limit ' + errorWords(predicted.max_error_m)));
  for (const share of [0, 0.5, 1]) {
    parts.push(chartLine('grid', left, shareY(share), right, shareY(share)), chartWords('tick-y', left - 8, shareY(share) + 5, 100 * share + ' %'));
  }
  if (predicted.probability) {
    const asked = shareY(predicted.probability.min_p_within_limit);
    parts.push(chartLine('limit', left, asked, right, asked));
    parts.push(svgElement('path', { class: 'curve loss', d: curvePath(profile.map((sample) => [x(sample.distance_m), shareY(sample.p_within_limit)])) }));
    parts.push(chartWords('loss-label', left + 8, shareTop - 6, 'share of flights still within the limit'));
  }
  const kilometres = tickStep(flight.length_m, 10);
  for (let i = 0; i * kilometres <= flight.length_m; ++i) {
    parts.push(chartWords('tick-x', x(i * kilometres), 318, Number((i * kilometres / 1000).toPrecision(6)) + ' km'));
  }
  flight.legs.reduce((begin_m, leg) => {
    if (begin_m > 0) parts.push(chartLine('axis-line', x(begin_m), top, x(begin_m), shareBottom));
    return begin_m + leg.length_m;
  }, 0);
  $('sketch-chart').replaceChildren(...parts);
  $('sketch-chart').setAttribute('aria-label', 'Sketched route: predicted position error, and the share of flights still within the limit, along the way. ' + predicted.text);
}
function sayCommands(predicted) {
  $('sketch-mission').hidden = !sketchData.mission;
  const failed = predicted.verdict > 0;
  if (!sketchData.mission) {
    $('sketch-commands').textContent = 'Then prepare the mission with this route' + (failed ? ', or ask reroute for the cheapest line nearby that is GO.' : '.');
    return;
  }
  const line = (words, command) => [words, element('code', command), element('br')];
  $('sketch-commands').replaceChildren(...line('Save .plan and mission.json where the imagery is found by its name; the verdict: ', 'pilotage prepare sketch_mission.json -o sketch'),
    ...(failed ? line('The cheapest line nearby that is GO: ', 'pilotage reroute sketch_mission.json -o rerouted.plan') : []));
}
function saveSketch(kind) {
  const points = sketchPoints();
  const makers = { plan: ['sketch.plan', 'application/json', sketchAsPlan], waypoints: ['sketch.waypoints', 'text/plain', sketchAsWaypoints],
    kml: ['sketch.kml', 'application/vnd.google-earth.kml+xml', sketchAsKml], geojson: ['sketch.geojson', 'application/geo+json', sketchAsGeoJson],
    mission: ['sketch_mission.json', 'application/json', () => sketchAsMission(sketchSettings())] };
  const [name, type, make] = makers[kind];
  saveText(name, type, make(points));
}

// ---- Controls ----
function setDrawing(on) {
  sketch.drawing = on;
  $('sketch-draw').setAttribute('aria-pressed', String(on));
  $('sketch-draw').textContent = on ? 'Stop drawing' : sketch.points.length ? 'Go on drawing' : 'Draw';
  $('map').classList.toggle('drawing', on);
  $('sketch-hint').textContent = on ? 'Click the map for each point; double-click or Escape ends. Drag a point or the handle of a leg; right-click takes a point out.' : '';
  if (!map) return;
  if (on) map.doubleClickZoom.disable(); else map.doubleClickZoom.enable();
}
// Whether a click on the map is the sketch's.
function sketchTakes(event) {
  if (!sketch.drawing) return false;
  insertPoint(event.latlng, sketch.points.length);
  return true;
}
function sketchKeys(event) {
  if (event.key === 'Escape' && sketch.drawing) setDrawing(false);
  const inField = event.target instanceof Element && event.target.matches('input, select, textarea');
  if ((event.ctrlKey || event.metaKey) && event.key === 'z' && !inField && sketch.history.length) {
    undoSketch();
    event.preventDefault();
  }
}
function makeSketch() {
  if (sketchData === null || !display.drawn) return;
  sketchData.models.forEach((model, i) => {
    const option = element('option', i === 0 ? (flown ? 'as planned: ' : '') + model.text : model.text);
    option.value = String(i);
    $('sketch-ins').append(option);
  });
  $('sketch-limit').value = sketchData.max_error_m;
  $('sketch-interval').value = sketchData.fix_interval_s;
  if (sketchData.points.length) $('sketch-speed').placeholder = 'as planned'; else $('sketch-speed').value = sketchData.speed_mps;
  $('sketch-planned').hidden = !sketchData.points.length;
  $('sketch').hidden = false;
  moreLayers.push(['sketch', 'cursor', drawSketch]);
}
function linkSketch() {
  if (sketchData === null || !map) return;
  map.createPane('sketch').style.zIndex = 640;
  const control = L.control({ position: 'bottomleft' });
  control.onAdd = () => {
    const box = element('div');
    box.append(sketchOnMap);
    return box;
  };
  control.addTo(map);
  map.on('zoomend', () => { if (sketch.points.length) placeMarkers(); });
  map.on('dblclick', () => {
    if (!sketch.drawing) return;
    const { points } = sketch;
    const [last, before] = [points[points.length - 1], points[points.length - 2]];
    if (before && map.latLngToContainerPoint(last).distanceTo(map.latLngToContainerPoint(before)) < 6) undoSketch();  // of its second click
    setDrawing(false);
  });
  $('sketch-draw').addEventListener('click', () => {
    setDrawing(!sketch.drawing);
    if (sketch.drawing) $('map').scrollIntoView({ block: 'center' });
  });
  $('sketch-planned').addEventListener('click', () => setSketch(plannedPoints()));
  $('sketch-undo').addEventListener('click', undoSketch);
  $('sketch-clear').addEventListener('click', () => { setSketch([]); setDrawing(false); });
  document.querySelectorAll('[data-save]').forEach((button) => button.addEventListener('click', () => saveSketch(button.dataset.save)));
  document.addEventListener('keydown', sketchKeys);
  $('sketch-form').addEventListener('submit', (event) => event.preventDefault());
  for (const name of ['limit', 'ins', 'speed', 'interval']) {
    $('sketch-' + name).addEventListener('input', () => {
      clearTimeout(sketch.timer);
      sketch.timer = setTimeout(askSketch, 300);
    });
  }
}
