#include "pilotage/tile/route_cover.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <utility>

#include "pilotage/base/text.h"
#include "pilotage/raster/gray_stretch.h"

namespace pilotage {
namespace {

double distance_outside_m(const Bounds& bounds, const Eigen::Vector2d& point_m) {
  const double dx = std::max({bounds.min_x_m - point_m.x(), 0.0, point_m.x() - bounds.max_x_m});
  const double dy = std::max({bounds.min_y_m - point_m.y(), 0.0, point_m.y() - bounds.max_y_m});
  return std::hypot(dx, dy);
}

double distance_outside_all_m(const std::vector<Bounds>& extents, const Eigen::Vector2d& point_m) {
  double nearest_m = std::numeric_limits<double>::infinity();
  for (const Bounds& extent : extents) nearest_m = std::min(nearest_m, distance_outside_m(extent, point_m));
  return nearest_m;
}

std::vector<Bounds> extents_of(const std::vector<ImageryInfo>& infos, const Crs& crs) {
  std::vector<Bounds> extents;
  for (const ImageryInfo& info : infos) extents.push_back(imagery_bounds(info, crs));
  return extents;
}

// "from 0.40 km to 1.53 km (lon 16.501, lat 55.501)"
std::string stretch_text(const FlightSample& first, const FlightSample& last) {
  return "from " + format_fixed(first.distance_m / 1000, 2) + " km to " + format_fixed(last.distance_m / 1000, 2) +
         " km (lon " + format_fixed(first.point.lon_deg, 6) + ", lat " + format_fixed(first.point.lat_deg, 6) + ")";
}

// Runs of consecutive samples of which `holds` is true, as [first, last].
std::vector<std::pair<std::size_t, std::size_t>> runs_where(const std::vector<FlightSample>& samples,
                                                            const std::function<bool(const FlightSample&)>& holds) {
  std::vector<std::pair<std::size_t, std::size_t>> runs;
  bool open = false;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const bool now = holds(samples[i]);
    if (now && !open) runs.emplace_back(i, i);
    if (now) runs.back().second = i;
    open = now;
  }
  return runs;
}

}  // namespace

std::string outside_imagery(const std::vector<FlightSample>& samples, const std::vector<ImageryInfo>& infos,
                            const Crs& crs) {
  const std::vector<Bounds> extents = extents_of(infos, crs);
  const auto outside_m = [&](const FlightSample& sample) {
    return distance_outside_all_m(extents, sample.point_map_m);
  };
  std::vector<std::string> parts;
  for (const auto& [first, last] :
       runs_where(samples, [&](const FlightSample& sample) { return outside_m(sample) > 0; })) {
    double farthest_m = 0;
    for (std::size_t i = first; i <= last; ++i) farthest_m = std::max(farthest_m, outside_m(samples[i]));
    parts.push_back(stretch_text(samples[first], samples[last]) + ", up to " + format_fixed(farthest_m, 0) +
                    " m outside");
  }
  return join(parts, "; ");
}

std::string over_no_data(const std::vector<FlightSample>& samples, const GridLevel& level, const GraySource& valid,
                         const std::vector<ImageryInfo>& infos, const Crs& crs) {
  const std::vector<Bounds> extents = extents_of(infos, crs);
  const auto without_data = [&](const FlightSample& sample) {
    if (sample.level != level.matrix.level || distance_outside_all_m(extents, sample.point_map_m) > 0) return false;
    const Eigen::Vector2d pixel = level.matrix.map_from_pixel.pixel_from_map(sample.point_map_m);
    const int side_px = std::max(1, level.matrix.tile_size_px / 4);
    const PixelWindow window{static_cast<std::int64_t>(std::floor(pixel.x())) - side_px / 2,
                             static_cast<std::int64_t>(std::floor(pixel.y())) - side_px / 2, side_px, side_px};
    return valid_fraction(valid, window) < 0.5;
  };
  const double half_tile_m = 0.5 * level.matrix.tile_size_px * level.gsd_m;
  std::vector<std::string> parts;
  for (const auto& [first, last] : runs_where(samples, without_data)) {
    if (samples[last].distance_m - samples[first].distance_m < half_tile_m) continue;
    parts.push_back(stretch_text(samples[first], samples[last]));
  }
  return join(parts, "; ");
}

std::string swapped_axes_hint(GeodeticPoint point, const std::vector<ImageryInfo>& infos) {
  const Eigen::Vector2d as_given(point.lon_deg, point.lat_deg);
  const Eigen::Vector2d swapped(point.lat_deg, point.lon_deg);
  const std::vector<Bounds> extents = extents_of(infos, Crs::wgs84());
  const bool hints = distance_outside_all_m(extents, as_given) > 0 && distance_outside_all_m(extents, swapped) <= 0;
  return hints ? "; with latitude and longitude exchanged it begins inside the imagery: are they swapped in the file?"
               : "";
}

}  // namespace pilotage
