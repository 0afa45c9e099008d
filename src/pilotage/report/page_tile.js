// One tile: its picture, all its numbers, and why it is or is not chosen.
function drawPicture(i) {
  const canvas = $('tile-picture');
  const context = canvas.getContext('2d');
  const image = layers.imagery && layers.imagery.getElement();
  const imagery = image && image.complete && image.naturalWidth;
  canvas.hidden = !(sheet.ready || imagery);
  if (canvas.hidden) return;
  canvas.height = canvas.width;
  context.imageSmoothingQuality = 'high';
  if (sheet.ready) {
    const [left, top, side] = pictureSquare(i, 1);
    context.drawImage(sheet.image, left, top, side, side, 0, 0, canvas.width, canvas.height);
    return;
  }
  const flat = tileOutline(i);
  const [minX, minY, maxX, maxY] = display.edges_m;
  const xs = [0, 2, 4, 6].map((k) => flat[k]);
  const ys = [1, 3, 5, 7].map((k) => flat[k]);
  const perMetre = image.naturalWidth / (maxX - minX);
  const side = (Math.max(...xs) - Math.min(...xs)) * perMetre;
  context.drawImage(image, (Math.min(...xs) - minX) * perMetre, (maxY - Math.max(...ys)) * perMetre, side, side, 0, 0, canvas.width, canvas.height);
}
// Columns that no tile has a value in were not asked for.
const emptyColumns = report.tiles.columns.map((name, k) => tiles.every((row) => row[k] === null));
function fillTable(row) {
  const table = $('tile-table');
  table.replaceChildren();
  report.tiles.columns.forEach((name, k) => {
    if (name === 'tile_id' || name === 'reason' || name === 'reasons' || name === 'selected' || emptyColumns[k]) return;
    const line = element('tr');
    const head = element('th', report.tiles.labels[k]);
    head.scope = 'row';
    const cell = element('td', fieldText(row[k], name, report.tiles.units[k]));
    cell.dataset.name = name;
    line.append(head, cell);
    table.append(line);
  });
}
function showTile(i, move) {
  state.tile = i;
  const row = tiles[i];
  const id = String(valueOf(row, 'tile_id'));
  const selected = valueOf(row, 'selected');
  const p = valueOf(row, 'p_correct_fix');
  $('tile').hidden = false;
  $('tile-number').value = id;
  $('tile-title').textContent = 'Tile ' + id;
  $('tile-state').textContent = flown ? (selected ? 'chosen' : 'refused') : className(i);
  $('tile-state').className = 'badge ' + (flown ? (selected ? 'good' : 'refused') : ['good', 'marginal', 'bad'][display.classes[i]] || 'refused');
  $('tile-reasons').textContent = [p === null || (flown && !selected) ? '' : 'P(correct fix) ' + p.toFixed(2) + '.', valueOf(row, 'reason'), valueOf(row, 'reasons')]
    .filter((text) => text).join(' ');
  $('tile-hint').textContent = 'Tile ' + id + ': ' + (flown ? (selected ? 'chosen for the map.' : 'refused.') : className(i) + '.');
  const center = formatted(valueOf(row, 'center_lat_deg'), 6) + ', ' + formatted(valueOf(row, 'center_lon_deg'), 6);
  $('tile-center').textContent = center;
  $('tile-copy').dataset.copy = center;
  fillTable(row);
  $('tile').scrollTop = 0;
  loadSheet(() => { if (state.tile === i) drawPicture(i); });
  drawPicture(i);
  if (!map) return;
  if (valueOf(row, 'level') !== state.level) setLevel(valueOf(row, 'level'));
  redrawMarks();
  const flat = display.cells_m[i];
  const beside = getComputedStyle($('tile')).position === 'absolute' ? $('tile').offsetWidth + 40 : 60;
  const middle = toLatLng((flat[0] + flat[4]) / 2, (flat[1] + flat[5]) / 2);
  if (move || beside > 60) map.panInside(middle, { paddingTopLeft: [60, 60], paddingBottomRight: [beside, 60], animate: false });
}
function closeTile() {
  if ($('tile').hidden) return;
  const inside = $('tile').contains(document.activeElement);
  state.tile = -1;
  $('tile').hidden = true;
  $('tile-hint').textContent = 'Click a tile on the map, or type its number (above).';
  redrawMarks();
  if (inside) (map ? $('map') : $('more')).focus();
}
function makeTileControls() {
  $('tile-number').addEventListener('change', () => {
    const wanted = Number($('tile-number').value);
    const i = tiles.findIndex((row) => valueOf(row, 'tile_id') === wanted);
    if (i >= 0) showTile(i, true); else $('tile-hint').textContent = 'There is no tile ' + $('tile-number').value + '.';
  });
  const step = (by) => { if (tiles.length) showTile(Math.min(tiles.length - 1, Math.max(0, state.tile + by)), true); };
  $('tile-previous').addEventListener('click', () => step(-1));
  $('tile-next').addEventListener('click', () => step(1));
  $('tile-close').addEventListener('click', closeTile);
  document.addEventListener('keydown', (event) => { if (event.key === 'Escape') closeTile(); });
}
