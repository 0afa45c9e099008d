#include "pilotage/route/track_speed.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "pilotage/base/text.h"
#include "pilotage/route/route_builder.h"

namespace pilotage {
namespace {

/// Steps first … end − 1, averaged together.
struct StepGroup {
  std::size_t first = 0;
  std::size_t end = 0;
  double length_m = 0;
  double passed_s = 0;

  bool is_long() const { return passed_s >= kTrackAverage_s; }
};

std::vector<StepGroup> groups_of(const std::vector<TrackStep>& steps) {
  std::vector<StepGroup> groups;
  bool open = false;
  const auto close = [&] {
    // A short rest belongs to the group it follows.
    if (open && !groups.back().is_long() && groups.size() > 1) {
      StepGroup& before = groups[groups.size() - 2];
      if (before.end == groups.back().first) {
        before.end = groups.back().end;
        before.length_m += groups.back().length_m;
        before.passed_s += groups.back().passed_s;
        groups.pop_back();
      }
    }
    open = false;
  };
  for (std::size_t i = 0; i < steps.size(); ++i) {
    if (!(steps[i].passed_s >= 0)) {
      close();
      continue;
    }
    if (!open || groups.back().is_long()) groups.push_back({i, i});
    open = true;
    groups.back().end = i + 1;
    groups.back().length_m += steps[i].length_m;
    groups.back().passed_s += steps[i].passed_s;
  }
  close();
  return groups;
}

std::string speed_text(double speed_mps) {
  return format_fixed(speed_mps, 1) + " m/s";
}

}  // namespace

void set_track_speeds(Route& route, const TrackTimes& times) {
  double length_m = 0;
  double passed_s = 0;
  double still_s = times.still_s;
  double slowest_mps = INFINITY;
  double fastest_mps = 0;
  std::size_t timed = 0;
  for (const StepGroup& group : groups_of(times.steps)) {
    const double speed_mps = group.length_m / group.passed_s;  // infinite where no time passes
    if (speed_mps < kSlowest_mps) still_s += group.passed_s;
    if (!(speed_mps >= kSlowest_mps && speed_mps <= kFastest_mps)) continue;
    for (std::size_t i = group.first; i < group.end; ++i) {
      route.vertices[static_cast<std::size_t>(times.steps[i].vertex)].speed_mps = speed_mps;
    }
    length_m += group.length_m;
    passed_s += group.passed_s;
    slowest_mps = std::min(slowest_mps, speed_mps);
    fastest_mps = std::max(fastest_mps, speed_mps);
    timed += group.end - group.first;
  }
  if (timed == 0) {
    add_note(route, "The times of the positions give no speed: they do not increase, or the speeds are outside " +
                        format_number(kSlowest_mps) + " to " + format_number(kFastest_mps) + " m/s.");
    return;
  }
  const double mean_mps = length_m / passed_s;
  for (RouteVertex& vertex : route.vertices) {
    if (std::isnan(vertex.speed_mps)) vertex.speed_mps = mean_mps;
  }
  std::string note = "Speeds come from the times of the positions, averaged over " + format_number(kTrackAverage_s) +
                     " s or more: " + speed_text(slowest_mps) + " to " + speed_text(fastest_mps) + ".";
  const std::size_t untimed = times.steps.size() - timed;
  if (untimed > 0) {
    note += " " + std::to_string(untimed) + " of " + std::to_string(times.steps.size()) +
            " legs, whose times are missing, do not increase or give no such speed, take the mean, " +
            speed_text(mean_mps) + ".";
  }
  if (still_s >= 1) note += " " + format_fixed(still_s, 0) + " s of standing still are not counted.";
  add_note(route, note);
}

}  // namespace pilotage
