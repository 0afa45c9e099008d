#include "pilotage/route/mission_curve.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "pilotage/base/angle.h"
#include "pilotage/geo/geodesic.h"

namespace pilotage {
namespace {

GroundVector vector_along(double length_m, double azimuth_deg) {
  return {length_m * std::sin(azimuth_deg * kRadPerDeg), length_m * std::cos(azimuth_deg * kRadPerDeg)};
}

double length_m(const GroundVector& vector) {
  return std::hypot(vector.east_m, vector.north_m);
}

/// a · x + b · y
GroundVector combined(double a, const GroundVector& x, double b, const GroundVector& y) {
  return {a * x.east_m + b * y.east_m, a * x.north_m + b * y.north_m};
}

/// Distance of a point from the line along `chord` through the origin.
double off_line_m(const GroundVector& point, const GroundVector& chord) {
  return std::abs(point.east_m * chord.north_m - point.north_m * chord.east_m) / length_m(chord);
}

}  // namespace

GroundVector ground_vector(GeodeticPoint from, GeodeticPoint to) {
  const GeodesicLeg leg = geodesic_between(from, to);
  return vector_along(leg.length_m, leg.start_azimuth_deg);
}

GroundVector arriving_vector(GeodeticPoint from, GeodeticPoint to) {
  const GeodesicLeg leg = geodesic_between(from, to);
  return vector_along(leg.length_m, leg.end_azimuth_deg);
}

std::vector<CurvePoint> spline_points(GeodeticPoint from, GeodeticPoint to, GroundVector leaving, GroundVector arriving,
                                      double* departure_m) {
  constexpr double kMostEndVectors = 4;  // SPLINE_FACTOR
  *departure_m = 0;
  const GroundVector chord = ground_vector(from, to);
  const double distance_m = length_m(chord);
  const double ends_m = length_m(leaving) + length_m(arriving);
  if (!(distance_m > kChordError_m) || !(ends_m > 0)) return {};
  const double scale = std::min(1.0, kMostEndVectors * distance_m / ends_m);
  leaving = combined(scale, leaving, 0, leaving);
  arriving = combined(scale, arriving, 0, arriving);
  // p(t) = leaving t + square t² + cube t³, 0 ≤ t ≤ 1
  const GroundVector square = combined(1, combined(3, chord, -2, leaving), -1, arriving);
  const GroundVector cube = combined(1, combined(-2, chord, 1, leaving), 1, arriving);
  const auto at = [&](double t) { return combined(t, combined(1, leaving, t, square), t * t * t, cube); };
  // A chord over h of t leaves a curve by |p''| h² / 8 at most, and p'' is largest at one of the ends.
  const double bend_m = std::max(length_m(combined(2, square, 0, square)), length_m(combined(2, square, 6, cube)));
  const int chords = std::max(2, static_cast<int>(std::ceil(std::sqrt(bend_m / (8 * kChordError_m)))));
  std::vector<CurvePoint> points;
  GroundVector last;
  double way_m = 0;
  for (int i = 1; i <= chords; ++i) {
    const GroundVector next = i == chords ? chord : at(static_cast<double>(i) / chords);
    *departure_m = std::max(*departure_m, off_line_m(next, chord));
    way_m += length_m(combined(1, next, -1, last));
    last = next;
    if (i == chords) break;
    const double azimuth_deg = std::atan2(next.east_m, next.north_m) / kRadPerDeg;
    points.push_back({geodesic_direct(from, azimuth_deg, length_m(next)), way_m});
  }
  if (*departure_m < kChordError_m) return {};
  for (CurvePoint& point : points) point.fraction /= way_m;
  return points;
}

std::vector<GeodeticPoint> circle_points(GeodeticPoint center, double radius_m, double start_azimuth_deg,
                                         bool clockwise) {
  constexpr int kFewestChords = 8;
  const double half_chord_rad = std::acos(std::max(0.0, 1 - kChordError_m / radius_m));
  const int chords = std::max(kFewestChords, static_cast<int>(std::ceil(std::numbers::pi / half_chord_rad)));
  std::vector<GeodeticPoint> points;
  for (int i = 0; i < chords; ++i) {
    const double turned_deg = 360.0 * i / chords;
    points.push_back(geodesic_direct(center, start_azimuth_deg + (clockwise ? turned_deg : -turned_deg), radius_m));
  }
  return points;
}

}  // namespace pilotage
