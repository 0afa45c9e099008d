'use strict';
(function () {
  const data = JSON.parse(document.getElementById('data').textContent);
  const report = data.report;
  const display = data.display;
  const column = {};
  report.tiles.columns.forEach((name, i) => { column[name] = i; });
  const tiles = report.tiles.rows;
  const $ = (id) => document.getElementById(id);
  const valueOf = (row, name) => row[column[name]];

  // ---- Words and numbers ----
  function formatted(value, decimals) {
    return value === null || value === undefined ? '–' : value.toFixed(decimals);
  }
  function fieldText(value, name, unit) {
    if (value === null) return '–';
    if (typeof value === 'boolean') return value ? 'yes' : 'no';
    if (typeof value === 'string') return name === 'status' ? value.replaceAll('_', ' ') : value;
    return String(value) + (unit ? ' ' + unit : '');
  }
  function element(tag, text, className) {
    const node = document.createElement(tag);
    if (text !== undefined) node.textContent = text;
    if (className) node.className = className;
    return node;
  }

  // ---- State: what is shown ----
  const levels = [...new Set(tiles.map((row) => valueOf(row, 'level')))].sort((a, b) => a - b);
  const measured = report.measures.findIndex((m) => m.least !== null);
  const state = { measure: Math.max(0, measured), level: levels.length ? levels[0] : 0, threshold: null, tile: -1 };
  const scaleOf = (m) => report.measures[m];
  const decimalsOf = (m) => display.decimals[m];
  function thresholdValue() {
    const scale = scaleOf(state.measure);
    return scale.low + (scale.high - scale.low) * Number($('threshold').value) / 200;
  }
  function passes(i) {
    if (state.threshold === null) return true;
    const value = valueOf(tiles[i], scaleOf(state.measure).name);
    return value !== null && value >= state.threshold;
  }

  // ---- Map ----
  const plane = L.Projection.SphericalMercator;
  const toLatLng = (x, y) => plane.unproject(L.point(x, y));
  function lineLatLngs(flat) {
    const points = [];
    for (let i = 0; i < flat.length; i += 2) points.push(toLatLng(flat[i], flat[i + 1]));
    return points;
  }
  let map = null;
  const layers = {};
  const heatCells = [];
  let cursorMarker = null;
  let tileOutline = null;

  function hatchPattern() {
    const canvas = document.createElement('canvas');
    canvas.width = canvas.height = 8;
    const context = canvas.getContext('2d');
    context.fillStyle = 'rgba(200,200,200,0.55)';
    context.fillRect(0, 0, 8, 8);
    context.strokeStyle = 'rgba(20,20,20,0.9)';
    context.lineWidth = 1.6;
    context.beginPath();
    for (const shift of [-8, 0, 8]) { context.moveTo(shift, 8); context.lineTo(shift + 8, 0); }
    context.stroke();
    return context.createPattern(canvas, 'repeat');
  }

  function cellStyle(i) {
    const index = display.shades[state.measure][i];
    const hidden = valueOf(tiles[i], 'level') !== state.level;
    if (hidden) return { fill: false, stroke: false };
    if (index < 0) return { fill: true, stroke: false, fillColor: cellStyle.hatch, fillOpacity: 1 };
    const color = display.colors[display.color_maps[state.measure]][index];
    if (!passes(i)) return { fill: true, stroke: false, fillColor: '#30343a', fillOpacity: 0.55 };
    return { fill: true, stroke: true, fillColor: color, color: color, weight: 0.7, fillOpacity: 1 };
  }

  // The edge around the selected areas: sides of selected cells without a selected neighbour.
  function selectedEdges(level) {
    const key = (c, r) => c + ',' + r;
    const selected = new Map();
    tiles.forEach((row, i) => {
      if (valueOf(row, 'selected') && valueOf(row, 'level') === level) selected.set(key(valueOf(row, 'column'), valueOf(row, 'row')), i);
    });
    const edges = [];
    for (const i of selected.values()) {
      const c = valueOf(tiles[i], 'column');
      const r = valueOf(tiles[i], 'row');
      const p = lineLatLngs(display.cells_m[i]);
      if (!selected.has(key(c, r - 1))) edges.push([p[0], p[1]]);
      if (!selected.has(key(c + 1, r))) edges.push([p[1], p[2]]);
      if (!selected.has(key(c, r + 1))) edges.push([p[2], p[3]]);
      if (!selected.has(key(c - 1, r))) edges.push([p[3], p[0]]);
    }
    return edges;
  }

  const legStyles = {
    good: { color: '#0072b2', weight: 4 },
    marginal: { color: '#e69f00', weight: 4, dashArray: '12 7' },
    bad: { color: '#d5008a', weight: 6, dashArray: '4 7', lineCap: 'butt' },
  };

  function addControls() {
    const north = L.control({ position: 'topright' });
    north.onAdd = () => {
      const node = element('div', undefined, 'north');
      node.append(element('div', '▲'), element('div', 'N'));
      return node;
    };
    north.addTo(map);
    L.control.scale({ imperial: false, maxWidth: 180 }).addTo(map);
    const where = L.control({ position: 'bottomright' });
    const node = element('div', '', 'where');
    where.onAdd = () => node;
    where.addTo(map);
    map.on('mousemove', (event) => {
      const point = event.latlng.wrap();
      node.textContent = point.lat.toFixed(6) + ', ' + point.lng.toFixed(6);
    });
  }

  function makeMap() {
    const [minX, minY, maxX, maxY] = display.edges_m;
    const bounds = L.latLngBounds(toLatLng(minX, minY), toLatLng(maxX, maxY));
    map = L.map('map', { attributionControl: false, zoomSnap: 0.25, zoomDelta: 0.5, maxZoom: 23, maxBoundsViscosity: 0.6,
      fadeAnimation: false });
    map.fitBounds(bounds);
    map.setMaxBounds(bounds.pad(0.6));
    map.setMinZoom(map.getZoom() - 2);
    [['imagery', 250], ['heat', 300], ['outline', 420], ['route', 440], ['cursor', 460]].forEach(([name, order]) => {
      map.createPane(name).style.zIndex = order;
    });
    if (display.imagery) layers.imagery = L.imageOverlay(display.imagery, bounds, { pane: 'imagery', alt: 'Imagery of the corridor' }).addTo(map);
    cellStyle.hatch = hatchPattern();
    const heatCanvas = L.canvas({ pane: 'heat', padding: 0.2 });
    layers.heat = L.layerGroup();
    display.cells_m.forEach((flat, i) => {
      const cell = L.polygon(lineLatLngs(flat), Object.assign({ pane: 'heat', renderer: heatCanvas, interactive: false, noClip: true,
        smoothFactor: 0 }, cellStyle(i)));
      heatCells.push(cell);
      layers.heat.addLayer(cell);
    });
    layers.heat.addTo(map);
    layers.outlineCanvas = L.canvas({ pane: 'outline', padding: 0.2 });
    addRoute();
    addControls();
    drawSelected();
    setOpacity();
    map.on('click', (event) => {
      const found = tileAt(plane.project(event.latlng));
      if (found >= 0) showTile(found, false);
    });
    map.on('mousemove', (event) => hoverRoute(event));
  }

  function addRoute() {
    const svg = L.svg({ pane: 'route', padding: 0.3 });
    const options = { pane: 'route', renderer: svg, interactive: false, smoothFactor: 1 };
    layers.route = L.layerGroup();
    display.gap_lines_m.forEach((flat, i) => {
      const color = report.route.gaps[i].within_limit ? '#e69f00' : '#d5008a';
      layers.route.addLayer(L.polyline(lineLatLngs(flat), Object.assign({ color: color, weight: 18, opacity: 0.6, lineCap: 'butt' }, options)));
    });
    display.leg_lines_m.forEach((flat, i) => {
      const points = lineLatLngs(flat);
      layers.route.addLayer(L.polyline(points, Object.assign({ color: '#fff', weight: 8, opacity: 0.9 }, options)));
      layers.route.addLayer(L.polyline(points, Object.assign({}, legStyles[report.route.legs[i].status], options)));
    });
    layers.route.addTo(map);
  }

  function drawSelected() {
    if (!map) return;
    if (layers.selected) layers.selected.remove();
    const edges = selectedEdges(state.level);
    const options = { pane: 'outline', renderer: layers.outlineCanvas, interactive: false, smoothFactor: 0 };
    layers.selected = L.layerGroup([
      L.polyline(edges, Object.assign({ color: '#000', weight: 4 }, options)),
      L.polyline(edges, Object.assign({ color: '#fff', weight: 1.8 }, options)),
    ]);
    if ($('show-selected').checked) layers.selected.addTo(map);
  }

  function inside(flat, x, y) {
    let sign = 0;
    for (let k = 0; k < 4; ++k) {
      const ax = flat[2 * k], ay = flat[2 * k + 1];
      const bx = flat[(2 * k + 2) % 8], by = flat[(2 * k + 3) % 8];
      const cross = (bx - ax) * (y - ay) - (by - ay) * (x - ax);
      if (cross === 0) continue;
      if (sign !== 0 && Math.sign(cross) !== sign) return false;
      sign = Math.sign(cross);
    }
    return true;
  }
  function tileAt(point) {
    return tiles.findIndex((row, i) => valueOf(row, 'level') === state.level && inside(display.cells_m[i], point.x, point.y));
  }

  function recolor() {
    heatCells.forEach((cell, i) => cell.setStyle(cellStyle(i)));
    countThreshold();
  }

  // ---- Panel ----
  function radio(name, index, text, checked, change) {
    const label = element('label');
    const input = element('input');
    input.type = 'radio';
    input.name = name;
    input.value = String(index);
    input.checked = checked;
    input.addEventListener('change', change);
    label.append(input, ' ' + text);
    return label;
  }
  function showScale() {
    const scale = scaleOf(state.measure);
    const colors = display.colors[display.color_maps[state.measure]];
    const stops = [];
    for (let i = 0; i < 256; i += 15) stops.push(colors[i]);
    $('scale-bar').style.background = 'linear-gradient(to right,' + stops.join(',') + ')';
    const decimals = decimalsOf(state.measure);
    $('scale-low').textContent = (scale.least !== null && scale.least < scale.low ? '≤ ' : '') + formatted(scale.low, decimals);
    $('scale-high').textContent = (scale.most !== null && scale.most > scale.high ? '≥ ' : '') + formatted(scale.high, decimals);
    $('scale-unit').textContent = scale.unit === '1' ? '(no unit)' : scale.unit;
    $('scale-meaning').textContent = '· ' + scale.meaning;
  }
  function countThreshold() {
    if (state.threshold === null) {
      $('threshold-count').textContent = '';
      return;
    }
    let all = 0, above = 0, selectedBelow = 0;
    tiles.forEach((row, i) => {
      if (valueOf(row, 'level') !== state.level) return;
      ++all;
      if (passes(i)) ++above; else if (valueOf(row, 'selected')) ++selectedBelow;
    });
    const scale = scaleOf(state.measure);
    $('threshold-count').textContent = above + ' of ' + all + ' tiles at or above ' + formatted(state.threshold, decimalsOf(state.measure)) +
      (scale.unit === '1' ? '' : ' ' + scale.unit) + '; ' + selectedBelow + ' selected tiles below';
  }
  function updateThreshold() {
    state.threshold = $('threshold-on').checked ? thresholdValue() : null;
    recolor();
  }
  function setOpacity() {
    if (map) map.getPane('heat').style.opacity = String(Number($('opacity').value) / 100);
  }
  function toggle(id, name) {
    $(id).addEventListener('change', () => {
      if (!map || !layers[name]) return;
      if ($(id).checked) layers[name].addTo(map); else layers[name].remove();
    });
  }
  function makePanel() {
    report.measures.forEach((measure, i) => {
      $('measures').append(radio('measure', i, measure.label, i === state.measure, () => {
        state.measure = i;
        showScale();
        updateThreshold();
      }));
    });
    if (levels.length > 1) {
      levels.forEach((level) => {
        $('levels').append(radio('level', level, 'Level ' + level, level === state.level, () => {
          state.level = level;
          drawSelected();
          recolor();
        }));
      });
    }
    showScale();
    $('opacity').addEventListener('input', setOpacity);
    $('threshold').addEventListener('input', () => { $('threshold-on').checked = true; updateThreshold(); });
    $('threshold-on').addEventListener('change', updateThreshold);
    toggle('show-imagery', 'imagery');
    toggle('show-heat', 'heat');
    toggle('show-selected', 'selected');
    toggle('show-route', 'route');
    $('tile-number').addEventListener('change', () => {
      const wanted = Number($('tile-number').value);
      const i = tiles.findIndex((row) => valueOf(row, 'tile_id') === wanted);
      if (i >= 0) showTile(i, true); else $('tile-hint').textContent = 'There is no tile ' + $('tile-number').value + '.';
    });
    $('tile-previous').addEventListener('click', () => { if (tiles.length) showTile(Math.max(0, state.tile - 1), true); });
    $('tile-next').addEventListener('click', () => { if (tiles.length) showTile(Math.min(tiles.length - 1, state.tile + 1), true); });
  }

  // ---- One tile ----
  // The tile itself is larger than its cell by tile size / stride.
  function tileOutlineFlat(i) {
    const level = report.grid.levels.find((entry) => entry.level === valueOf(tiles[i], 'level'));
    const grow = Math.max(1, level.tile_size_px / level.stride_px);
    const flat = display.cells_m[i];
    const cx = (flat[0] + flat[2] + flat[4] + flat[6]) / 4;
    const cy = (flat[1] + flat[3] + flat[5] + flat[7]) / 4;
    return flat.map((value, k) => (k % 2 === 0 ? cx + (value - cx) * grow : cy + (value - cy) * grow));
  }
  function showPicture(flat) {
    const canvas = $('tile-picture');
    const image = layers.imagery && layers.imagery.getElement();
    if (!image || !image.complete || !image.naturalWidth) return;
    const [minX, minY, maxX, maxY] = display.edges_m;
    const perMetre = image.naturalWidth / (maxX - minX);
    const xs = [0, 2, 4, 6].map((k) => flat[k]);
    const ys = [1, 3, 5, 7].map((k) => flat[k]);
    const left = (Math.min(...xs) - minX) * perMetre;
    const top = (maxY - Math.max(...ys)) * perMetre;
    const width = (Math.max(...xs) - Math.min(...xs)) * perMetre;
    const height = (Math.max(...ys) - Math.min(...ys)) * perMetre;
    canvas.width = 240;
    canvas.height = Math.max(1, Math.round(240 * height / width));
    canvas.hidden = false;
    canvas.getContext('2d').drawImage(image, left, top, width, height, 0, 0, canvas.width, canvas.height);
  }
  function showTile(i, move) {
    state.tile = i;
    const row = tiles[i];
    $('tile-number').value = String(valueOf(row, 'tile_id'));
    $('tile-hint').textContent = valueOf(row, 'selected') ? 'Selected for the map.' : 'Not selected. ' + valueOf(row, 'reason');
    const table = $('tile-table');
    table.replaceChildren();
    report.tiles.columns.forEach((name, k) => {
      if (name === 'tile_id' || name === 'reason') return;
      const line = element('tr');
      const head = element('th', report.tiles.labels[k]);
      head.scope = 'row';
      const cell = element('td', fieldText(row[k], name, report.tiles.units[k]));
      cell.dataset.name = name;
      line.append(head, cell);
      table.append(line);
    });
    if (!map) return;
    const flat = tileOutlineFlat(i);
    showPicture(flat);
    if (valueOf(row, 'level') !== state.level) {
      state.level = valueOf(row, 'level');
      document.querySelectorAll('input[name="level"]').forEach((input) => { input.checked = Number(input.value) === state.level; });
      drawSelected();
      recolor();
    }
    if (tileOutline) tileOutline.remove();
    const points = lineLatLngs(flat);
    tileOutline = L.layerGroup([
      L.polygon(points, { pane: 'cursor', color: '#000', weight: 5, fill: false, interactive: false }),
      L.polygon(points, { pane: 'cursor', color: '#ffe94d', weight: 2.5, fill: false, interactive: false }),
    ]).addTo(map);
    if (move) map.panInside(points[0], { padding: [80, 80] });
  }

  // ---- Chart and map, linked both ways ----
  const chart = $('chart');
  const axes = ['left', 'right', 'top', 'bottom', 'distanceM', 'errorM'].reduce((all, name) => {
    all[name] = Number(chart.dataset[name]);
    return all;
  }, {});
  // Index of the last entry whose distance (first element) is not beyond `distance`.
  function lastBefore(rows, distance) {
    let low = 0, high = rows.length - 1;
    while (low < high) {
      const middle = (low + high + 1) >> 1;
      if (rows[middle][0] <= distance) low = middle; else high = middle - 1;
    }
    return low;
  }
  function between(rows, distance, k) {
    const i = lastBefore(rows, distance);
    const a = rows[i];
    const b = rows[Math.min(i + 1, rows.length - 1)];
    if (a[k] === null || b[k] === null) return null;
    const share = b[0] > a[0] ? Math.min(1, Math.max(0, (distance - a[0]) / (b[0] - a[0]))) : 0;
    return a[k] + share * (b[k] - a[k]);
  }
  function setAlong(distance, fromSlider) {
    const rows = report.route.error_profile.rows;
    const error = rows.length ? between(rows, distance, 1) : null;
    const fix = report.route.fixes.some((stretch) => distance >= stretch.from_distance_m && distance <= stretch.to_distance_m);
    const x = axes.left + distance / axes.distanceM * (axes.right - axes.left);
    const share = error === null ? 1 : Math.min(1, error / axes.errorM);
    const y = axes.bottom - share * (axes.bottom - axes.top);
    const cursor = $('chart-cursor');
    cursor.setAttribute('visibility', 'visible');
    cursor.querySelector('line').setAttribute('x1', x);
    cursor.querySelector('line').setAttribute('x2', x);
    cursor.querySelector('circle').setAttribute('cx', x);
    cursor.querySelector('circle').setAttribute('cy', y);
    $('along-text').textContent = (distance / 1000).toFixed(2) + ' km: ' + (error === null ? 'error unknown' : 'error ' + error.toFixed(1) + ' m') +
      (fix ? ', over selected tiles' : ', no fix');
    if (!fromSlider) $('along').value = String(Math.round(1000 * distance / axes.distanceM));
    if (!map || !display.places_m.length) return;
    const point = toLatLng(between(display.places_m, distance, 1), between(display.places_m, distance, 2));
    if (!cursorMarker) {
      cursorMarker = L.circleMarker(point, { pane: 'cursor', radius: 8, color: '#000', weight: 3, fillColor: '#ffe94d', fillOpacity: 1,
        interactive: false }).addTo(map);
    } else {
      cursorMarker.setLatLng(point);
    }
  }
  function hoverRoute(event) {
    let best = -1, bestSquare = 14 * 14;
    display.places_m.forEach((place, i) => {
      const at = map.latLngToContainerPoint(toLatLng(place[1], place[2]));
      const square = (at.x - event.containerPoint.x) ** 2 + (at.y - event.containerPoint.y) ** 2;
      if (square < bestSquare) { bestSquare = square; best = i; }
    });
    if (best >= 0) setAlong(display.places_m[best][0], false);
  }
  function linkChart() {
    chart.addEventListener('pointermove', (event) => {
      const box = chart.getBoundingClientRect();
      const x = (event.clientX - box.left) / box.width * chart.viewBox.baseVal.width;
      const share = (x - axes.left) / (axes.right - axes.left);
      if (share >= 0 && share <= 1) setAlong(share * axes.distanceM, false);
    });
    $('along').addEventListener('input', () => setAlong(Number($('along').value) / 1000 * axes.distanceM, true));
  }

  // ---- Coordinates to copy ----
  function copyBySelection(button) {
    const range = document.createRange();
    range.selectNodeContents(button.parentElement.querySelector('code'));
    const selection = window.getSelection();
    selection.removeAllRanges();
    selection.addRange(range);
    return document.execCommand('copy');
  }
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

  makePanel();
  linkChart();
  if (display.drawn) makeMap(); else $('map').append(element('p', display.missing, 'missing'));
  window.addEventListener('beforeprint', () => {
    document.querySelectorAll('details').forEach((details) => { details.open = true; });
    if (map) map.invalidateSize({ animate: false });
  });
  window.addEventListener('afterprint', () => { if (map) map.invalidateSize({ animate: false }); });
}());
