// What the camera will see: the rendered frame nearest to the place on the route, the map's tile turned the same way at the
// same scale, and what was found there on another date.
const seen = { image: null, ready: false, shown: -1 };

function nearestFrame(distance) {
  const frames = display.seen.frames;
  return frames.reduce((best, frame, i) => (Math.abs(frame[0] - distance) < Math.abs(frames[best][0] - distance) ? i : best), 0);
}
function clearedContext(canvas, width, height) {
  canvas.width = width;
  canvas.height = height;
  const context = canvas.getContext('2d');
  context.fillStyle = 'rgb(192, 192, 192)';
  context.fillRect(0, 0, width, height);
  context.imageSmoothingQuality = 'high';
  return context;
}
function drawSeenFrame(i) {
  const { width_px, height_px, step_px, columns } = display.seen;
  const context = clearedContext($('seen-frame'), 2 * width_px, 2 * height_px);
  if (!seen.ready) return;
  context.drawImage(seen.image, i % columns * step_px[0], Math.floor(i / columns) * step_px[1], width_px, height_px, 0, 0, 2 * width_px, 2 * height_px);
}
// The picture of the tile as the frame's camera would look at it: metres of the plane become metres on the ground, the
// direction of flight is up.
function drawSeenTile(frame) {
  const [distance, azimuth_deg, , width_m, i] = frame;
  const { width_px, height_px } = display.seen;
  const context = clearedContext($('seen-tile'), 2 * width_px, 2 * height_px);
  if (i === null || !sheet.ready || !display.drawn) return;
  const [x, y] = placeAlong(distance);
  const groundShare = 1 / Math.cosh(y / earthRadius_m);  // cosine of the latitude
  const s = Math.sin(azimuth_deg * Math.PI / 180), c = Math.cos(azimuth_deg * Math.PI / 180);
  const perMetre = 2 * width_px / width_m * groundShare;
  const onCanvas = (px, py) => [width_px + ((px - x) * c - (py - y) * s) * perMetre, height_px - ((px - x) * s + (py - y) * c) * perMetre];
  const flat = tileOutline(i);
  const [left, top, side] = pictureSquare(i, 1);
  const a = onCanvas(flat[0], flat[1]), b = onCanvas(flat[2], flat[3]), d = onCanvas(flat[6], flat[7]);
  context.setTransform((b[0] - a[0]) / side, (b[1] - a[1]) / side, (d[0] - a[0]) / side, (d[1] - a[1]) / side, a[0], a[1]);
  context.drawImage(sheet.image, left, top, side, side, 0, 0, side, side);
  context.setTransform(1, 0, 0, 1, 0, 0);
}
const seenValue = (row, name) => (column[name] === undefined ? null : valueOf(row, name));
// What another date says of the tile; "" where none was looked at.
function foundText(i) {
  const row = tiles[i];
  const said = [];
  const ncc = seenValue(row, 'epoch_ncc');
  if (ncc !== null) {
    const more = [['epoch_margin', (value) => Math.abs(value).toFixed(2) + (value < 0 ? ' below' : ' above') + ' the best wrong place'],
      ['epoch_survival', (value) => percentWords(value) + ' of the features found again'],
      ['epoch_disagreement_m', (value) => 'georeferences ' + value.toFixed(1) + ' m apart']];
    said.push('Second date: its picture of this tile correlates with the map by ' + ncc.toFixed(2) + more.map(([name, words]) => {
      const value = seenValue(row, name);
      return value === null ? '' : ', ' + words(value);
    }).join('') + '.');
  }
  for (const [, outcome, error_m] of display.found.filter((entry) => entry[0] === i).slice(0, 3)) {
    said.push('Evaluated: ' + { correct: 'found, and accepted', false: 'a wrong place was accepted', refused: 'refused', not_covered: 'not covered by the other date' }[outcome] +
      (error_m === null ? '' : ', ' + error_m.toFixed(1) + ' m from its place') + '.');
  }
  return said.join(' ');
}
function showSeen(distance) {
  if (!display.seen) return;
  const k = nearestFrame(distance);
  if (seen.shown === k) return;
  seen.shown = k;
  const frame = display.seen.frames[k];
  const [at_m, azimuth_deg, agl_m, width_m, i] = frame;
  drawSeenFrame(k);
  drawSeenTile(frame);
  const place = (at_m / 1000).toFixed(2) + ' km, heading ' + azimuth_deg.toFixed(0) + '°, ' + agl_m.toFixed(0) + ' m above ground';
  $('seen-frame-text').textContent = 'The camera at ' + place + ': ' + width_m.toFixed(0) + ' m of ground across.';
  $('seen-frame').setAttribute('aria-label', 'Rendered frame at ' + place);
  const row = i === null ? null : tiles[i];
  const p = row === null ? null : valueOf(row, 'p_correct_fix');
  const words = row === null ? 'The plan has no tile here.' : 'Tile ' + valueOf(row, 'tile_id') + ' of the imagery, turned the same way: ' +
    (valueOf(row, 'selected') ? 'chosen for the map' : 'not in the map') + (p === null ? '' : ', P(correct fix) ' + p.toFixed(2)) + '.';
  $('seen-tile-text').textContent = words;
  $('seen-tile').setAttribute('aria-label', words);
  const found = row === null ? '' : foundText(i);
  $('seen-found').textContent = found || 'No other date was looked at here: how this ground looks in another season or light is not known.';
}
function makeSeen() {
  if (!display.seen) return;
  const again = () => {
    const k = seen.shown;
    if (k < 0) return;
    drawSeenFrame(k);
    drawSeenTile(display.seen.frames[k]);
  };
  seen.image = new Image();
  seen.image.addEventListener('load', () => { seen.ready = true; again(); });
  seen.image.src = display.seen.jpeg;
  loadSheet(again);
  const second = report.inputs.filter((input) => input.role === 'second_epoch').map((input) => input.name + (input.date ? ' of ' + input.date : ''));
  $('seen-note').textContent = (display.seen.second_date ? 'The frame is rendered from the second date (' + second.join(', ') + '), registered to the map: its season, its shadows, its light. '
    : 'The frame is rendered from the very imagery of the map: it shows no other season, no other shadows, no other light. ') +
    'Gray, as the matcher takes it; level flight over flat ground; the direction of flight is up. Of ' + display.seen.frames.length +
    ' places along the route the one nearest to the slider. Plain gray: no picture there.';
  $('seen').hidden = false;
  showSeen(0);
}
