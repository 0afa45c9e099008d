#include "pilotage/replay/flown_line.h"

#include <algorithm>
#include <cmath>

#include "pilotage/base/angle.h"
#include "pilotage/geo/geodesic.h"

namespace pilotage {
namespace {

constexpr double kLargestTurn_deg = 60;
constexpr double kShortestWay_s = 0.2;
constexpr double kLongestWay_s = 60;
constexpr double kEarthRadius_m = 6371000;

/// Good to a part in a thousand for the some hundred metres that it is asked for; the place itself is then exact.
double rough_distance_m(GeodeticPoint a, GeodeticPoint b) {
  const double north_m = (a.lat_deg - b.lat_deg) * kRadPerDeg * kEarthRadius_m;
  const double east_m =
      std::remainder(a.lon_deg - b.lon_deg, 360.0) * kRadPerDeg * kEarthRadius_m * std::cos(b.lat_deg * kRadPerDeg);
  return std::hypot(north_m, east_m);
}

bool is_usable(const ReplayedFrame& frame) {
  return frame.place_from != PlaceSource::kNone && std::isfinite(frame.time_s);
}

std::optional<std::size_t> nearest_sample(const std::vector<FlightSample>& samples, GeodeticPoint place,
                                          double track_deg) {
  std::optional<std::size_t> nearest;
  double least_m = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const double turn_deg = std::abs(std::remainder(samples[i].azimuth_deg - track_deg, 360.0));
    if (turn_deg > kLargestTurn_deg) continue;  // false where the track is not known
    const double distance_m = rough_distance_m(samples[i].point, place);
    if (distance_m >= least_m) continue;
    least_m = distance_m;
    nearest = i;
  }
  return nearest;
}

bool is_served(const Mission& mission, double height_agl_m) {
  const auto& levels = mission.ground.levels;
  return std::any_of(levels.begin(), levels.end(), [&](const GridLevel& level) {
    return height_agl_m >= level.min_agl_m && height_agl_m <= level.max_agl_m;
  });
}

}  // namespace

std::vector<FlownTrack> flown_track(const ReplayedFlight& flight) {
  std::vector<FlownTrack> tracks(flight.frames.size());
  for (std::size_t i = 0; i < flight.frames.size(); ++i) {
    const ReplayedFrame& from = flight.frames[i > 0 ? i - 1 : 0];
    const ReplayedFrame& to = flight.frames[std::min(i + 1, flight.frames.size() - 1)];
    if (!is_usable(from) || !is_usable(to)) continue;
    const double way_s = to.time_s - from.time_s;
    if (!(way_s >= kShortestWay_s && way_s <= kLongestWay_s)) continue;
    const GeodesicLeg leg = geodesic_between(from.place, to.place);
    tracks[i] = {leg.length_m > 0 ? leg.start_azimuth_deg : std::numeric_limits<double>::quiet_NaN(),
                 leg.length_m / way_s};
  }
  return tracks;
}

std::vector<std::optional<LinePlace>> places_on_line(const ReplayedFlight& flight, const Mission& mission) {
  const std::vector<FlightSample>& samples = mission.flight.samples;
  const double corridor_m = mission.flight.corridor_half_width_m;
  const std::vector<FlownTrack> tracks = flown_track(flight);
  std::vector<std::optional<LinePlace>> places(flight.frames.size());
  for (std::size_t i = 0; i < flight.frames.size(); ++i) {
    const ReplayedFrame& frame = flight.frames[i];
    if (frame.place_from == PlaceSource::kNone) continue;
    const auto nearest = nearest_sample(samples, frame.place, tracks[i].track_deg);
    if (!nearest) continue;
    const FlightSample& sample = samples[*nearest];
    LinePlace place;
    place.sample = *nearest;
    place.leg = sample.leg;
    place.offset_m = geodesic_between(sample.point, frame.place).length_m;
    if (place.offset_m > std::max(kOffTheLine_m, 3 * corridor_m)) continue;
    place.height_error_m = frame.height_agl_m - sample.agl_m;
    place.heading_error_deg = std::remainder(tracks[i].track_deg - sample.azimuth_deg, 360.0);
    place.speed_mps = tracks[i].speed_mps;
    place.planned_speed_mps = sample.speed_mps;
    place.beyond_corridor = place.offset_m > corridor_m;
    place.beyond_heights = std::isfinite(frame.height_agl_m) && !is_served(mission, frame.height_agl_m);
    places[i] = place;
  }
  return places;
}

}  // namespace pilotage
