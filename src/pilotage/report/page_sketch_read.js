// A route file that is opened on the page or dropped on the map, as points of a sketch: the places that it names one after the other.
// What the program reads and this does not (patterns, curves, returns) is named; heights count only where they are above ground.
// A reader gives { points: [{ lat, lng, agl_m, speed_mps }] (null: not said), notes }.

const isPlace = (lat, lng) => Number.isFinite(lat) && Number.isFinite(lng) && Math.abs(lat) <= 90 && Math.abs(lng) <= 360 && (lat !== 0 || lng !== 0);
const frameAboveGround = (frame) => frame === 10 || frame === 11;
const numberIn = (text) => (text === undefined || text === null || String(text).trim() === '' ? NaN : Number(text));
const xmlOf = (text) => {
  const root = new DOMParser().parseFromString(text, 'application/xml');
  if (root.querySelector('parsererror')) throw new Error('is no well-formed XML');
  return root;
};
const byName = (node, name) => [...node.getElementsByTagNameNS('*', name)];
const textOf = (node, name) => (byName(node, name)[0] || { textContent: '' }).textContent.trim();

// MAVLink commands: what leads to a place in the order of the file; of all else what is flown is told.
const flownCommands = { 16: 'waypoint', 82: 'spline waypoint', 22: 'takeoff', 84: 'VTOL takeoff', 21: 'landing', 85: 'VTOL landing', 17: 'loiter', 18: 'loiter turns',
  19: 'loiter time', 31: 'loiter to altitude' };
const takeoffCommands = [22, 84];
const leftOutCommands = { 177: 'jump', 601: 'jump to a tag', 189: 'landing sequence' };
// `home` { lat, lng } or null: where a takeoff begins and a return to launch ends, as in route/mission_items.cc.
function readCommands(items, home) {
  const points = [], notes = [];
  let speed_mps = null, otherHeights = 0;
  const curved = new Set();
  const addHome = () => points.push({ ...home, agl_m: null, speed_mps });
  for (const { number, command, frame, params } of items) {
    if (command === 178 && params[1] > 0) speed_mps = params[1];
    if (leftOutCommands[command]) notes.push('item ' + number + ' (' + leftOutCommands[command] + ') is left out');
    if (home && command === 20) addHome();
    if (!flownCommands[command]) continue;
    if (home && takeoffCommands.includes(command) && !points.length) addHome();
    if (!isPlace(params[4], params[5])) continue;
    if (command !== 16 && !takeoffCommands.includes(command)) curved.add(flownCommands[command]);
    if (!frameAboveGround(frame)) ++otherHeights;
    points.push({ lat: params[4], lng: params[5], agl_m: frameAboveGround(frame) ? params[6] : null, speed_mps });
  }
  if (curved.size) notes.push([...curved].join(', ') + ': the places alone are flown, straight from one to the next');
  return { points, notes, otherHeights };
}
function readPlan(json) {
  const { mission } = json;
  if (json.version !== 1 || mission.version !== 2) throw new Error('is a plan of another version than 1 with missions of version 2');
  const items = [], patterns = [];
  mission.items.forEach((item, i) => {
    if (item.type === 'SimpleItem') items.push({ number: item.doJumpId || i + 1, command: item.command, frame: item.frame, params: item.params.map((p) => (p === null ? NaN : p)) });
    else patterns.push('item ' + (i + 1) + ' (' + (item.complexItemType || item.type) + ') is left out: its pattern is not read here');
  });
  const [lat, lng] = mission.plannedHomePosition || [];
  const read = readCommands(items, isPlace(lat, lng) ? { lat, lng } : null);
  const cruise_mps = mission.vehicleType === 2 || mission.vehicleType === 10 ? mission.hoverSpeed : mission.cruiseSpeed;
  read.points.forEach((point) => { if (point.speed_mps === null && cruise_mps > 0) point.speed_mps = cruise_mps; });
  read.notes.push(...patterns);
  return read;
}
function readWaypoints(text) {
  const rows = text.trim().split(/\r?\n/).slice(1).map((line) => line.trim().split(/\s+/).map(Number)).filter((row) => row.length >= 12);
  const home = rows.find((row) => row[0] === 0 && isPlace(row[8], row[9]));
  return readCommands(rows.filter((row) => row[0] !== 0 || row[3] !== 16).map((row) => ({ number: row[0], frame: row[2], command: row[3], params: row.slice(4, 11) })),
    home ? { lat: home[8], lng: home[9] } : null);
}
// The first line of all that stand below a node of GeoJSON, and how many there are.
function linesOf(node) {
  if (!node) return [];
  if (node.type === 'LineString') return [{ coordinates: node.coordinates, said: {} }];
  if (node.type === 'MultiLineString') return node.coordinates.map((coordinates) => ({ coordinates, said: {} }));
  if (node.type === 'Feature') return linesOf(node.geometry).map((line) => ({ ...line, said: node.properties || {} }));
  return (node.features || node.geometries || []).flatMap(linesOf);
}
const othersNote = (count) => (count > 1 ? ['the first of ' + count + ' lines is taken'] : []);
function readGeoJson(json) {
  const lines = linesOf(json);
  if (!lines.length) throw new Error('holds no line');
  const { coordinates, said } = lines[0];
  const of = (name) => (typeof said[name] === 'number' ? said[name] : null);
  return { points: coordinates.map(([lng, lat]) => ({ lat, lng, agl_m: of('agl_m'), speed_mps: of('speed_mps') })), notes: othersNote(lines.length),
    otherHeights: coordinates.filter((place) => place.length > 2).length && of('agl_m') === null ? coordinates.length : 0 };
}
function readKml(root) {
  const djiPoints = byName(root, 'Placemark').filter((mark) => byName(mark, 'executeHeight').length && byName(mark, 'Point').length);
  if (djiPoints.length) {
    const follows = textOf(root, 'executeHeightMode') === 'realTimeFollowSurface';
    const usual = numberIn(textOf(root, 'autoFlightSpeed'));
    return { points: djiPoints.map((mark) => {
      const [lng, lat] = textOf(mark, 'coordinates').split(',').map(Number);
      const own = numberIn(textOf(mark, 'waypointSpeed'));
      const speed_mps = own > 0 ? own : usual > 0 ? usual : null;
      return { lat, lng, agl_m: follows ? numberIn(textOf(mark, 'executeHeight')) : null, speed_mps };
    }), notes: [], otherHeights: follows ? 0 : djiPoints.length };
  }
  const lines = byName(root, 'LineString');
  if (!lines.length) throw new Error('holds no line');
  const above = textOf(lines[0], 'altitudeMode') === 'relativeToGround';
  const places = textOf(lines[0], 'coordinates').split(/\s+/).map((place) => place.split(',').map(Number));
  return { points: places.map(([lng, lat, height_m]) => ({ lat, lng, agl_m: above && height_m > 0 ? height_m : null, speed_mps: null })), notes: othersNote(lines.length),
    otherHeights: above ? 0 : places.filter((place) => place.length > 2).length };
}
function readGpx(root) {
  const routes = byName(root, 'rte'), segments = byName(root, 'trkseg');
  const line = routes[0] || segments[0];
  if (!line) throw new Error('holds no route and no track');
  const places = byName(line, routes[0] ? 'rtept' : 'trkpt');
  return { points: places.map((place) => ({ lat: Number(place.getAttribute('lat')), lng: Number(place.getAttribute('lon')), agl_m: null, speed_mps: null })),
    notes: othersNote(routes.length + segments.length), otherHeights: places.filter((place) => byName(place, 'ele').length).length };
}
function readLitchi(text) {
  const rows = text.trim().split(/\r?\n/).map((line) => line.split(','));
  const columns = rows[0].map((name) => name.trim().replace(/^"|"$/g, '').toLowerCase());
  const at = (row, name) => (columns.indexOf(name) < 0 ? NaN : numberIn(row[columns.indexOf(name)]));
  if (columns.indexOf('latitude') < 0 || columns.indexOf('longitude') < 0) throw new Error('is a table without the columns latitude and longitude');
  const height_m = (row) => (columns.indexOf('altitude(ft)') < 0 ? at(row, 'altitude(m)') : 0.3048 * at(row, 'altitude(ft)'));
  const above = (row) => at(row, 'altitudemode') === 1;
  const speed_mps = (row) => (columns.indexOf('speed(mph)') < 0 ? at(row, 'speed(m/s)') : 0.44704 * at(row, 'speed(mph)'));
  const flown = rows.slice(1);
  return { points: flown.map((row) => ({ lat: at(row, 'latitude'), lng: at(row, 'longitude'), agl_m: above(row) && height_m(row) > 0 ? height_m(row) : null,
    speed_mps: speed_mps(row) > 0 ? speed_mps(row) : null })), notes: flown.some((row) => at(row, 'curvesize(m)') > 0) ? ['corners are flown sharp, not as curves'] : [],
  otherHeights: flown.filter((row) => !above(row)).length };
}

// ---- Archives (KMZ, DJI): the first of these documents, by the central directory of the ZIP ----
async function inflated(bytes) {
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream('deflate-raw'));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}
async function documentOfArchive(buffer) {
  const view = new DataView(buffer), bytes = new Uint8Array(buffer);
  let end = buffer.byteLength - 22;
  while (end >= 0 && view.getUint32(end, true) !== 0x06054b50) --end;
  if (end < 0) throw new Error('is no whole archive');
  const entries = [];
  for (let i = 0, at = view.getUint32(end + 16, true); i < view.getUint16(end + 10, true); ++i) {
    const [nameSize, extra, comment] = [28, 30, 32].map((k) => view.getUint16(at + k, true));
    entries.push({ name: new TextDecoder().decode(bytes.subarray(at + 46, at + 46 + nameSize)), packed: view.getUint16(at + 10, true), size: view.getUint32(at + 20, true),
      local: view.getUint32(at + 42, true) });
    at += 46 + nameSize + extra + comment;
  }
  const entry = entries.find(({ name }) => name.endsWith('waylines.wpml')) || entries.find(({ name }) => name.toLowerCase().endsWith('.kml'));
  if (!entry) throw new Error('is an archive without a KML or a DJI mission');
  const from = entry.local + 30 + view.getUint16(entry.local + 26, true) + view.getUint16(entry.local + 28, true);
  const part = bytes.subarray(from, from + entry.size);
  return new TextDecoder().decode(entry.packed === 0 ? part : await inflated(part));
}

const mostSketchPoints = 200;  // that can be taken hold of on a map
// Fewer points of the same line: those kept from which it nowhere departs by `within_m` (Douglas and Peucker, on the map's plane).
function thinLine(points, within_m) {
  const places = points.map(sketchPlane);
  const scale = Math.cos(points[0].lat / degPerRad);  // metres of ground to one of the plane
  const kept = new Set([0, points.length - 1]);
  const parts = [[0, points.length - 1]];
  while (parts.length) {
    const [first, last] = parts.pop();
    const [a, b] = [places[first], places[last]];
    const square = (b.x - a.x) ** 2 + (b.y - a.y) ** 2;
    let farthest = -1, most = within_m / scale;
    for (let i = first + 1; i < last; ++i) {
      const share = square > 0 ? Math.min(1, Math.max(0, ((places[i].x - a.x) * (b.x - a.x) + (places[i].y - a.y) * (b.y - a.y)) / square)) : 0;
      const away = Math.hypot(a.x + share * (b.x - a.x) - places[i].x, a.y + share * (b.y - a.y) - places[i].y);
      if (away > most) [farthest, most] = [i, away];
    }
    if (farthest < 0) continue;
    kept.add(farthest);
    parts.push([first, farthest], [farthest, last]);
  }
  return points.filter((_, i) => kept.has(i));
}

// ---- What the file is, and what the sketch makes of it ----
function readRouteText(text) {
  const start = text.replace(/^\uFEFF/, '').trimStart();
  if (start.startsWith('QGC WPL')) return readWaypoints(start);
  if (start.startsWith('{')) {
    const json = JSON.parse(start);
    if (json.fileType === 'Plan' && json.mission && Array.isArray(json.mission.items)) return readPlan(json);
    if (json.type === undefined) throw new Error('is JSON, but neither a QGroundControl plan nor GeoJSON');
    return readGeoJson(json);
  }
  if (start.startsWith('<')) {
    const root = xmlOf(start);
    return root.documentElement.localName === 'gpx' ? readGpx(root) : readKml(root);
  }
  return readLitchi(start);
}
async function readRouteFile(file) {
  if (file.size > 50e6) throw new Error('is larger than 50 MB');
  const buffer = await file.arrayBuffer();
  const zipped = buffer.byteLength > 4 && new DataView(buffer).getUint32(0, true) === 0x04034b50;
  const read = readRouteText(zipped ? await documentOfArchive(buffer) : new TextDecoder().decode(buffer));
  const places = read.points.filter((point) => isPlace(point.lat, point.lng));
  const points = places.filter((point, i) => i === 0 || geodesicBetween(places[i - 1], point).length_m > 1);
  if (points.length < 2) throw new Error('names fewer than two places to fly to');
  const notes = [...read.notes];
  let kept = points;
  for (let within_m = 1; kept.length > mostSketchPoints; within_m *= 2) {
    kept = thinLine(points, within_m);
    if (kept.length <= mostSketchPoints) notes.push('thinned from ' + points.length + ' points to ' + kept.length + ', which lie within ' + within_m + ' m of the line');
  }
  if (!flown) notes.push('flown ' + Math.round(sketchData.agl_m) + ' m above ground, which the tiles of this page are for, whatever the file says');
  else if (read.otherHeights) notes.push('heights that are not above ground are not read: ' + Math.round(sketchData.agl_m) + ' m above ground instead');
  return { notes, points: kept.map((point) => ({ lat: point.lat, lng: lngNearGround(point.lng), agl_m: flown && point.agl_m > 0 ? point.agl_m : sketchData.agl_m,
    speed_mps: point.speed_mps > 0 ? point.speed_mps : sketchData.speed_mps })) };
}
