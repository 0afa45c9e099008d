// A route drawn on the map: points that are dragged, legs with a handle in the middle, the prediction beside it.
// `predicted` is of `flight`; `run` tells whether an answer is still asked for.
const sketch = { points: [], history: [], drawing: false, run: 0, timer: 0, frame: 0, predicted: null, flight: null, pointer: null,
  shift: noShift };

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
// The page's ground is not torn apart where longitudes begin anew, and neither is a sketch; files have them wrapped.
const lngNearGround = (lng) => lng + 360 * Math.round((wholeBounds().getCenter().lng - lng) / 360);
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
  return { lat: latLng.lat, lng: lngNearGround(latLng.lng), agl_m, speed_mps: (after || like || sketchData).speed_mps };
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
  Object.assign(sketch.points[index], { lat: latLng.lat, lng: lngNearGround(latLng.lng) });
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
  ({ lat, lng: lngNearGround(lng), agl_m, speed_mps: speed_mps === null ? (sketchData.points[1] || [])[3] : speed_mps }));

// ---- On the map ----
const sketchMarkers = { points: [], middles: [] };
const sketchIcon = (type, size) => L.divIcon({ className: 'sketch-' + type, iconSize: [size, size] });
const focusPoint = (index) => { if (sketchMarkers.points[index]) sketchMarkers.points[index].getElement().focus(); };
function nudge(index, event) {
  const steps = { ArrowUp: [0, -1], ArrowDown: [0, 1], ArrowLeft: [-1, 0], ArrowRight: [1, 0] };
  if (!steps[event.key]) return false;
  const by = event.shiftKey ? 40 : 8;  // pixels
  if (!event.repeat) keepForUndo();
  const [dx, dy] = steps[event.key];
  movePoint(index, map.containerPointToLatLng(map.latLngToContainerPoint(sketch.points[index]).add([by * dx, by * dy])));
  sketchChanged();
  focusPoint(index);
  return true;
}
function pointKey(index, event) {
  if (event.key === 'Delete' || event.key === 'Backspace') deletePoint(index);
  else if (event.key === 'Insert' && index + 1 < sketch.points.length) {
    insertPoint(middleOf(index), index + 1);
    focusPoint(index + 1);
  } else if (!nudge(index, event)) return;
  L.DomEvent.stop(event);
}
function addPointMarker(index) {
  const { points } = sketch;
  const marker = L.marker(points[index], { icon: sketchIcon('point', 22), draggable: true, keyboard: true, pane: 'sketch', bubblingMouseEvents: false });
  marker.on('dragstart', () => { keepForUndo(); });
  marker.on('drag', () => { movePoint(index, marker.getLatLng()); placeMiddles(); followDrag(); });
  marker.on('dragend', () => { sketchChanged(); });
  marker.on('contextmenu', () => deletePoint(index));
  marker.on('click', () => { if (sketch.drawing && index + 1 === points.length) setDrawing(false); });
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
function drawSketch(context, view) {
  const { points, predicted, flight } = sketch;
  if (state.printing) return;  // a sketch is not the report's
  if (sketch.drawing && document.activeElement === $('map')) {
    const { x, y } = sketchPlane(map.getCenter());
    strokeTwice(context, new Path2D('M' + (view.x(x) - 9) + ' ' + view.y(y) + 'h18M' + view.x(x) + ' ' + (view.y(y) - 9) + 'v18'), ['#fff', 5], ['#000', 2]);
  }
  if (!points.length) return;
  const places = points.map(sketchPlane);
  if (sketch.pointer) {
    const last = places[places.length - 1], next = sketchPlane(sketch.pointer);
    context.strokeStyle = '#000';
    context.lineWidth = 2;
    strokeLine(context, view, [last.x, last.y, next.x, next.y], [4, 5]);
  }
  for (const [color, width] of [['#000', 8], ['#fff', 6]]) {
    context.strokeStyle = color;
    context.lineWidth = width;
    strokeLine(context, view, places.flatMap(({ x, y }) => [x, y]), []);
  }
  places.slice(1).forEach((place, i) => {
    const leg = predicted ? flight.legs.findIndex((one) => one.points[0] === i) : -1;
    const style = leg < 0 ? { color: '#555', dash: [] } : legStyles[statusNames[predicted.legs[leg].status]];
    context.strokeStyle = style.color;
    context.lineWidth = 3.5;
    strokeLine(context, view, [places[i].x, places[i].y, place.x, place.y], style.dash);
  });
  const worst = predicted && predicted.verdict === 2 && isKnown(predicted, flight) ? predicted.probability.worst : null;
  if (!worst) return;
  const stretch = flight.places.filter(([distance_m]) => distance_m >= worst.from_distance_m && distance_m <= worst.to_distance_m);
  context.globalAlpha = 0.45;
  context.strokeStyle = '#d5008a';
  context.lineWidth = 20;
  strokeLine(context, view, stretch.flatMap(([, x, y]) => [x, y]), []);
  context.globalAlpha = 1;
}
const sketchOnMap = element('div', '', 'sketch-on-map');
const sketchHint = element('p', '', 'sketch-hint');
sketchHint.setAttribute('role', 'status');
function toolButton(sign, label) {
  const button = element('button', sign);
  button.type = 'button';
  button.title = label;
  button.setAttribute('aria-label', label);
  return button;
}
const sketchTools = { draw: toolButton('✎', 'Draw a route'), undo: toolButton('↶', 'Undo the last step of the sketch') };

// ---- Prediction ----
function sayOnMap(words, type) {
  sketchOnMap.textContent = words;
  sketchOnMap.className = 'sketch-on-map' + (type ? ' badge ' + type : '');
}
function sketchChanged() {
  for (const button of [$('sketch-undo'), sketchTools.undo]) button.disabled = !sketch.history.length;
  $('sketch-clear').disabled = !sketch.points.length;
  placeMarkers();
  if (flown) map.getPane('route').style.opacity = sketch.points.length > 1 ? '0.35' : '';  // behind the sketch, which looks alike
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
// What decides beside the line, whichever it is, and is known of a planned flight.
function toldOfSketch(flight) {
  const planned = flown && whatIfData ? whatIfData : { disagreement: null, others: [] };
  const others = planned.others.filter((row) => ['scale_distortion', 'flight_sun', 'matchability_judged'].includes(row.name));
  return { ...sketchData, disagreement: planned.disagreement, others, matchable_fraction: flight.matchable_fraction };
}
function speedWords(flight) {
  const speeds = [...new Set(flight.speed_mps)].sort((a, b) => a - b);
  const assumed = !sketchData.points.length && speeds.length === 1 && speeds[0] === sketchData.speed_mps;
  return '; ' + (speeds.length > 2 ? speeds[0] + ' to ' + speeds[speeds.length - 1] : speeds.join(' and ')) + ' m/s' + (assumed ? ' (default)' : '') +
    ', a try every ' + Number($('sketch-interval').value) + ' s';
}
function heightWords() {
  const heights_m = sketch.points.map((point) => point.agl_m);
  const [least, most] = [Math.min(...heights_m), Math.max(...heights_m)].map((height_m) => Math.round(height_m));
  return (least === most ? least : least + ' to ' + most) + ' m';
}
// What is outside the tiles is not known, and counts as ground without fixes: P is at least what is said, and only GO is a verdict.
const isKnown = (predicted, flight) => !(flight.unknown_m > 0) || predicted.verdict === 0;
function saySketch(predicted, flight) {
  const { about } = predicted;
  const known = isKnown(predicted, flight);
  const status = known ? statusNames[predicted.verdict] : 'unknown';
  const word = known ? verdictNames[predicted.verdict] : 'NOT KNOWN';
  const outside = flight.unknown_m > 0 ? lengthWords(flight.unknown_m) + ' of it lie outside the tiles of this page, where nothing is known and no fix is counted on' : '';
  $('sketch-state').textContent = '';
  $('sketch-verdict').hidden = false;
  $('sketch-verdict').className = status;
  $('sketch-word').textContent = word;
  $('sketch-word').className = 'badge ' + status;
  $('sketch-figures').textContent = '· ' + lengthWords(flight.length_m) + ', ' + durationWords(flight.duration_s) + ', ' + heightWords() + ' above ground';
  $('sketch-answer').textContent = (about ? 'About: ' : '') + (known ? headlineSentence(predicted) :
    'P is at least ' + probabilityWords(predicted.probability.p_within_limit) + ': ' + outside + '. Prepare it, or draw over the tiles.');
  $('sketch-detail').textContent = predicted.detail + (known && outside ? '; ' + outside : '');
  $('sketch-assumes').textContent = predicted.assumptions + speedWords(flight) + (flight.untested ? '; P is beyond what it was tested on (' + display.tested_on + ')' : '') +
    (sketchData.without_p ? '; ' + sketchData.without_p + ' tiles without a P count as certain' : '') + (flight.step_m > sketchStep_m ? '; looked at every ' +
    lengthWords(flight.step_m) + ' of the way' : '');
  sayOnMap((about ? 'about ' : '') + word + ' · P ' + (known ? probabilityComparison(predicted.probability) : '≥ ' + probabilityWords(predicted.probability.p_within_limit)) +
    ' · ' + lengthWords(flight.length_m), status);
  if (layers.sketch) layers.sketch.redraw();
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
    forgetSketch(points.length === 1 ? 'A second point makes a route.' : points.length ? 'All points lie at one place.' : '');
    return null;
  }
  const work = predictFlight(flight, settings);
  let step = work.next();
  while (!step.done) step = work.next();
  const about = overAllLevels(step.value, sketchData);
  showSketch(shiftShares(about, sketch.shift), flight, settings, true);
  return { points, settings, about };
}
function showSketch(predicted, flight, settings, about) {
  if (!sketch.predicted) unfold($('sketch'));
  sketch.flight = flight;
  sketch.predicted = (about ? judgeAbout : judgeFlight)(predicted, settings, toldOfSketch(flight));
  saySketch(sketch.predicted, flight);
  drawSketchChart(sketch.predicted, flight);
  if (!about) fitChart();
  sayCommands(sketch.predicted, flight);
}
// About at once, then in full.
async function askSketch() {
  const run = ++sketch.run;
  clearTimeout(sketch.timer);
  window.cancelAnimationFrame(sketch.frame);
  sketch.frame = 0;
  const asked = answerAbout();
  if (asked === null) return;
  $('sketch-state').textContent = 'Computing …';
  const flight = flightOfSketch(asked.points, asked.settings, false);
  const predicted = await inSlices(predictFlight(flight, asked.settings), () => run !== sketch.run, () => {});
  if (predicted === null) return;
  sketch.shift = learnShift(asked.about.probability, predicted.probability);
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
    const x1 = x(gap.from_distance_m), x2 = x(gap.to_distance_m);
    parts.push(chartBand('gap ' + statusNames[gap.status], x1, x2, top, bottom, 'gap of ' + gapWords(gap) + ', error at its end ' +
      comparisonWords(gap.error_m, predicted.max_error_m)));
    if (gap.status === 2) parts.push(chartWords('gap-label', (x1 + x2) / 2, bottom - 6, '✕ ' + lengthWords(gap.to_distance_m - gap.from_distance_m)));
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
  const tick_m = tickStep(flight.length_m, 10);
  for (let i = 0; i * tick_m <= flight.length_m; ++i) {
    parts.push(chartWords('tick-x', x(i * tick_m), 318, Number((i * tick_m / 1000).toPrecision(6)) + ' km'));
  }
  flight.legs.reduce((begin_m, leg) => {
    if (begin_m > 0) parts.push(chartLine('axis-line', x(begin_m), top, x(begin_m), shareBottom));
    return begin_m + leg.length_m;
  }, 0);
  $('sketch-chart').replaceChildren(...parts);
  $('sketch-chart').setAttribute('aria-label', 'Sketched route: predicted position error, and the share of flights still within the limit, along the way. ' + predicted.text);
}
function sayCommands(predicted, flight) {
  $('sketch-mission').hidden = !sketchData.mission;
  const failed = predicted.verdict > 0;
  if (!sketchData.mission) {
    $('sketch-commands').textContent = 'Then prepare the mission with this route' + (failed ? ', or ask reroute for the cheapest line nearby that is GO.' : '.');
    return;
  }
  const name = nameOfSketch(sketchPoints());
  const gap = flight.unknown_m > 0 ? ' --allow-uncovered' : '';
  const line = (words, command) => [words, element('code', command), element('br')];
  $('sketch-commands').replaceChildren(...line('Save .plan and mission.json in the folder where the names of the imagery hold; the verdict: ', 'pilotage prepare ' + name + '.json' + gap + ' -o ' + name),
    ...(failed ? line('The cheapest line through these points that is GO (without --keep-waypoints: from the first to the last): ',
      'pilotage reroute ' + name + '.json --keep-waypoints' + gap + ' -o ' + name + '_rerouted.plan') : []));
}
function saveSketch(kind) {
  const points = sketchPoints(), settings = sketchSettings();
  if (settings === null) return;
  const makers = { plan: ['.plan', 'application/json', sketchAsPlan], waypoints: ['.waypoints', 'text/plain', sketchAsWaypoints],
    kml: ['.kml', 'application/vnd.google-earth.kml+xml', sketchAsKml], geojson: ['.geojson', 'application/geo+json', sketchAsGeoJson],
    mission: ['.json', 'application/json', () => sketchAsMission(points, settings)] };
  const [ending, type, make] = makers[kind];
  saveText(nameOfSketch(points) + ending, type, make(points));
}

// ---- Files ----
async function openSketch(file) {
  let read = null;
  try {
    read = await readRouteFile(file);
  } catch (error) {
    sayNotes([file.name + ' cannot be read in this page: it ' + (error instanceof SyntaxError ? 'is no JSON' : error.message) + '. The sketch stays as it was; prepare --route reads more kinds of files.']);
    return;
  }
  setSketch(read.points);
  sayNotes([file.name + ': ' + read.points.length + ' points', ...read.notes]);
  showWholeSketch();
}
const sayNotes = (notes) => $('sketch-notes').replaceChildren(...notes.map((note) => element('li', note)));
function showWholeSketch() {
  const line = L.latLngBounds(sketch.points);
  if (!wholeBounds().intersects(line)) sayNotes([...[...$('sketch-notes').children].map((item) => item.textContent), 'none of it lies on the ground of this page']);
  else if (!map.getBounds().contains(line)) map.fitBounds(line.pad(0.1));
}
function linkFiles() {
  const box = $('map');
  box.addEventListener('dragover', (event) => event.preventDefault());
  box.addEventListener('drop', (event) => {
    event.preventDefault();
    if (event.dataTransfer.files.length) openSketch(event.dataTransfer.files[0]);
  });
  $('sketch-file').addEventListener('change', () => {
    if ($('sketch-file').files.length) openSketch($('sketch-file').files[0]);
    $('sketch-file').value = '';  // so that the same file can be opened again
  });
}

// ---- Controls ----
function setDrawing(on) {
  sketch.drawing = on;
  sketch.pointer = null;
  for (const button of [$('sketch-draw'), sketchTools.draw]) button.setAttribute('aria-pressed', String(on));
  $('map').classList.toggle('drawing', on);
  sketchHint.textContent = on ? 'Click for each point; double-click or Escape ends. Drag points and the handles of legs; right-click or a long press takes a point out. By keyboard: arrow keys move the map, Enter sets a point in its middle (+).' : '';
  if (on) map.doubleClickZoom.disable(); else map.doubleClickZoom.enable();
}
// Whether a click on the map is the sketch's. A second one on the last point ends the drawing.
function sketchTakes(event) {
  if (!sketch.drawing) return false;
  const last = sketch.points[sketch.points.length - 1];
  const near_px = event.originalEvent.pointerType === 'touch' ? 24 : 8;
  if (last && map.latLngToContainerPoint(last).distanceTo(event.containerPoint) < near_px) setDrawing(false); else insertPoint(event.latlng, sketch.points.length);
  return true;
}
function sketchKeys(event) {
  if (event.key === 'Escape' && sketch.drawing) setDrawing(false);
  if (event.key === 'Backspace' && sketch.drawing && sketch.points.length && !(event.target instanceof Element && event.target.matches('input, .sketch-point'))) {
    keepForUndo();
    sketch.points.pop();
    sketchChanged();
  }
  if (event.key === 'Enter' && sketch.drawing && event.target === $('map')) {
    insertPoint(map.getCenter(), sketch.points.length);
    event.preventDefault();
  }
  const inField = event.target instanceof Element && event.target.matches('input, select, textarea');
  if ((event.ctrlKey || event.metaKey) && event.key === 'z' && !inField && sketch.history.length) {
    undoSketch();
    event.preventDefault();
  }
}
function makeSketch() {
  if (sketchData === null || !display.drawn) return;
  sketchData.models.forEach((model, i) => {
    if (i > 0 && sketchData.models[0].text.replace(' (default)', '') === model.text) return;  // it is the first
    const option = element('option', i === 0 ? (flown ? 'as planned: ' : '') + model.text : model.text);
    option.value = String(i);
    $('sketch-ins').append(option);
  });
  $('sketch-limit').value = sketchData.max_error_m;
  $('sketch-interval').value = sketchData.fix_interval_s;
  if (sketchData.points.length) $('sketch-speed').placeholder = 'as planned'; else $('sketch-speed').value = sketchData.speed_mps;
  $('sketch-planned').hidden = !sketchData.points.length;
  $('sketch').hidden = false;
  sketchTools.undo.disabled = true;
  moreLayers.push(['sketch', 'cursor', drawSketch]);
}
function linkSketch() {
  if (sketchData === null || !map) return;
  map.createPane('sketch').style.zIndex = 640;
  const control = L.control({ position: 'bottomleft' });
  control.onAdd = () => {
    const box = element('div');
    box.append(sketchHint, sketchOnMap);
    return box;
  };
  control.addTo(map);
  const tools = L.control({ position: 'topleft' });
  tools.onAdd = () => {
    const box = element('div', undefined, 'leaflet-bar sketch-bar');
    box.append(sketchTools.draw, sketchTools.undo);
    L.DomEvent.disableClickPropagation(box);
    return box;
  };
  tools.addTo(map);
  sketchTools.draw.addEventListener('click', () => setDrawing(!sketch.drawing));
  sketchTools.undo.addEventListener('click', undoSketch);
  map.on('mousemove', (event) => {
    if (!sketch.drawing || !sketch.points.length) return;
    sketch.pointer = event.latlng;
    layers.sketch.redraw();
  });
  map.on('zoomend', () => { if (sketch.points.length) placeMarkers(); });
  $('sketch-draw').addEventListener('click', () => {
    setDrawing(!sketch.drawing);
    if (sketch.drawing) $('map').scrollIntoView({ block: 'center' });
  });
  $('sketch-planned').addEventListener('click', () => setSketch(plannedPoints()));
  $('sketch-undo').addEventListener('click', undoSketch);
  $('sketch-clear').addEventListener('click', () => { setSketch([]); setDrawing(false); sayNotes([]); });
  document.querySelectorAll('[data-save]').forEach((button) => button.addEventListener('click', () => saveSketch(button.dataset.save)));
  linkFiles();
  if ($('cure-line')) {
    $('cure-line').hidden = !sketchData.points.length;
    $('cure-line').addEventListener('click', () => {
      setSketch(plannedPoints());
      $('map').scrollIntoView({ block: 'center' });
    });
  }
  document.addEventListener('keydown', sketchKeys);
  $('sketch-form').addEventListener('submit', (event) => event.preventDefault());
  for (const name of ['limit', 'ins', 'speed', 'interval']) {
    $('sketch-' + name).addEventListener('input', () => {
      ++sketch.run;  // what is being computed is of other settings
      sketch.shift = noShift;
      clearTimeout(sketch.timer);
      sketch.timer = setTimeout(askSketch, 300);
      if (sketch.points.length > 1) forgetSketch('Computing …');
    });
  }
}
