#include "pilotage/report/map_ageing.h"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include <nlohmann/json.hpp>

#include "pilotage/base/markup.h"
#include "pilotage/base/text.h"
#include "pilotage/base/variant_json.h"
#include "pilotage/base/wording.h"
#include "pilotage/matchability/level_at_age.h"
#include "pilotage/report/page_parts.h"
#include "pilotage/report/report.h"
#include "pilotage/report/tile_fields.h"
#include "pilotage/verdict/map_holds.h"

namespace pilotage {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kHalfFound = "Stored tiles under the route found at least every second time";

}  // namespace

std::optional<MapAgeing> map_ageing(const Mission& mission, const Selection& selection,
                                    const std::vector<ReportTile>& tiles) {
  if (!selection.ageing || !selection.probability) return std::nullopt;
  const UtcTime oldest = dated_imagery(mission.ground);
  MapAgeing ageing;
  ageing.sentence = ageing_sentence(mission, selection);
  // By the age up to which they are found every second time; those that are not now count as 0, the weakest first.
  std::vector<std::pair<double, const ReportTile*>> stale;
  for (const ReportTile& tile : tiles) {
    const bool is_below_route = tile.place.offset_m <= tile.tile.bounds.width_m() / 2;
    if (!tile.selected || !is_below_route || std::isnan(tile.score.p_correct_fix)) continue;
    stale.emplace_back(half_found_up_to_months(tile.score).value_or(0), &tile);
  }
  std::sort(stale.begin(), stale.end(), [](const auto& a, const auto& b) {
    return std::tuple(a.first, a.second->score.p_correct_fix, a.second->tile.tile_id) <
           std::tuple(b.first, b.second->score.p_correct_fix, b.second->tile.tile_id);
  });
  for (const ChancesAtAge& at : selection.ageing->ages) {
    RouteProbability route = *selection.probability;
    route.p_within_limit = at.p_within_limit;
    route.interval = at.interval;
    const double later_months = at.age_months - selection.ageing->ages.front().age_months;
    const auto still = std::count_if(stale.begin(), stale.end(), [&](const auto& tile) {
      return is_half_found_later(tile.second->score, later_months);
    });
    ageing.flights.push_back({day_at_age(oldest, at.age_months), at, judge_route(route), still});
  }
  const auto day = [&](const std::optional<double>& up_to_months) {
    return up_to_months ? day_at_age(oldest, *up_to_months) : "";
  };
  ageing.enough_until = day(selection.ageing->enough_up_to_months);
  ageing.surely_until = day(selection.ageing->surely_up_to_months);
  for (const auto& [up_to_months, tile] : stale) {
    if (ageing.refresh.size() == kMostStaleTiles || up_to_months >= kMostAge_months) break;
    ageing.refresh.push_back({tile->tile.tile_id, tile->tile.center, tile->half_found_until});
  }
  return ageing;
}

std::string ageing_html(const std::optional<MapAgeing>& ageing) {
  if (!ageing) return "";
  std::string html =
      "<section aria-labelledby=\"ageing-heading\">\n  <h2 id=\"ageing-heading\">How long this map holds " +
      kind_mark(NumberKind::kModelled) + "</h2>\n  <p>" + html_escape(ageing->sentence) + ".</p>\n";
  std::string rows;
  for (const LaterFlight& flight : ageing->flights) {
    const ChancesAtAge& at = flight.chances;
    rows += "<tr>" + heading_html(rows.empty() ? flight.day : month_of(flight.day)) +
            cell_html("Imagery is then", months_text(at.age_months)) +
            cell_html("P within the limit", probability_text(at.p_within_limit)) +
            cell_html("80 % interval", probability_text(at.interval.low) + " … " + probability_text(at.interval.high)) +
            cell_html("By P alone", std::string(verdict_name(flight.status))) +
            cell_html(kHalfFound, std::to_string(flight.tiles_half_found)) + "</tr>\n";
  }
  html += table_html("Table of later flights by this map",
                     {"Flown on", "Imagery is then", "P within the limit", "80 % interval", "By P alone", kHalfFound},
                     rows);
  if (ageing->refresh.empty()) return html + "</section>\n";
  std::vector<std::string> tiles;
  for (const StaleTile& tile : ageing->refresh) {
    const std::string until = tile.half_found_until.empty() ? "now" : month_of(tile.half_found_until);
    tiles.push_back("tile " + std::to_string(tile.tile_id) + " at " + format_fixed(tile.center.lat_deg, 5) + "°, " +
                    format_fixed(tile.center.lon_deg, 5) + "° (" + until + ")");
  }
  return html + "  <p>Under the route, the first to be found less often than every second time, and when: " +
         html_escape(join(tiles, ", ")) +
         ". Look there first when you order new imagery. P counts the age of the oldest raster over all ground: it "
         "rises when that one is replaced.</p>\n</section>\n";
}

Json ageing_json(const MapAgeing& ageing) {
  const auto number = [](double value) { return variant_to_json(number_value(value)); };
  const auto degrees = [](double value) { return variant_to_json(degrees_value(value)); };
  const auto day_json = [](const std::string& day) { return day.empty() ? Json() : Json(day); };
  Json json = {{"sentence", ageing.sentence},
               {"enough_until", day_json(ageing.enough_until)},
               {"surely_until", day_json(ageing.surely_until)},
               {"flights", Json::array()},
               {"refresh", Json::array()}};
  for (const LaterFlight& flight : ageing.flights) {
    const ChancesAtAge& at = flight.chances;
    json["flights"].push_back({{"day", flight.day},
                               {"age_months", number(at.age_months)},
                               {"p_within_limit", number(at.p_within_limit)},
                               {"interval", {{"low", number(at.interval.low)}, {"high", number(at.interval.high)}}},
                               {"status", status_name(flight.status)},
                               {"tiles_half_found", flight.tiles_half_found}});
  }
  for (const StaleTile& tile : ageing.refresh) {
    json["refresh"].push_back({{"tile_id", tile.tile_id},
                               {"center_lon_deg", degrees(tile.center.lon_deg)},
                               {"center_lat_deg", degrees(tile.center.lat_deg)},
                               {"half_found_until", day_json(tile.half_found_until)}});
  }
  return json;
}

}  // namespace pilotage
