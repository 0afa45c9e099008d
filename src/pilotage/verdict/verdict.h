#pragma once

#include <string>
#include <vector>

#include "pilotage/mission/mission.h"
#include "pilotage/verdict/quality.h"

namespace pilotage {

/// The worst status of the rows that decide; kBad when none does.
QualityStatus verdict_of(const std::vector<QualityRow>& rows);

/// How many flights of a hundred stay within the limit, and on what that rests: "95 of 100 flights stay within 60 m all
/// the way, if what is assumed holds (P = 0.957 ≥ 0.900)". The number is P rounded down, so that it is never said
/// larger than it is. Without probabilities it is the predicted error, and that how often fixes come is not known.
/// Where stronger evidence contradicts the model (verdict/evidence.h), that stands before it.
std::string headline(const std::vector<QualityRow>& rows, const Selection& selection);

/// What the headline does not say: "matchable on 87 % of its length; longest gap 3.4 km = 122 s at 28 m/s; drift there
/// 31 m ≤ 50 m", where flights are lost, and the rows that make the verdict what it is.
std::string verdict_detail(QualityStatus verdict, const std::vector<QualityRow>& rows, const Selection& selection);

/// The verdict in one line: its name, the headline where there are probabilities, and the detail.
std::string verdict_sentence(QualityStatus verdict, const std::vector<QualityRow>& rows, const Selection& selection);

/// Where the verdict takes GNSS to be lost: "GNSS lost at the first point"; "GNSS denied from 3.2 km to 7.5 km, trusted
/// at once where it comes back, fixes taken where it is had, too"; "GNSS lost for good at the worst point, 3.2 km (leg
/// 2)".
std::string gnss_text(const Flight& flight, const Selection& selection);

/// Whether the planner named no limit and the selection has none of its own.
bool limit_is_default(const Flight& flight, const Selection& selection);

/// What the line of assumptions has behind the limit: ", flat ground at home's height (default)", the imagery's age,
/// what P rests on; "" where there is nothing.
std::string further_assumptions(const Mission& mission, const Selection& selection);

/// What the verdict takes for granted: "assumes: tactical INS (default), GNSS lost at the first point, limit 50 m
/// (default)". "(default)" stands after what the planner did not give.
std::string assumptions_line(const Mission& mission, const Selection& selection);

}  // namespace pilotage
