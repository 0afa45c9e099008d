#include "pilotage/vehiclelog/pose_at.h"

#include <algorithm>
#include <cmath>

namespace pilotage {
namespace {

/// The records around a time, and how far between them it lies.
template <class Record>
struct Neighbours {
  const Record& before;
  const Record& after;
  double share = 0;
};

template <class Record>
std::optional<Neighbours<Record>> neighbours_of(const std::vector<Record>& records, double time_s, double reach_s) {
  const auto after = std::lower_bound(records.begin(), records.end(), time_s,
                                      [](const Record& record, double time) { return record.time_s < time; });
  const bool has_after = after != records.end() && after->time_s - time_s <= reach_s;
  const bool has_before = after != records.begin() && time_s - (after - 1)->time_s <= reach_s;
  if (!has_after && !has_before) return std::nullopt;
  const Record& first = has_before ? *(after - 1) : *after;
  const Record& last = has_after ? *after : first;
  const double between_s = last.time_s - first.time_s;
  return Neighbours<Record>{first, last, between_s > 0 ? (time_s - first.time_s) / between_s : 0};
}

double between(double a, double b, double share) {
  return a + share * (b - a);
}

double angle_between(double a_deg, double b_deg, double share) {
  return a_deg + share * std::remainder(b_deg - a_deg, 360.0);
}

}  // namespace

std::optional<LoggedPosition> position_at(const std::vector<LoggedPosition>& positions, double time_s, double reach_s) {
  const auto found = neighbours_of(positions, time_s, reach_s);
  if (!found) return std::nullopt;
  const auto& [before, after, share] = *found;
  const double lon_deg =
      between(before.point.lon_deg, unwrap_lon_deg(after.point.lon_deg, before.point.lon_deg), share);
  return LoggedPosition{time_s,
                        {wrap_lon_deg(lon_deg), between(before.point.lat_deg, after.point.lat_deg, share)},
                        between(before.amsl_m, after.amsl_m, share)};
}

std::optional<Attitude> attitude_at(const std::vector<LoggedAttitude>& attitudes, double time_s, double reach_s) {
  const auto found = neighbours_of(attitudes, time_s, reach_s);
  if (!found) return std::nullopt;
  const Attitude& before = found->before.attitude;
  const Attitude& after = found->after.attitude;
  return Attitude{std::remainder(angle_between(before.yaw_deg, after.yaw_deg, found->share), 360.0),
                  angle_between(before.pitch_deg, after.pitch_deg, found->share),
                  angle_between(before.roll_deg, after.roll_deg, found->share)};
}

std::optional<double> height_at(const std::vector<LoggedHeight>& heights, double time_s, double reach_s) {
  const auto found = neighbours_of(heights, time_s, reach_s);
  if (!found) return std::nullopt;
  return between(found->before.agl_m, found->after.agl_m, found->share);
}

}  // namespace pilotage
