#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "pilotage/flightlog/frame_match.h"

namespace pilotage {

/// The median of a quantity over the fixes of a flight: it says which way they lean together, what no single frame can
/// show.
struct Lean {
  double median = std::numeric_limits<double>::quiet_NaN();  ///< NaN without a value.
  /// What holds, with probability 0.999, the median of what the values are drawn from, if they are independent: two of
  /// the values, by the sign test (W. J. Conover, "Practical Nonparametric Statistics", 1999, section 3.2), whatever
  /// their distribution. Without bound for fewer than eleven.
  double low = -std::numeric_limits<double>::infinity();
  double high = std::numeric_limits<double>::infinity();
};

/// Lean of any values.
Lean lean_of(std::vector<double> values);

/// How the fixes of a flight lie against what was told and what is true. A height that is told too low, as by an
/// elevation model of another datum, makes every fix higher than told; a map that is shifted shifts every fix.
struct FixLean {
  /// Fixes, and the best places that were refused because their height contradicts the one that was told: heights that
  /// are told far off leave hardly anything else.
  std::int64_t heights = 0;
  Lean height_share;  ///< Of their height_agl_m over the told one, less 1.
  Lean height_m;      ///< Of the difference.

  std::int64_t judged = 0;  ///< Fixes whose true place is known.
  Lean east_m, north_m;     ///< Of FrameMatch::error.
  /// By how much all of them may lean together, each axis, one standard deviation: the medians of the map's error and
  /// of what the attitude's error moves an aircraft's place by (nothing where the centre of the image is judged).
  double common_sigma_m = 0;
};

/// `options`: what the fixes were matched with.
FixLean lean_of_fixes(std::span<const FrameMatch> matches, const MatchOptions& options);

/// Sentences where fixes lean by more than what was told explains: the median of their heights is beyond twice
/// MatchOptions::height_sigma_fraction and its interval beyond once, or the nearest place of the intervals of east and
/// north is beyond χ² 0.999 of common_sigma_m. Scales are searched a little farther than twice, so a lean of three
/// times and more is seen as less, or leaves no fix.
std::vector<std::string> lean_warnings(const FixLean& lean, const MatchOptions& options);

/// "lean" of a flight's summary, bounds that there are none of as null; null without such a place.
nlohmann::ordered_json to_json(const FixLean& lean);

/// A line for people; "" without such a place.
std::string lean_text(const FixLean& lean);

}  // namespace pilotage
