#pragma once

#include <optional>
#include <string>

#include "pilotage/base/utc_time.h"
#include "pilotage/ground/tile_scores.h"
#include "pilotage/mission/mission.h"
#include "pilotage/mission/selection.h"
#include "pilotage/verdict/quality.h"

// Until when a map can be flown by, as far as a rule of thumb for the age of imagery says (Selection::ageing).

namespace pilotage {

/// What stands behind every such figure.
inline constexpr const char* kAgeRule =
    "by a rule of thumb for the age of imagery alone: season and what is built or felled are not counted";

/// The day on which the oldest raster is so old, "2027-03-14".
std::string day_at_age(UtcTime oldest, double age_months);

/// "2027-03" of "2027-03-14"
std::string month_of(const std::string& day);

/// The date of the oldest raster of a ground whose P counts its age. Throws DataError where not all are known.
UtcTime dated_imagery(const Ground& ground);

/// The day up to which a tile is found at least every second time, "2027-03-14" (that of imagery kMostAge_months old:
/// as far as anything is known); "" where it is not on the planned flight, where its P counts no age, and where
/// `oldest` is nothing. `oldest` is oldest_imagery() of its ground.
std::string half_found_until(std::optional<UtcTime> oldest, const TileScores& score);

/// "P is at least what was asked for (0.900) until about 2027-03, when the imagery is 21 months old; the lower end of
/// its interval until about 2026-11": by a rule of thumb, as it says. "" where the selection says nothing of it.
std::string ageing_sentence(const Mission& mission, const Selection& selection);

/// A row of the quality table, which does not decide; nothing where the selection says nothing of it.
std::optional<QualityRow> ageing_row(const Mission& mission, const Selection& selection);

}  // namespace pilotage
