#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace pilotage {

/// A stretch of the route over which the aircraft gets no fix.
struct RouteGap {
  int leg = 0;                 ///< Leg on which it starts.
  double from_distance_m = 0;  ///< Along the route.
  double to_distance_m = 0;
  double duration_s = 0;
  double error_m = 0;  ///< Predicted error (k·σ) at its end.
  bool within_limit = true;
};

struct LegStatus {
  int leg = 0;
  double length_m = 0;
  double matchable_fraction = 0;  ///< Share of its length over selected tiles.
  double max_error_m = 0;         ///< Largest predicted error on it (k·σ).
  bool within_limit = true;
};

/// Predicted error along the route, for the strip chart.
struct ErrorSample {
  double distance_m = 0;
  double error_m = 0;
  bool matchable = false;
};

/// What `select` decides: which tiles are stored, and what the route looks like with them.
struct Selection {
  std::vector<std::int64_t> tile_ids;  ///< Ascending.
  std::vector<RouteGap> gaps;
  std::vector<LegStatus> legs;
  std::vector<ErrorSample> error_profile;
  double matchable_fraction = 0;  ///< Of the whole route's length.
  double max_error_m = 0;         ///< The limit that was asked for.
  double sigma_multiple = 3;      ///< k of k·σ.
  bool within_limit = true;       ///< No gap lets the error exceed the limit.
  std::int64_t estimated_bytes = 0;
  std::vector<std::string> notes;
};

}  // namespace pilotage
