#pragma once

#include <string>
#include <vector>

#include "ring_flight.h"
#include <nlohmann/json_fwd.hpp>

namespace pilotage {

/// Over all flights.
struct RingSummary {
  int flights = 0;
  int rings = 0;
  int found = 0;
  int false_rings = 0;
  double median_error_m = 0;  ///< Of the positions of the found ones.
  double worst_error_m = 0;
  double mean_nees = 0;  ///< 3 where the array's covariances are honest.
  int crossed_with = 0;  ///< Rings.
  int crossed_without = 0;
  int all_with = 0;  ///< Flights that crossed all rings in order.
  int all_without = 0;
  int collisions_with = 0;
  double worst_offset_m = 0;  ///< From the axes of the rings that were crossed with fixes.
};
RingSummary summarise(const std::vector<RingFlight>& flights);

/// rings.json: truth, array and crossings of each flight, and the summary.
nlohmann::ordered_json rings_json(const std::vector<RingFlight>& flights, const GeodeticPoint& middle);

/// What happened, as tables for people; of one flight ring by ring.
std::string rings_text(const std::vector<RingFlight>& flights);

/// The field from above: rings, array with its ellipses of 3 σ ten times as large as they are, decoys, and the paths of
/// the scan, with fixes and without.
std::string rings_svg(const RingFlight& flight);

}  // namespace pilotage
