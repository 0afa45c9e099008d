#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "pilotage/geo/geodetic_point.h"
#include "pilotage/mission/mission.h"
#include "pilotage/mission/selection.h"
#include "pilotage/verdict/quality.h"

#pragma GCC visibility push(default)

// What becomes of P as the map ages (verdict/map_holds.h), and where new imagery is wanted first.

namespace pilotage {

struct ReportTile;

/// The flight, some months later.
struct LaterFlight {
  std::string day;  ///< "2027-03-14"; of later flights about.
  ChancesAtAge chances;
  QualityStatus status = QualityStatus::kGood;  ///< judge_route().
  std::int64_t tiles_half_found = 0;            ///< Stored tiles under the route with a P of at least one half then.
};

/// A stored tile under the route that is found less often than every second time on the planned flight, or soon after.
struct StaleTile {
  std::int64_t tile_id = 0;
  GeodeticPoint center;
  std::string half_found_until;  ///< A day; "" where it is already so.
};

struct MapAgeing {
  std::string sentence;              ///< ageing_sentence().
  std::vector<LaterFlight> flights;  ///< Ascending; the first is the planned one.
  std::string enough_until;          ///< The day up to which P is what was asked for; "" when it never was.
  std::string surely_until;          ///< The same of the lower end of its interval.
  std::vector<StaleTile> refresh;    ///< The weakest of those below one half, then those that fall there first.
};

inline constexpr std::size_t kMostStaleTiles = 5;  ///< In MapAgeing::refresh.

/// Nothing where the selection says nothing of it. `tiles` are the plan's.
std::optional<MapAgeing> map_ageing(const Mission& mission, const Selection& selection,
                                    const std::vector<ReportTile>& tiles);

/// The section of the page; "" without one.
std::string ageing_html(const std::optional<MapAgeing>& ageing);

/// As it stands in report.json.
nlohmann::ordered_json ageing_json(const MapAgeing& ageing);

}  // namespace pilotage

#pragma GCC visibility pop
