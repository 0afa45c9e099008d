#include "pilotage/mission/gnss_availability.h"

#include <algorithm>
#include <limits>

namespace pilotage {
namespace {

GnssAvailability availability(const Flight& flight, const std::vector<DeniedStretch>& stretches) {
  const std::vector<FlightSample>& samples = flight.samples;
  GnssAvailability gnss = gnss_everywhere(flight, true);
  for (const DeniedStretch& stretch : stretches) {
    const auto from = std::lower_bound(samples.begin(), samples.end(), stretch.from_distance_m,
                                       [](const FlightSample& a, double b_m) { return a.distance_m < b_m; });
    auto i = static_cast<std::size_t>(from - samples.begin());
    if (i > 0) --i;
    for (; i < samples.size() && samples[i].distance_m <= stretch.to_distance_m; ++i) {
      const double at_m = samples[i].distance_m;
      const bool last = i + 1 == samples.size();
      if (!last && at_m < stretch.to_distance_m && samples[i + 1].distance_m > stretch.from_distance_m) {
        gnss.over_step[i] = false;
      }
      // Of two samples at one place, where the course changes, GNSS is lost at the second.
      const bool lost_here = at_m >= stretch.from_distance_m && (last || !gnss.over_step[i]);
      if (lost_here && (at_m < stretch.to_distance_m || last)) gnss.at_sample[i] = false;
    }
  }
  return gnss;
}

}  // namespace

GnssAvailability gnss_availability(const Flight& flight) {
  if (!flight.denied.stretches.empty()) return availability(flight, flight.denied.stretches);
  return gnss_everywhere(flight, false);
}

GnssAvailability gnss_lost_at(const Flight& flight, double distance_m) {
  return availability(flight, {{distance_m, std::numeric_limits<double>::infinity()}});
}

GnssAvailability gnss_everywhere(const Flight& flight, bool had) {
  const std::size_t count = flight.samples.size();
  return {std::vector<bool>(count, had), std::vector<bool>(count == 0 ? 0 : count - 1, had)};
}

}  // namespace pilotage
