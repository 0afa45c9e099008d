// Layers of the map that are drawn on a canvas: a handful of canvases for any number of tiles.

// A canvas somewhat larger than the map, so that a drag shows no blank edge; drawn anew when the map has moved, has been
// zoomed, or is dragged beyond it. `draw` gets the context and a view: x(m) and y(m) in pixels, scale (pixels per metre),
// and whether a box [min x, min y, max x, max y] at `k` of an array is in sight.
const CanvasLayer = L.Layer.extend({
  initialize: function (pane, draw) { L.setOptions(this, { pane: pane }); this.draw = draw; },
  onAdd: function () {
    this.canvas = document.createElement('canvas');
    this.getPane().appendChild(this.canvas);
    this.redraw();
  },
  onRemove: function () { this.canvas.remove(); },
  getEvents: function () {
    return { viewreset: this.redraw, moveend: this.redraw, zoom: this.redraw, resize: this.redraw, move: this.follow };
  },
  follow: function () {
    const corner = this._map.containerPointToLayerPoint([0, 0]);
    const size = this._map.getSize();
    const inside = corner.x >= this.corner.x && corner.y >= this.corner.y && corner.x + size.x <= this.corner.x + this.size.x &&
      corner.y + size.y <= this.corner.y + this.size.y;
    if (!inside) this.redraw();
  },
  redraw: function () {
    const map = this._map;
    if (!map) return;
    const size = map.getSize();
    const pad = size.multiplyBy(0.25).round();
    this.corner = map.containerPointToLayerPoint(pad.multiplyBy(-1)).round();
    this.size = size.add(pad.multiplyBy(2));
    const ratio = state.printing ? 3 : window.devicePixelRatio || 1;
    const canvas = this.canvas;
    canvas.width = Math.round(this.size.x * ratio);
    canvas.height = Math.round(this.size.y * ratio);
    canvas.style.width = this.size.x + 'px';
    canvas.style.height = this.size.y + 'px';
    L.DomUtil.setPosition(canvas, this.corner);
    const context = canvas.getContext('2d');
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    this.draw(context, this.view());
  },
  view: function () {
    const half = Math.PI * earthRadius_m;
    const scale = 256 * Math.pow(2, this._map.getZoom()) / (2 * half);
    const shift = this._map.getPixelOrigin().add(this.corner);
    const view = {
      scale: scale,
      width: this.size.x,
      height: this.size.y,
      x: (metres) => scale * (half + metres) - shift.x,
      y: (metres) => scale * (half - metres) - shift.y,
    };
    const size = this.size;
    view.sees = (boxes, k) => view.x(boxes[k]) <= size.x && view.x(boxes[k + 2]) >= 0 && view.y(boxes[k + 3]) <= size.y &&
      view.y(boxes[k + 1]) >= 0;
    return view;
  },
});

function tracePath(path, view, flat, close) {
  path.moveTo(view.x(flat[0]), view.y(flat[1]));
  for (let k = 2; k < flat.length; k += 2) path.lineTo(view.x(flat[k]), view.y(flat[k + 1]));
  if (close) path.closePath();
}
// Strokes the parts of a line that are in sight, dashes as if all of it were drawn: a route of 200 km close up is a
// million pixels long.
function strokeLine(context, view, flat, dash) {
  context.setLineDash(dash);
  let passed = 0;
  let open = false;
  for (let k = 2; k < flat.length; k += 2) {
    const x1 = view.x(flat[k - 2]), y1 = view.y(flat[k - 1]), x2 = view.x(flat[k]), y2 = view.y(flat[k + 1]);
    const visible = Math.max(x1, x2) >= -20 && Math.min(x1, x2) <= view.width + 20 && Math.max(y1, y2) >= -20 && Math.min(y1, y2) <= view.height + 20;
    if (visible && !open) {
      context.beginPath();
      context.lineDashOffset = passed;
      context.moveTo(x1, y1);
    }
    if (visible) context.lineTo(x2, y2); else if (open) context.stroke();
    open = visible;
    passed += Math.hypot(x2 - x1, y2 - y1);
  }
  if (open) context.stroke();
  context.setLineDash([]);
  context.lineDashOffset = 0;
}
function visibleCells(view) {
  const visible = [];
  tiles.forEach((row, i) => { if (valueOf(row, 'level') === state.level && view.sees(cellBoxes, 4 * i)) visible.push(i); });
  return visible;
}

// ---- Heat map ----
function hatchPattern(context, light) {
  const canvas = document.createElement('canvas');
  canvas.width = canvas.height = 8;
  const brush = canvas.getContext('2d');
  if (!light) {
    brush.fillStyle = 'rgba(200,200,200,0.55)';
    brush.fillRect(0, 0, 8, 8);
  }
  // The light one falls the other way, in two tones that show on pale and on dark ground alike.
  const lines = light ? [['rgba(255,255,255,0.5)', 0.8, 0], ['rgba(40,40,40,0.35)', 0.8, 1]] : [['rgba(20,20,20,0.9)', 1.6, 0]];
  for (const [color, width, aside] of lines) {
    brush.strokeStyle = color;
    brush.lineWidth = width;
    brush.beginPath();
    for (const shift of [-8, 0, 8]) {
      brush.moveTo(shift + aside, light ? 0 : 8);
      brush.lineTo(shift + aside + 8, light ? 8 : 0);
    }
    brush.stroke();
  }
  return context.createPattern(canvas, 'repeat');
}
const belowThreshold = '#30343a';
function heatColor(i) {
  if (isDecision()) return display.classes[i] === null ? 'hatch' : display.class_colors[display.classes[i]];
  const index = shadeOf(i);
  if (index < 0) return 'hatch';
  return passes(i) ? display.colors[display.color_maps[state.measure]][index] : belowThreshold;
}
// In the context's colours. Few cells to a path, because long paths are slow to fill; cells of a few pixels as upright boxes.
function fillCells(context, view, cells) {
  context.lineWidth = 0.7;  // the stroke closes the seams between neighbours
  if (bucketSize_m * view.scale < 4) {
    for (const i of cells) {
      const x = view.x(cellBoxes[4 * i]), y = view.y(cellBoxes[4 * i + 3]);
      context.fillRect(x, y, view.x(cellBoxes[4 * i + 2]) - x, view.y(cellBoxes[4 * i + 1]) - y);
    }
    return;
  }
  for (let from = 0; from < cells.length; from += 32) {
    const path = new Path2D();
    for (const i of cells.slice(from, from + 32)) tracePath(path, view, display.cells_m[i], true);
    context.fill(path);
    if (context.strokeStyle !== 'rgba(0, 0, 0, 0)') context.stroke(path);
  }
}
function drawHeat(context, view) {
  const visible = visibleCells(view);
  const byColor = new Map();
  for (const i of visible) {
    const color = heatColor(i);
    if (byColor.has(color)) byColor.get(color).push(i); else byColor.set(color, [i]);
  }
  const hatch = byColor.has('hatch') ? hatchPattern(context) : null;
  for (const [color, cells] of byColor) {
    context.globalAlpha = color === belowThreshold ? 0.55 : 1;
    context.fillStyle = color === 'hatch' ? hatch : color;
    context.strokeStyle = color === 'hatch' || color === belowThreshold ? 'transparent' : color;
    fillCells(context, view, cells);
  }
  context.globalAlpha = 1;
  writeValues(context, view, visible);
}
// Over the colours of what P decides: where it is beyond what it was tested on.
function drawUntested(context, view) {
  if (!isUntested.size || !(isDecision() || ranksNow())) return;
  context.fillStyle = hatchPattern(context, true);
  context.strokeStyle = 'transparent';
  fillCells(context, view, visibleCells(view).filter((i) => isUntested.has(i)));
}
// Close up, each tile also says its value, below the cross of a refused one.
const saysValues = (view) => bucketSize_m * view.scale >= 64;
function writeValues(context, view, visible) {
  if (!visible.length || !saysValues(view)) return;
  context.font = '600 13px system-ui, sans-serif';
  context.textAlign = 'center';
  context.textBaseline = 'middle';
  context.lineWidth = 3;
  context.strokeStyle = '#fff';
  context.fillStyle = '#000';
  for (const i of visible) {
    const text = shownText(i);
    const x = view.x((cellBoxes[4 * i] + cellBoxes[4 * i + 2]) / 2);
    const y = view.y((cellBoxes[4 * i + 1] + cellBoxes[4 * i + 3]) / 2);
    context.strokeText(text, x, y + 9);
    context.fillText(text, x, y + 9);
  }
}

// ---- Imagery close up: the pictures of the tiles, laid where each tile's cell lies ----
const sheet = { image: null, ready: false };
function loadSheet(done) {
  if (!display.pictures || sheet.image) { if (sheet.ready) done(); return; }
  sheet.image = new Image();
  sheet.image.decoding = 'sync';
  sheet.image.addEventListener('load', () => { sheet.ready = true; done(); });
  sheet.image.src = display.pictures;
}
// The square of a tile's picture that shows its cell: [left, top, side] on the sheet.
function pictureSquare(i, share) {
  const side = display.picture_side_px;
  const keep = side * share;
  return [(i % display.picture_columns) * side + (side - keep) / 2, Math.floor(i / display.picture_columns) * side + (side - keep) / 2, keep];
}
function cellShare(i) {
  const level = report.grid.levels.find((entry) => entry.level === valueOf(tiles[i], 'level'));
  return Math.min(1, level.stride_px / level.tile_size_px);
}
function imageryPixelsPerMetre() {
  const image = layers.imagery && layers.imagery.getElement();
  return image && image.complete ? image.naturalWidth / (display.edges_m[2] - display.edges_m[0]) : 0;
}
function drawDetail(context, view) {
  if (!sheet.ready || !tiles.length) return;
  const pictureScale = display.picture_side_px * cellShare(0) / bucketSize_m;  // pixels per metre of the pictures …
  const imageryScale = imageryPixelsPerMetre();                               // … and of the picture under them
  if (pictureScale < 1.1 * imageryScale || view.scale < imageryScale) return;
  for (const i of visibleCells(view)) {
    const [left, top, side] = pictureSquare(i, cellShare(i));
    const p = display.cells_m[i];
    const x = view.x(p[0]), y = view.y(p[1]);
    context.save();
    context.transform(view.x(p[2]) - x, view.y(p[3]) - y, view.x(p[6]) - x, view.y(p[7]) - y, x, y);
    context.drawImage(sheet.image, left, top, side, side, 0, 0, 1, 1);
    context.restore();
  }
}

// ---- Areas ----
const edgeCache = new Map();
function cachedEdges(kind, isOfKind) {
  const key = kind + state.level;
  if (!edgeCache.has(key)) edgeCache.set(key, edgesOf(state.level, isOfKind));
  return edgeCache.get(key);
}
function edgePath(view, edges) {
  const path = new Path2D();
  for (let k = 0; k < edges.length; k += 4) {
    const x1 = view.x(edges[k]), y1 = view.y(edges[k + 1]), x2 = view.x(edges[k + 2]), y2 = view.y(edges[k + 3]);
    if (Math.max(x1, x2) < 0 || Math.min(x1, x2) > view.width || Math.max(y1, y2) < 0 || Math.min(y1, y2) > view.height) continue;
    path.moveTo(x1, y1);
    path.lineTo(x2, y2);
  }
  return path;
}
function strokeTwice(context, path, outer, inner, dash) {
  for (const [color, width] of [outer, inner]) {
    context.strokeStyle = color;
    context.lineWidth = width;
    context.setLineDash(color === inner[0] ? dash || [] : []);
    context.stroke(path);
  }
  context.setLineDash([]);
}
// Where go, marginal and no-go ground meet, over the colours of a measure: solid, dashed, dotted; the worse on top.
const classDashes = [[], [7, 4], [2, 3]];
const classOfRow = new Map(tiles.map((row, i) => [row, display.classes[i]]));
function drawClasses(context, view) {
  if (isDecision()) return;
  display.class_colors.forEach((color, k) => {
    const edges = cachedEdges('class' + k + '-', (row) => classOfRow.get(row) === k);
    strokeTwice(context, edgePath(view, edges), ['#fff', 3.4], [color, 2.2], classDashes[k]);
  });
}
const isSelected = (row) => valueOf(row, 'selected');
const isRefused = (row) => !valueOf(row, 'selected');
function drawSelected(context, view) {
  strokeTwice(context, edgePath(view, cachedEdges('selected', isSelected)), ['#000', 4], ['#fff', 1.8]);
}
function drawRefused(context, view) {
  strokeTwice(context, edgePath(view, cachedEdges('refused', isRefused)), ['#fff', 3], ['#000', 1.6], [5, 4]);
  const side = bucketSize_m * view.scale;
  if (side < 20) return;  // crosses would hide what lies under them
  const arm = Math.min(6, side / 6);
  const crosses = new Path2D();
  for (const i of visibleCells(view)) {
    if (!isRefused(tiles[i])) continue;
    const x = view.x((cellBoxes[4 * i] + cellBoxes[4 * i + 2]) / 2);
    const y = view.y((cellBoxes[4 * i + 1] + cellBoxes[4 * i + 3]) / 2) - (saysValues(view) ? 9 : 0);
    crosses.moveTo(x - arm, y - arm);
    crosses.lineTo(x + arm, y + arm);
    crosses.moveTo(x + arm, y - arm);
    crosses.lineTo(x - arm, y + arm);
  }
  strokeTwice(context, crosses, ['#fff', 3.5], ['#000', 1.6]);
}
