// Geodesics of WGS 84 by the nested series of T. Vincenty (Survey Review XXIII 176, 1975): within a millimetre for lines that do
// not reach the other side of the Earth. Places are { lat, lng } in degrees, azimuths degrees clockwise from north.
const ellipsoid = { a_m: 6378137, b_m: 6378137 * (1 - 1 / 298.257223563), f: 1 / 298.257223563 };
const degPerRad = 180 / Math.PI;

function geodesicSeries(cosSqAlpha) {
  const u = cosSqAlpha * (ellipsoid.a_m ** 2 - ellipsoid.b_m ** 2) / ellipsoid.b_m ** 2;
  return { a: 1 + u / 16384 * (4096 + u * (-768 + u * (320 - 175 * u))), b: u / 1024 * (256 + u * (-128 + u * (74 - 47 * u))),
    c: ellipsoid.f / 16 * cosSqAlpha * (4 + ellipsoid.f * (4 - 3 * cosSqAlpha)) };
}
const sigmaShift = (b, sin, cos, cosMiddle) => b * sin * (cosMiddle + b / 4 * (cos * (2 * cosMiddle ** 2 - 1) -
  b / 6 * cosMiddle * (4 * sin ** 2 - 3) * (4 * cosMiddle ** 2 - 3)));
const longitudeShift = (c, sinAlpha, sigma, sin, cos, cosMiddle) => (1 - c) * ellipsoid.f * sinAlpha *
  (sigma + c * sin * (cosMiddle + c * cos * (2 * cosMiddle ** 2 - 1)));
const reducedLatitude = (lat_deg) => Math.atan((1 - ellipsoid.f) * Math.tan(lat_deg / degPerRad));

function geodesicBetween(from, to) {
  const u1 = reducedLatitude(from.lat), u2 = reducedLatitude(to.lat), apart = (to.lng - from.lng) / degPerRad;
  const [s1, c1, s2, c2] = [Math.sin(u1), Math.cos(u1), Math.sin(u2), Math.cos(u2)];
  let lambda = apart, sin = 0, cos = 1, sigma = 0, cosSqAlpha = 1, cosMiddle = 0;
  for (let i = 0; i < 100; ++i) {
    sin = Math.hypot(c2 * Math.sin(lambda), c1 * s2 - s1 * c2 * Math.cos(lambda));
    if (sin === 0) return { length_m: 0, start_azimuth_deg: 0, end_azimuth_deg: 0 };
    cos = s1 * s2 + c1 * c2 * Math.cos(lambda);
    sigma = Math.atan2(sin, cos);
    const sinAlpha = c1 * c2 * Math.sin(lambda) / sin;
    cosSqAlpha = 1 - sinAlpha ** 2;
    cosMiddle = cosSqAlpha === 0 ? 0 : cos - 2 * s1 * s2 / cosSqAlpha;
    const before = lambda;
    lambda = apart + longitudeShift(geodesicSeries(cosSqAlpha).c, sinAlpha, sigma, sin, cos, cosMiddle);
    if (Math.abs(lambda - before) < 1e-14) break;
  }
  const { a, b } = geodesicSeries(cosSqAlpha);
  return { length_m: ellipsoid.b_m * a * (sigma - sigmaShift(b, sin, cos, cosMiddle)),
    start_azimuth_deg: degPerRad * Math.atan2(c2 * Math.sin(lambda), c1 * s2 - s1 * c2 * Math.cos(lambda)),
    end_azimuth_deg: degPerRad * Math.atan2(c1 * Math.sin(lambda), -s1 * c2 + c1 * s2 * Math.cos(lambda)) };
}
// The place `distance_m` ahead, and the azimuth there.
function geodesicDirect(from, azimuth_deg, distance_m) {
  const u1 = reducedLatitude(from.lat), alpha = azimuth_deg / degPerRad;
  const s1 = Math.sin(u1), c1 = Math.cos(u1);
  const first = Math.atan2(Math.tan(u1), Math.cos(alpha));
  const sinAlpha = c1 * Math.sin(alpha), cosSqAlpha = 1 - sinAlpha ** 2;
  const { a, b, c } = geodesicSeries(cosSqAlpha);
  let sigma = distance_m / (ellipsoid.b_m * a), cosMiddle = 0;
  for (let i = 0; i < 100; ++i) {
    cosMiddle = Math.cos(2 * first + sigma);
    const before = sigma;
    sigma = distance_m / (ellipsoid.b_m * a) + sigmaShift(b, Math.sin(sigma), Math.cos(sigma), cosMiddle);
    if (Math.abs(sigma - before) < 1e-14) break;
  }
  const sin = Math.sin(sigma), cos = Math.cos(sigma);
  const across = s1 * sin - c1 * cos * Math.cos(alpha);
  const lat = Math.atan2(s1 * cos + c1 * sin * Math.cos(alpha), (1 - ellipsoid.f) * Math.hypot(sinAlpha, across));
  const lambda = Math.atan2(sin * Math.sin(alpha), c1 * cos - s1 * sin * Math.cos(alpha));
  return { lat: degPerRad * lat, lng: from.lng + degPerRad * (lambda - longitudeShift(c, sinAlpha, sigma, sin, cos, cosMiddle)),
    azimuth_deg: degPerRad * Math.atan2(sinAlpha, -across) };
}
