// The flight along a line that is drawn: what mission/tile_under.cc, mission/chances_beside_line.cc and report/what_if.cc make of a
// planned route, made here of waypoints { lat, lng, agl_m, speed_mps } (the speed is that of the leg that leads there) over the
// tiles of the page. Every tile that can be matched counts as stored, as `select` stores them without a budget.
const sketchData = data.sketch;  // null: how often fixes come is not known

const sketchLogits = sketchData && numbersOf(sketchData.logits);
const sketchSigmas = sketchData && alongSamples(sketchData.sigma_runs);
// P of a tile at each level of the place; 0 of one that is not counted on.
const pAtLevels = (i, { level_z }) => level_z.map((z) => 1 / (1 + Math.exp(-(sketchLogits[i] + sketchSigmas[i] * z))));
const sketchP = sketchData && Float64Array.from(tiles, (_, i) =>
  pAtLevels(i, sketchData).reduce((sum, p, level) => sum + sketchData.level_weights[level] * p, 0));
// Of each level the size of its tiles, the way between them, and which of the page's tiles lies where (-1: none).
const gridOf = new Map(report.grid.levels.map((grid) => {
  const places = tiles.flatMap((row, i) => (valueOf(row, 'level') === grid.level ? [[valueOf(row, 'column'), valueOf(row, 'row'), i]] : []));
  const ends = [0, 1].map((k) => places.reduce(([least, most], place) => [Math.min(least, place[k]), Math.max(most, place[k])], [Infinity, -Infinity]));
  const [[column, lastColumn], [row, lastRow]] = places.length ? ends : [[0, -1], [0, -1]];
  const columns = lastColumn - column + 1, rows = lastRow - row + 1;
  const index = new Int32Array(columns * rows).fill(-1);
  places.forEach(([c, r, i]) => { index[(r - row) * columns + c - column] = i; });
  const at = (c, r) => (c < column || r < row || c > lastColumn || r > lastRow ? -1 : index[(r - row) * columns + c - column]);
  return [grid.level, { tile_m: grid.tile_size_px * grid.gsd_m, stride_m: grid.stride_px * grid.gsd_m, at, ends: { column, lastColumn, row, lastRow } }];
}));
const columnOf = (i) => valueOf(tiles[i], 'column');
const rowOf = (i) => valueOf(tiles[i], 'row');

// Where in its cell a place lies: shares of the way to the next column and the next row.
function shareOfCell(i, x, y) {
  const p = display.cells_m[i];
  const ux = p[2] - p[0], uy = p[3] - p[1], vx = p[6] - p[0], vy = p[7] - p[1];
  const determinant = ux * vy - uy * vx;
  return [((x - p[0]) * vy - (y - p[1]) * vx) / determinant, ((y - p[1]) * ux - (x - p[0]) * uy) / determinant];
}
// Rings of equal probability around a place for three standard deviations (a quarter, a half and a whole step), each point turned
// by the golden angle: [steps to the right, steps up].
const besidePoints = [4, 2, 1].map((part) => Array.from({ length: 40 }, (_, i) => {
  const off = Math.sqrt(-2 * Math.log(1 - (i + 0.5) / 40)) / part;
  return [off * Math.cos(2.399963229728653 * i), off * Math.sin(2.399963229728653 * i)];
}));
// As chances_beside_line() has it, of a sample over a stored tile: the step of the tiles, then three shares.
function besideSample({ tile, level, right, down }, stored) {
  const { stride_m, at } = gridOf.get(level);
  const column = columnOf(tile) + right, row = rowOf(tile) + down;
  const shares = besidePoints.map((points) => points.reduce((sum, [dx, dy]) => {
    const there = at(Math.floor(column + dx), Math.floor(row - dy));
    return there >= 0 && stored.has(there) ? sum + sketchP[there] / points.length : sum;
  }, 0) / sketchP[tile]);
  return [stride_m, ...shares];
}
// The tiles that can be matched and whose centres lie within the corridor (tile/corridor.cc), which `select` stores. Looked at from
// samples an eighth of its half width apart, which draws its edges to a five-hundredth of it.
function storedTiles(samples, half_width_m, step_m) {
  const stored = new Set();
  let looked_m = -Infinity;
  samples.forEach(({ tile, level, right, down, distance_m, leg }, i) => {
    if (tile < 0) return;
    const { stride_m, at, ends } = gridOf.get(level);
    const reach_m = Math.max(half_width_m, Math.SQRT1_2 * stride_m);
    const apart_m = Math.max(step_m, reach_m / 8);
    const endsLeg = i + 1 === samples.length || samples[i + 1].leg !== leg || samples[i + 1].tile < 0 || (i > 0 && samples[i - 1].tile < 0);
    if (distance_m - looked_m < apart_m && !endsLeg) return;
    looked_m = distance_m;
    const reach = Math.hypot(reach_m, apart_m / 2) / stride_m;  // in steps of the tiles
    const column = columnOf(tile) + right - 0.5, row = rowOf(tile) + down - 0.5;
    for (let r = Math.max(ends.row, Math.ceil(row - reach)); r <= Math.min(ends.lastRow, Math.floor(row + reach)); ++r) {
      const wide = Math.sqrt(Math.max(0, reach * reach - (r - row) ** 2));
      for (let c = Math.max(ends.column, Math.ceil(column - wide)); c <= Math.min(ends.lastColumn, Math.floor(column + wide)); ++c) {
        const there = at(c, r);
        if (there >= 0 && sketchP[there] > 0) stored.add(there);
      }
    }
  });
  return stored;
}

// The level that serves a height (tile/plan_levels.cc); null: too low for any.
function levelServing(agl_m) {
  if (!(agl_m >= sketchData.min_agl_m)) return null;
  const found = sketchData.levels.find(([, , most_m]) => agl_m <= most_m) || sketchData.levels[sketchData.levels.length - 1];
  return found[0];
}
const sketchPlane = (point) => L.Projection.SphericalMercator.project(L.latLng(point.lat, point.lng));
// Samples of a leg every `step_m` at most, both ends among them (route/sample_route.cc).
function sampleLeg(from, to, step_m) {
  const geodesic = geodesicBetween(from, to);
  const steps = Math.max(1, Math.ceil(geodesic.length_m / step_m - 1e-9));
  const samples = [];
  for (let i = 0; i <= steps; ++i) {
    const place = i === 0 ? { ...from, azimuth_deg: geodesic.start_azimuth_deg }
      : i === steps ? { ...to, azimuth_deg: geodesic.end_azimuth_deg } : geodesicDirect(from, geodesic.start_azimuth_deg, geodesic.length_m * i / steps);
    const { x, y } = sketchPlane(place);
    const level = levelServing(from.agl_m + (to.agl_m - from.agl_m) * i / steps);
    const tile = level === null ? -1 : tileAt(x, y, level);
    const [right, down] = tile < 0 ? [0, 0] : shareOfCell(tile, x, y);
    samples.push({ along_m: geodesic.length_m * i / steps, azimuth_deg: (place.azimuth_deg + 360) % 360, x, y, level, tile, right, down });
  }
  return { length_m: geodesic.length_m, samples };
}
const sampledLegs = new Map();  // by all that a leg is made of: a drag changes two of them
function legOfSketch(from, to, step_m) {
  const key = [from.lat, from.lng, from.agl_m, to.lat, to.lng, to.agl_m, step_m].join(' ');
  if (!sampledLegs.has(key)) {
    if (sampledLegs.size > 2000) sampledLegs.clear();
    sampledLegs.set(key, sampleLeg(from, to, step_m));
  }
  return sampledLegs.get(key);
}

// For an answer at once, while a point is dragged.
const sketchAbout = sketchData && aboutChances(sketchData);
if (sketchAbout) sketchAbout.level_z = sketchAbout.levels.map((level) => sketchData.level_z[level]);

const sketchStep_m = 10, mostSketchSamples = 2000;  // every 10 m, as the program looks at a route, up to 20 km
// As few samples as an answer at once needs: one for each way over which tries fare alike, within bounds.
function aboutSamples(length_m) {
  const apart_m = sketchData.apart_m === null ? gridOf.get(sketchData.levels[0][0]).tile_m : sketchData.apart_m;
  return Math.min(500, Math.max(100, length_m / apart_m));
}
// Of few samples each stands for the way to the next ones: over the best tile of it, since the tries of that way fare alike.
function overBestTiles(samples, step_m) {
  return samples.map((sample, i) => {
    let best = sample;
    for (const other of [samples[i - 1], samples[i + 1]]) {
      if (!other || other.leg !== sample.leg || sample.level === null) continue;
      const probes = Math.min(4, Math.ceil(step_m / 2 / gridOf.get(sample.level).stride_m));
      for (let k = 1; k <= probes; ++k) {
        const share = k / (2 * probes + 1), x = sample.x + share * (other.x - sample.x), y = sample.y + share * (other.y - sample.y);
        const tile = tileAt(x, y, sample.level);
        if (tile < 0 || (best.tile >= 0 && sketchP[tile] <= sketchP[best.tile])) continue;
        const [right, down] = shareOfCell(tile, x, y);
        best = { ...sample, tile, right, down };
      }
    }
    return best;
  });
}
// `about`: for an answer at once.
function flightOfSketch(points, { limit_m }, about) {
  const straight_m = points.slice(1).reduce((sum, point, i) => sum + geodesicBetween(points[i], point).length_m, 0);
  const step_m = Math.max(sketchStep_m, straight_m / (about ? aboutSamples(straight_m) : mostSketchSamples));
  const chances = about ? sketchAbout : sketchData;
  let all = [];
  const legs = [];
  let start_m = 0;
  points.slice(1).forEach((to, leg) => {
    const sampled = legOfSketch(points[leg], to, step_m);
    if (!(sampled.length_m > 0)) return;
    sampled.samples.forEach((sample) => all.push({ ...sample, distance_m: start_m + sample.along_m, leg: legs.length, speed_mps: to.speed_mps }));
    legs.push({ length_m: sampled.length_m, points: [leg, leg + 1] });
    start_m += sampled.length_m;
  });
  if (about) all = overBestTiles(all, step_m);
  const half_width_m = sketchData.corridor_half_width_m === null ? limit_m : sketchData.corridor_half_width_m;
  const storedOnes = storedTiles(all, half_width_m, step_m);
  const tile_runs = [];
  let matchable_m = 0, unknown_m = 0;
  all.forEach((sample, i) => {
    const stored = sample.tile >= 0 && storedOnes.has(sample.tile) ? sample.tile : -1;
    const before = i > 0 ? all[i - 1] : null;
    if (i > 0 && before.stored === stored) ++tile_runs[tile_runs.length - 1][0];
    else tile_runs.push([1, stored < 0 ? null : [sketchP[stored], ...pAtLevels(stored, chances)]]);
    sample.stored = stored;
    if (before === null || before.leg !== sample.leg) return;
    const way_m = sample.distance_m - before.distance_m;
    if (stored >= 0 && before.stored >= 0) matchable_m += way_m;
    if (sample.level !== null && (sample.tile < 0 || before.tile < 0)) unknown_m += way_m;
  });
  const gridAt = (sample) => gridOf.get(sample.level === null ? sketchData.levels[0][0] : sample.level);
  const of = (make) => Float64Array.from(all, make);
  return { count: all.length, distance_m: of((sample) => sample.distance_m), azimuth_deg: of((sample) => sample.azimuth_deg),
    leg: all.map((sample) => sample.leg), speed_mps: all.map((sample) => sample.speed_mps),
    apart_m: all.map((sample) => (sketchData.apart_m === null ? gridAt(sample).tile_m : sketchData.apart_m)), tile_runs,
    beside_line: Float64Array.from(all.flatMap((sample) => (sample.stored < 0 ? [0, 0, 0, 0] : besideSample(sample, storedOnes)))), leg_lengths_m: legs.map((leg) => leg.length_m), denied: [],
    anywhere: false, chances, untested: all.some(({ stored }) => stored >= 0 && isUntested.has(stored)), places: all.map((sample) => [sample.distance_m, sample.x, sample.y]), legs, step_m,
    length_m: start_m, unknown_m, matchable_fraction: start_m > 0 ? matchable_m / start_m : 0,
    duration_s: legs.reduce((sum, leg) => sum + leg.length_m / points[leg.points[1]].speed_mps, 0) };
}
