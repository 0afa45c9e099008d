// Places in the plane of EPSG:3857 (metres), as the page's data has them.
const earthRadius_m = 6378137;
const toLatLng = (x, y) => L.Projection.SphericalMercator.unproject(L.point(x, y));

// Box around each cell: [min x, min y, max x, max y] …
const cellBoxes = new Float64Array(4 * display.cells_m.length);
display.cells_m.forEach((flat, i) => {
  cellBoxes[4 * i] = Math.min(flat[0], flat[2], flat[4], flat[6]);
  cellBoxes[4 * i + 1] = Math.min(flat[1], flat[3], flat[5], flat[7]);
  cellBoxes[4 * i + 2] = Math.max(flat[0], flat[2], flat[4], flat[6]);
  cellBoxes[4 * i + 3] = Math.max(flat[1], flat[3], flat[5], flat[7]);
});

function insideCell(i, x, y) {
  const flat = display.cells_m[i];
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

// Cells by squares of ground as large as the largest cell, so that a place is looked up in a handful of them.
const bucketSize_m = cellBoxes.reduce((size, value, k) => (k % 4 < 2 ? Math.max(size, cellBoxes[k + 2] - value) : size), 1);
const bucketKey = (x, y) => Math.floor(x / bucketSize_m) + ',' + Math.floor(y / bucketSize_m);
const buckets = new Map();
for (let i = 0; i < display.cells_m.length; ++i) {
  for (let x = Math.floor(cellBoxes[4 * i] / bucketSize_m); x <= Math.floor(cellBoxes[4 * i + 2] / bucketSize_m); ++x) {
    for (let y = Math.floor(cellBoxes[4 * i + 1] / bucketSize_m); y <= Math.floor(cellBoxes[4 * i + 3] / bucketSize_m); ++y) {
      const key = x + ',' + y;
      if (buckets.has(key)) buckets.get(key).push(i); else buckets.set(key, [i]);
    }
  }
}
// Index of the tile of a level whose cell holds the place, or -1.
function tileAt(x, y, level) {
  const candidates = buckets.get(bucketKey(x, y)) || [];
  const found = candidates.find((i) => valueOf(tiles[i], 'level') === level && insideCell(i, x, y));
  return found === undefined ? -1 : found;
}

// The sides of cells of a kind without a neighbour of that kind, as [x1, y1, x2, y2] one after the other.
function edgesOf(level, isOfKind) {
  const key = (c, r) => c + ',' + r;
  const members = new Map();
  tiles.forEach((row, i) => {
    if (valueOf(row, 'level') === level && isOfKind(row)) members.set(key(valueOf(row, 'column'), valueOf(row, 'row')), i);
  });
  const edges = [];
  for (const i of members.values()) {
    const c = valueOf(tiles[i], 'column');
    const r = valueOf(tiles[i], 'row');
    const p = display.cells_m[i];
    if (!members.has(key(c, r - 1))) edges.push(p[0], p[1], p[2], p[3]);
    if (!members.has(key(c + 1, r))) edges.push(p[2], p[3], p[4], p[5]);
    if (!members.has(key(c, r + 1))) edges.push(p[4], p[5], p[6], p[7]);
    if (!members.has(key(c - 1, r))) edges.push(p[6], p[7], p[0], p[1]);
  }
  return edges;
}

// ---- The route ----
// Index of the last row whose distance (first element) is not beyond `distance`.
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
function placeAlong(distance) {
  return [between(display.places_m, distance, 1), between(display.places_m, distance, 2)];
}
// The distance along the route of its point nearest to a place, and how far (in the plane) it is away.
function nearestAlong(x, y) {
  const places = display.places_m;
  let best = { along: null, away: Infinity };
  for (let i = 0; i + 1 < places.length; ++i) {
    const [fromM, ax, ay] = places[i];
    const [toM, bx, by] = places[i + 1];
    const square = (bx - ax) ** 2 + (by - ay) ** 2;
    const share = square > 0 ? Math.min(1, Math.max(0, ((x - ax) * (bx - ax) + (y - ay) * (by - ay)) / square)) : 0;
    const away = Math.hypot(ax + share * (bx - ax) - x, ay + share * (by - ay) - y);
    if (away < best.away) best = { along: fromM + share * (toM - fromM), away: away };
  }
  return best;
}
// The tile of the shown level under each place of the route, -1 for none; made anew when the level changes.
const underRoute = { level: null, tiles: [] };
function tilesUnderRoute() {
  if (underRoute.level !== state.level) {
    underRoute.level = state.level;
    underRoute.tiles = display.places_m.map((place) => tileAt(place[1], place[2], state.level));
  }
  return underRoute.tiles;
}
