#include "pilotage/report/sampled_route.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace pilotage {
namespace {

bool before(const FlightSample& sample, double distance_m) {
  return sample.distance_m < distance_m;
}

// Appends about max_points of [first, last), always the last one.
template <class Iterator>
void append_thinned(Iterator first, Iterator last, std::size_t max_points, std::vector<GeodeticPoint>& line) {
  const auto count = static_cast<std::size_t>(last - first);
  const std::size_t step = std::max<std::size_t>(1, (count + max_points - 1) / max_points);
  for (std::size_t i = 0; i < count; i += step) line.push_back(first[static_cast<std::ptrdiff_t>(i)].point);
  if (count > 0 && (count - 1) % step != 0) line.push_back((last - 1)->point);
}

}  // namespace

GeodeticPoint route_point_at(const std::vector<FlightSample>& samples, double distance_m) {
  if (samples.empty()) return {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::quiet_NaN()};
  const auto next = std::lower_bound(samples.begin(), samples.end(), distance_m, before);
  if (next == samples.begin()) return samples.front().point;
  if (next == samples.end()) return samples.back().point;
  const FlightSample& a = *(next - 1);
  const FlightSample& b = *next;
  const double share = (distance_m - a.distance_m) / (b.distance_m - a.distance_m);
  const double lon_deg = unwrap_lon_deg(b.point.lon_deg, a.point.lon_deg);
  return {wrap_lon_deg(a.point.lon_deg + share * (lon_deg - a.point.lon_deg)),
          a.point.lat_deg + share * (b.point.lat_deg - a.point.lat_deg)};
}

std::vector<GeodeticPoint> route_line_between(const std::vector<FlightSample>& samples, double from_distance_m,
                                              double to_distance_m, std::size_t max_points) {
  if (samples.empty()) return {};
  std::vector<GeodeticPoint> line = {route_point_at(samples, from_distance_m)};
  const auto first =
      std::upper_bound(samples.begin(), samples.end(), from_distance_m,
                       [](double distance_m, const FlightSample& s) { return distance_m < s.distance_m; });
  const auto last = std::lower_bound(samples.begin(), samples.end(), to_distance_m, before);
  if (first < last) append_thinned(first, last, std::max<std::size_t>(max_points, 4) - 2, line);
  line.push_back(route_point_at(samples, to_distance_m));
  return line;
}

std::vector<GeodeticPoint> leg_line(const std::vector<FlightSample>& samples, int leg, std::size_t max_points) {
  std::vector<FlightSample> own;
  std::copy_if(samples.begin(), samples.end(), std::back_inserter(own),
               [leg](const FlightSample& sample) { return sample.leg == leg; });
  std::vector<GeodeticPoint> line;
  append_thinned(own.begin(), own.end(), std::max<std::size_t>(max_points, 2) - 1, line);
  return line;
}

}  // namespace pilotage
