#pragma once

#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "pilotage/base/utc_time.h"
#include "pilotage/geo/sun_position.h"
#include "pilotage/mission/mission.h"
#include "pilotage/verdict/quality.h"

#pragma GCC visibility push(default)

// How old the imagery is when it is flown over, and how differently the sun then lights the ground. Known where the
// planner says when the flight is (TileOptions::flight_time).

namespace pilotage {

/// A raster of the reference imagery beside the flight.
struct DatasetAge {
  std::string dataset;
  std::string acquired;                                          ///< "" when it is not known; then nothing else is.
  double age_months = std::numeric_limits<double>::quiet_NaN();  ///< Months of 1/12 year; negative: after the flight.
  double season_months = std::numeric_limits<double>::quiet_NaN();  ///< Apart in the year, 0 … 6.
  bool hour_known = false;         ///< Otherwise the sun is that of noon by the sun of the day.
  std::optional<SunPosition> sun;  ///< Over the middle of the route.
};

/// The sun over the middle of the route at a moment of the flight's day.
struct FlightSun {
  UtcTime time;
  SunPosition sun;
  /// How far the tip of the shadow of an object 10 m high lies from where the imagery shows it, over flat ground; the
  /// largest over the rasters whose sun stands at least kLowSun_deg high. NaN without one, and when this sun is lower.
  double shadow_shift_m = std::numeric_limits<double>::quiet_NaN();

  bool shift_is_known() const { return std::isfinite(shadow_shift_m); }
};

struct ImageryAge {
  static constexpr double kLowSun_deg = 5;  ///< Lower than this shadows are longer than eleven times the height.

  std::string flight_time;  ///< As given.
  std::vector<DatasetAge> datasets;
  std::optional<FlightSun> flight;  ///< Half-way through the flight; nothing when only its day is known.
  std::vector<FlightSun> hours;     ///< At the full hours UTC of that day with the sun at least kLowSun_deg high.
};

/// "14:05", UTC.
std::string clock_text(UtcTime time);

/// Nothing without a time of the flight. Throws DataError when that is none, or the flight has no sample.
std::optional<ImageryAge> imagery_age(const Mission& mission);

/// The same of imagery over a place, without a flight: nothing of the sun on that day. `flight_time` must be one that
/// parse_utc_date() takes.
ImageryAge imagery_age(const std::vector<ImageryDataset>& imagery, GeodeticPoint place, const std::string& flight_time);

/// The raster whose date is farthest from the flight's, before or after it; nullptr when no date is known.
const DatasetAge* farthest_in_time(const ImageryAge& age);

/// What a planner should know of it, sentence by sentence; the last says when the shadows differ least and most.
std::vector<std::string> imagery_age_sentences(const ImageryAge& age);

/// "imagery 35 months old, 1 month apart in season (P(correct fix) counts the age by a rule of thumb, not the season)":
/// of several the raster that is farthest from the flight, and the season that is farthest off. `counted`: whether the
/// P of what is spoken of counts the age (counted_age_months() in matchability/level_at_age.h); nothing: there is no P.
std::string imagery_age_phrase(const ImageryAge& age, std::optional<bool> counted);

/// What age did where it was measured (docs/methods/matchability.md): a part of a sentence.
std::string imagery_age_measured();

/// ", ", imagery_age_phrase() and how often the ground is hidden, for the line of assumptions; "" without a time of
/// the flight. Of a flight without samples (over an area, whose line is still to be drawn) seasons are those of the
/// middle of its ground.
std::string imagery_age_assumptions(const Mission& mission, std::optional<bool> counted);

/// Rows for age and season, for the sun where the hour is known (it decides), and for clouds where a table was given.
std::vector<QualityRow> imagery_age_rows(const Mission& mission);

}  // namespace pilotage

#pragma GCC visibility pop
