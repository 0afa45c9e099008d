// A sketched route as files: points { lat, lng, agl_m, speed_mps }, heights above ground in the frame of each format.

const wrappedLng = (lng) => L.latLng(0, lng).wrap().lng;
// Another line has another name: what is saved later is never taken for it (FNV-1a of the points).
function nameOfSketch(points) {
  let hash = 0x811c9dc5;
  for (const letter of JSON.stringify(points)) hash = Math.imul(hash ^ letter.charCodeAt(0), 0x01000193) >>> 0;
  return 'sketch_' + hash.toString(16).padStart(8, '0').slice(0, 6);
}
// QGroundControl's .plan, as route/qgc_plan_writer.cc writes one.
function sketchAsPlan(points) {
  const items = [];
  const add = (item) => items.push({ autoContinue: true, doJumpId: items.length + 1, type: 'SimpleItem', ...item });
  points.forEach((point, i) => {
    if (i > 1 && point.speed_mps !== points[i - 1].speed_mps) add({ command: 178, frame: 2, params: [1, point.speed_mps, -1, 0, 0, 0, 0] });
    add({ AMSLAltAboveTerrain: null, Altitude: point.agl_m, AltitudeMode: 4, command: 16, frame: 10,
      params: [0, 0, 0, null, point.lat, wrappedLng(point.lng), point.agl_m] });
  });
  const mission = { cruiseSpeed: points[1].speed_mps, firmwareType: 0, globalPlanAltitudeMode: 0, hoverSpeed: 5, items,
    plannedHomePosition: [points[0].lat, wrappedLng(points[0].lng), null], vehicleType: 1, version: 2 };
  return JSON.stringify({ fileType: 'Plan', geoFence: { circles: [], polygons: [], version: 2 }, groundStation: 'QGroundControl', mission,
    rallyPoints: { points: [], version: 2 }, version: 1 }, null, 2) + '\n';
}
// Mission Planner's .waypoints (QGC WPL 110): the first row is home, whose height above sea level the page does not know.
function sketchAsWaypoints(points) {
  const rows = [];
  const add = (frame, command, params) => rows.push([rows.length, rows.length === 0 ? 1 : 0, frame, command, ...params, 1].join('\t'));
  add(0, 16, [0, 0, 0, 0, points[0].lat.toFixed(8), wrappedLng(points[0].lng).toFixed(8), 0]);
  points.forEach((point, i) => {
    if (i > 0 && (i === 1 || point.speed_mps !== points[i - 1].speed_mps)) add(2, 178, [1, point.speed_mps, -1, 0, 0, 0, 0]);
    add(10, 16, [0, 0, 0, 0, point.lat.toFixed(8), wrappedLng(point.lng).toFixed(8), point.agl_m]);
  });
  return 'QGC WPL 110\n' + rows.join('\n') + '\n';
}
function sketchAsKml(points) {
  const places = points.map((point) => wrappedLng(point.lng).toFixed(8) + ',' + point.lat.toFixed(8) + ',' + point.agl_m).join(' ');
  return '<?xml version="1.0" encoding="UTF-8"?>\n<kml xmlns="http://www.opengis.net/kml/2.2"><Document><Placemark><name>sketch</name>' +
    '<LineString><altitudeMode>relativeToGround</altitudeMode><coordinates>' + places + '</coordinates></LineString></Placemark></Document></kml>\n';
}
function sketchAsGeoJson(points) {
  const coordinates = points.map((point) => [Number(wrappedLng(point.lng).toFixed(8)), Number(point.lat.toFixed(8))]);
  return JSON.stringify({ type: 'FeatureCollection', features: [{ type: 'Feature', properties: { name: 'sketch', agl_m: points[0].agl_m,
    speed_mps: points[1].speed_mps }, geometry: { type: 'LineString', coordinates } }] }) + '\n';
}
// The mission file for `prepare` and `reroute`, of what was planned here but for the route and what the form says.
function sketchAsMission(points, settings) {
  const mission = { ...sketchData.mission, route: nameOfSketch(points) + '.plan', max_error_m: settings.limit_m };
  if (settings.model.grade !== null) {
    mission.ins = { ...mission.ins, grade: settings.model.grade };
    delete mission.ins.name;
  }
  mission.select = { ...mission.select, fix_interval_s: settings.interval_s };
  return JSON.stringify(mission, null, 2) + '\n';
}
function saveText(name, type, text) {
  const link = element('a');
  link.href = URL.createObjectURL(new Blob([text], { type }));
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 60000);
}
