#include "pilotage/mission/flight_time.h"

namespace pilotage {

double step_time_s(const FlightSample& from, const FlightSample& to) {
  return (to.distance_m - from.distance_m) / from.speed_mps;
}

double flight_time_s(const std::vector<FlightSample>& samples) {
  double time_s = 0;
  for (std::size_t i = 1; i < samples.size(); ++i) time_s += step_time_s(samples[i - 1], samples[i]);
  return time_s;
}

}  // namespace pilotage
