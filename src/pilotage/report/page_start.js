// Copying, jumping, printing; then everything is made.
function copyBySelection(button) {
  const range = document.createRange();
  range.selectNodeContents(button.parentElement.querySelector('code'));
  const selection = window.getSelection();
  selection.removeAllRanges();
  selection.addRange(range);
  return document.execCommand('copy');
}
function makeButtons() {
  document.querySelectorAll('button.copy').forEach((button) => {
    button.addEventListener('click', async () => {
      let done = false;
      try {
        await navigator.clipboard.writeText(button.dataset.copy);
        done = true;
      } catch (error) {
        done = copyBySelection(button);
      }
      button.textContent = done ? 'Copied' : 'Press Ctrl+C';
      setTimeout(() => { button.textContent = 'Copy'; }, 1500);
    });
  });
  document.querySelectorAll('button.show').forEach((button) => {
    button.addEventListener('click', () => showStretch(Number(button.dataset.from), Number(button.dataset.to)));
  });
}

// On paper the map shows the whole corridor, as wide as the page. Browsers lay the page out
// for paper after `beforeprint`, so the map gets the size of the paper here: A4 less the margins of the style sheet.
// A canvas drawn at this moment is printed without its transparency, so all layers are put together on one.
const paper_px = { width: 700, height: 400 };
const beforePrint = { center: null, zoom: 0, minZoom: 0, picture: null };
function mapPicture() {
  const canvas = document.createElement('canvas');
  canvas.width = 3 * paper_px.width;
  canvas.height = 3 * paper_px.height;
  canvas.className = 'paper';
  const context = canvas.getContext('2d');
  context.scale(3, 3);
  context.fillStyle = '#d9dde1';
  context.fillRect(0, 0, paper_px.width, paper_px.height);
  const place = (corner) => map.layerPointToContainerPoint(corner);
  if (layers.imagery && map.hasLayer(layers.imagery)) {
    const bounds = wholeBounds();
    const from = map.latLngToContainerPoint(bounds.getNorthWest());
    const to = map.latLngToContainerPoint(bounds.getSouthEast());
    context.drawImage(layers.imagery.getElement(), from.x, from.y, to.x - from.x, to.y - from.y);
  }
  ['detail', 'heat', 'untested', 'classes', 'refused', 'selected', 'denied', 'true-places', 'lost', 'gaps', 'route', ...moreLayers.map(([name]) => name), 'grid', 'marks']
    .filter((name) => layers[name] && map.hasLayer(layers[name])).forEach((name) => {
    const layer = layers[name];
    const corner = place(layer.corner);
    context.globalAlpha = name === 'heat' || name === 'untested' ? Number($('opacity').value) / 100 : 1;
    context.drawImage(layer.canvas, corner.x, corner.y, layer.size.x, layer.size.y);
  });
  return canvas;
}
function preparePrint() {
  if (state.printing) return;
  state.printing = true;
  if (flown) showFlight();
  if (!map) return;
  Object.assign(beforePrint, { center: map.getCenter(), zoom: map.getZoom(), minZoom: map.getMinZoom() });
  $('map').style.width = paper_px.width + 'px';
  $('map').style.height = paper_px.height + 'px';
  map.setMinZoom(0);
  map.invalidateSize({ animate: false, pan: false });
  map.fitBounds(wholeBounds(), { animate: false });
  if (!$('show-grid').checked) layers.grid.addTo(map);
  beforePrint.picture = mapPicture();
  $('map').classList.add('printing');
  $('map').append(beforePrint.picture);
}
function endPrint() {
  if (!state.printing) return;
  state.printing = false;
  if (flown) showFlight();
  if (!map) return;
  beforePrint.picture.remove();
  if (!$('show-grid').checked) layers.grid.remove();
  $('map').classList.remove('printing');
  $('map').style.width = '';
  $('map').style.height = '';
  map.invalidateSize({ animate: false, pan: false });
  map.setView(beforePrint.center, beforePrint.zoom, { animate: false });
  map.setMinZoom(beforePrint.minZoom);
}

makePanel();
makeTileControls();
if (flown) {
  linkChart();
  makeSeen();
  makeWhatIf();
}
makeButtons();
makeFolds();
makeSketch();
if (display.drawn) makeMap(); else $('map').append(element('p', display.missing, 'missing'));
linkSketch();
fitChart();
window.addEventListener('resize', fitChart);
window.addEventListener('beforeprint', preparePrint);
window.addEventListener('afterprint', endPrint);
// For the browser's console and for tests.
window.pilotage = { report, display, state, layers, map, placeAlong, toLatLng, tileOutline, whatIf: flown ? whatIf : null, sketch, sketchData };
