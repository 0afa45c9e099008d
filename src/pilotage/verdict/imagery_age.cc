#include "pilotage/verdict/imagery_age.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>

#include <Eigen/Core>

#include "pilotage/base/angle.h"
#include "pilotage/base/error.h"
#include "pilotage/base/nan.h"
#include "pilotage/base/text.h"
#include "pilotage/base/utf8.h"
#include "pilotage/base/wording.h"
#include "pilotage/ground/imagery_months.h"
#include "pilotage/matchability/level_at_age.h"
#include "pilotage/mission/flight_time.h"

namespace pilotage {
namespace {

constexpr double kShadowHeight_m = 10;
// Rules of thumb, and said to be: no measurement stands behind them.
constexpr double kAgeGood_months = 24;
constexpr double kSeasonGood_months = 2;
constexpr double kSunGood_deg = 15;
constexpr double kSunset_deg = -0.833;  // the upper edge of the sun, lifted by refraction, on the horizon
constexpr double kHiddenGood = 0.1;

/// The shadow of what is one metre high, on flat ground, east and north.
Eigen::Vector2d shadow_enu_m(const SunPosition& sun) {
  const double length_m = 1 / std::tan(sun.elevation_deg * kRadPerDeg);
  const double azimuth_rad = sun.azimuth_deg * kRadPerDeg;
  return {-length_m * std::sin(azimuth_rad), -length_m * std::cos(azimuth_rad)};
}

bool casts_shadows(const SunPosition& sun) {
  return sun.elevation_deg >= ImageryAge::kLowSun_deg;
}

/// The moment of a UTC day at which the sun stands highest over a point, to a minute.
UtcTime solar_noon(GeodeticPoint point, UtcTime day) {
  UtcTime noon = day;
  double highest_deg = -90;
  for (int minute = 0; minute < 24 * 60; ++minute) {
    const UtcTime time = day + std::chrono::minutes(minute);
    const double elevation_deg = sun_position(point, time).elevation_deg;
    if (elevation_deg <= highest_deg) continue;
    highest_deg = elevation_deg;
    noon = time;
  }
  return noon;
}

DatasetAge dataset_age(const ImageryDataset& imagery, GeodeticPoint point, UtcTime flight) {
  DatasetAge age;
  age.dataset = name_as_utf8(imagery.dataset);
  const auto acquired = parse_utc_date(imagery.acquired);
  if (!acquired) return age;  // a date that no calendar has is no date
  age.acquired = imagery.acquired;
  age.age_months = months_between(acquired->time, flight);
  age.season_months = std::abs(std::remainder(age.age_months, 12));
  age.hour_known = acquired->has_clock;
  age.sun = sun_position(point, acquired->has_clock ? acquired->time : solar_noon(point, acquired->time));
  return age;
}

FlightSun flight_sun(const ImageryAge& age, GeodeticPoint point, UtcTime time) {
  FlightSun at{time, sun_position(point, time), kNaN};
  if (!casts_shadows(at.sun)) return at;
  for (const DatasetAge& imagery : age.datasets) {
    if (!imagery.sun || !casts_shadows(*imagery.sun)) continue;
    const double shift_m = kShadowHeight_m * (shadow_enu_m(at.sun) - shadow_enu_m(*imagery.sun)).norm();
    if (!(shift_m <= at.shadow_shift_m)) at.shadow_shift_m = shift_m;  // the first one, too
  }
  return at;
}

std::string age_text(double age_months, double season_months) {
  if (age_months < 0) return months_text(-age_months) + " younger than the flight";
  return months_text(age_months) + " old, " + months_text(season_months) + " apart in season";
}

/// Of the rasters whose date is known, that whose season is farthest from the flight's.
double farthest_season_months(const ImageryAge& age) {
  double season_months = 0;
  for (const DatasetAge& next : age.datasets) {
    if (!next.acquired.empty()) season_months = std::max(season_months, next.season_months);
  }
  return season_months;
}

bool all_dated(const ImageryAge& age) {
  return std::none_of(age.datasets.begin(), age.datasets.end(),
                      [](const DatasetAge& next) { return next.acquired.empty(); });
}

/// " (P(correct fix) counts …)": what it makes of both; "" where there is no P.
std::string counted_text(const ImageryAge& age, std::optional<bool> counted) {
  if (!counted) return "";
  if (*counted) return " (P(correct fix) counts the age by a rule of thumb, not the season)";
  return std::string(" (P(correct fix) counts neither") +
         (all_dated(age) ? "" : "; of some imagery the date is not known") + ")";
}

std::string sun_text(const SunPosition& sun) {
  if (sun.elevation_deg < kSunset_deg) return format_fixed(-sun.elevation_deg, 0) + "° below the horizon";
  return format_fixed(sun.elevation_deg, 0) + "° high in " + format_fixed(sun.azimuth_deg, 0) + "°";
}

QualityRow age_row(const ImageryAge& age) {
  QualityRow row;
  row.name = "imagery_age";
  row.label = "Age of the imagery at the flight";
  row.unit = "months";
  row.threshold = "good up to 24 months and 2 months apart in season, marginal beyond (a rule of thumb, not measured)";
  const DatasetAge* first = farthest_in_time(age);
  if (first == nullptr) {
    row.value = "not known";
    row.status = QualityStatus::kMarginal;
    row.advice = "Say when the imagery was taken (--imagery-date).";
    return row;
  }
  const bool known = all_dated(age);
  const double season_months = farthest_season_months(age);
  row.number = first->age_months;
  row.value = age_text(first->age_months, first->season_months);
  if (age.datasets.size() > 1) {
    row.value = "farthest from the flight: " + row.value + "; season apart up to " + months_text(season_months);
  }
  if (!known) row.value += "; of some it is not known";
  if (known && std::abs(first->age_months) <= kAgeGood_months && season_months <= kSeasonGood_months) return row;
  row.status = QualityStatus::kMarginal;
  row.advice =
      "Ground changes with the years and plants with the season: take imagery nearer to the flight, or prepare with a "
      "second date of it (--second-epoch), which is then measured.";
  return row;
}

QualityRow sun_row(const FlightSun& flight) {
  QualityRow row;
  row.name = "flight_sun";
  row.label = "Sun half-way through the flight";
  row.number = flight.sun.elevation_deg;
  row.unit = "deg";
  row.value = sun_text(flight.sun);
  if (flight.shift_is_known()) {
    row.value += "; shadows of 10 m end " + error_text(flight.shadow_shift_m) + " from those of the imagery";
  }
  row.threshold = "good from 15° up (a rule of thumb, not measured), marginal below, bad when it has set";
  row.decides = true;
  if (flight.sun.elevation_deg >= kSunGood_deg) return row;
  const bool set = flight.sun.elevation_deg < kSunset_deg;
  row.status = set ? QualityStatus::kBad : QualityStatus::kMarginal;
  row.advice = set ? "A camera sees no ground by night as imagery taken by day shows it: fly by day."
                   : "Long shadows cover what the imagery shows: fly nearer to noon.";
  return row;
}

QualityRow hidden_row(const GroundHidden& hidden) {
  QualityRow row;
  row.name = "ground_hidden";
  row.label = "Ground hidden by cloud or fog";
  row.number = hidden.fraction;
  row.value = percent_text(hidden.fraction) + " of the time, by " + name_as_utf8(hidden.file);
  row.threshold = "good up to 10 % of the time, marginal beyond (a rule of thumb); no probability here counts it";
  if (hidden.fraction <= kHiddenGood) return row;
  row.status = QualityStatus::kMarginal;
  row.advice = "Look at the forecast before take-off: under cloud there is no fix.";
  return row;
}

}  // namespace

std::string clock_text(UtcTime time) {
  return format_utc_time(time).substr(11, 5);
}

std::optional<ImageryAge> imagery_age(const Mission& mission) {
  const Flight& flight = mission.flight;
  const std::string& flight_time = mission.ground.flight_time;
  if (flight_time.empty()) return std::nullopt;
  const auto begins = parse_utc_date(flight_time);
  if (!begins) throw DataError("the time of the flight, \"" + flight_time + "\", is no day and no moment in UTC");
  if (flight.samples.empty()) throw DataError("the flight has no sample");
  const double middle_m = (flight.samples.front().distance_m + flight.samples.back().distance_m) / 2;
  const auto middle = std::find_if(flight.samples.begin(), flight.samples.end() - 1,
                                   [&](const FlightSample& sample) { return sample.distance_m >= middle_m; });
  const double time_s = flight_time_s(flight.samples);
  ImageryAge age = imagery_age(mission.ground.imagery.datasets, middle->point, flight_time);
  const auto day = std::chrono::floor<std::chrono::days>(begins->time);
  if (begins->has_clock) {
    const auto half_s = static_cast<std::int64_t>(std::isfinite(time_s) ? std::llround(time_s / 2) : 0);
    age.flight = flight_sun(age, middle->point, begins->time + std::chrono::seconds(half_s));
  }
  for (int hour = 0; hour < 24; ++hour) {
    const FlightSun at = flight_sun(age, middle->point, day + std::chrono::hours(hour));
    if (casts_shadows(at.sun)) age.hours.push_back(at);
  }
  return age;
}

ImageryAge imagery_age(const std::vector<ImageryDataset>& imagery, GeodeticPoint place,
                       const std::string& flight_time) {
  ImageryAge age;
  age.flight_time = flight_time;
  const UtcDate begins = utc_date_of_option("flight_time", flight_time);
  for (const ImageryDataset& dataset : imagery) age.datasets.push_back(dataset_age(dataset, place, begins.time));
  return age;
}

const DatasetAge* farthest_in_time(const ImageryAge& age) {
  const DatasetAge* found = nullptr;
  for (const DatasetAge& next : age.datasets) {
    if (next.acquired.empty()) continue;
    if (found == nullptr || std::abs(next.age_months) > std::abs(found->age_months)) found = &next;
  }
  return found;
}

std::vector<std::string> imagery_age_sentences(const ImageryAge& age) {
  std::vector<std::string> sentences;
  for (const DatasetAge& imagery : age.datasets) {
    if (imagery.acquired.empty()) {
      sentences.push_back(imagery.dataset + ": when it was taken is not known.");
      continue;
    }
    sentences.push_back(imagery.dataset + ", of " + imagery.acquired + ": " +
                        age_text(imagery.age_months, imagery.season_months) + "; the sun stood " +
                        sun_text(*imagery.sun) +
                        (imagery.hour_known ? "." : ", if it was taken at noon: its hour is not known."));
  }
  sentences.push_back(
      "The default P(correct fix) counts the age, where it is known of all imagery, by a rule reasoned from few "
      "places (" +
      level_per_age_text() +
      "), and does not count the season; a model of one's own counts neither: " + imagery_age_measured() + ".");
  if (age.flight) {
    std::string text = "Half-way through the flight, at " + clock_text(age.flight->time) + " UTC, it stands " +
                       sun_text(age.flight->sun);
    if (age.flight->shift_is_known()) {
      text += ": the shadow of what is 10 m high then ends " + error_text(age.flight->shadow_shift_m) +
              " from where the imagery has it";
    }
    sentences.push_back(text + ".");
  }
  if (age.hours.empty()) {
    sentences.emplace_back("On that day the sun does not rise to 5° at any full hour.");
  } else if (age.hours.front().shift_is_known()) {
    const auto [least, most] =
        std::minmax_element(age.hours.begin(), age.hours.end(),
                            [](const FlightSun& a, const FlightSun& b) { return a.shadow_shift_m < b.shadow_shift_m; });
    sentences.push_back("That day shadows differ least at " + clock_text(least->time) + " UTC (" +
                        error_text(least->shadow_shift_m) + ") and most at " + clock_text(most->time) + " UTC (" +
                        error_text(most->shadow_shift_m) + ").");
  }
  return sentences;
}

std::string imagery_age_phrase(const ImageryAge& age, std::optional<bool> counted) {
  const std::string imagery = age.datasets.size() > 1 ? "imagery up to " : "imagery ";
  const DatasetAge* first = farthest_in_time(age);
  if (first == nullptr) {
    return std::string("imagery of unknown age") + (counted ? ", which P(correct fix) does not count" : "");
  }
  return imagery + age_text(first->age_months, farthest_season_months(age)) + counted_text(age, counted);
}

std::string imagery_age_measured() {
  return "of frames over a building site, where P without a date is 0.28, 41 % were found 2 months after the imagery, "
         "20 % after 9 months and 16 % after 22";
}

std::string imagery_age_assumptions(const Mission& mission, std::optional<bool> counted) {
  const Ground& ground = mission.ground;
  const bool over_ground = mission.flight.samples.empty() && !ground.flight_time.empty() && !ground.tiles.empty();
  const auto age = over_ground ? imagery_age(ground.imagery.datasets, ground.tiles[ground.tiles.size() / 2].center,
                                             ground.flight_time)
                               : imagery_age(mission);
  if (!age) return "";
  std::string text = ", " + imagery_age_phrase(*age, counted);
  if (const auto& hidden = mission.flight.ground_hidden) {
    text += ", ground in sight (it is hidden " + percent_text(hidden->fraction) + " of the time)";
  }
  return text;
}

std::vector<QualityRow> imagery_age_rows(const Mission& mission) {
  const auto age = imagery_age(mission);
  if (!age) return {};
  std::vector<QualityRow> rows = {age_row(*age)};
  if (age->flight) rows.push_back(sun_row(*age->flight));
  if (mission.flight.ground_hidden) rows.push_back(hidden_row(*mission.flight.ground_hidden));
  return rows;
}

}  // namespace pilotage
