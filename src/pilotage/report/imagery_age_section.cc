#include "pilotage/report/imagery_age_section.h"

#include <nlohmann/json.hpp>

#include "pilotage/base/markup.h"
#include "pilotage/base/variant_json.h"
#include "pilotage/base/wording.h"
#include "pilotage/report/page_parts.h"
#include "pilotage/report/tile_fields.h"

namespace pilotage {
namespace {

using Json = nlohmann::ordered_json;

}  // namespace

std::string imagery_age_html(const std::optional<ImageryAge>& age) {
  if (!age) return "";
  std::string html =
      "<section aria-labelledby=\"age-heading\">\n  <h2 id=\"age-heading\">Age of the imagery, and its light</h2>\n";
  for (const std::string& sentence : imagery_age_sentences(*age)) html += "  <p>" + html_escape(sentence) + "</p>\n";
  if (age->hours.empty()) return html + "</section>\n";
  std::string rows;
  for (const FlightSun& at : age->hours) {
    rows += "<tr>" + heading_html(clock_text(at.time)) +
            cell_html("Sun's height", number_text(at.sun.elevation_deg, 0) + "°") +
            cell_html("Azimuth", number_text(at.sun.azimuth_deg, 0) + "°") +
            cell_html("Shadows of 10 m end off by", at.shift_is_known() ? error_text(at.shadow_shift_m) : "–") +
            "</tr>\n";
  }
  return html + "  <details><summary>Sun and shadows by the hour</summary>\n" +
         table_html("Table of the sun by the hour", {"UTC", "Sun's height", "Azimuth", "Shadows of 10 m end off by"},
                    rows) +
         "</details>\n</section>\n";
}

Json imagery_age_json(const ImageryAge& age) {
  const auto number = [](double value) { return variant_to_json(number_value(value)); };
  const auto sun_json = [&](const SunPosition& sun) {
    return Json{{"azimuth_deg", number(sun.azimuth_deg)}, {"elevation_deg", number(sun.elevation_deg)}};
  };
  const auto flight_json = [&](const FlightSun& at) {
    return Json{{"time_utc", format_utc_time(at.time)},
                {"sun", sun_json(at.sun)},
                {"shadow_shift_m", number(at.shadow_shift_m)}};
  };
  Json json = {{"flight_time", age.flight_time}, {"datasets", Json::array()}};
  for (const DatasetAge& imagery : age.datasets) {
    json["datasets"].push_back({{"dataset", imagery.dataset},
                                {"acquired", imagery.acquired},
                                {"age_months", number(imagery.age_months)},
                                {"season_months", number(imagery.season_months)},
                                {"hour_known", imagery.hour_known},
                                {"sun", imagery.sun ? sun_json(*imagery.sun) : Json()}});
  }
  json["flight"] = age.flight ? flight_json(*age.flight) : Json();
  json["hours"] = Json::array();
  for (const FlightSun& at : age.hours) json["hours"].push_back(flight_json(at));
  return json;
}

}  // namespace pilotage
