#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "pilotage/mission/selection.h"

namespace pilotage {

struct Report;
struct ReportLeg;

/// The plan's own numbers of a leg's ends: "2 → 3"; "–" where the file has none, as for home.
std::string leg_items_text(const ReportLeg& leg);

/// What the report knows of one leg (`number` from 1), a sentence a line: how it is judged and by which numbers, how
/// much of it lies over chosen tiles, its gaps, why, and what to change. `advice` is the selection's. Errors and
/// probabilities are those of the plan's model, as everywhere in the report. Throws UsageError where there is no such
/// leg.
std::vector<std::string> explain_leg(const Report& report, const std::vector<LegAdvice>& advice, std::int64_t number);

/// The same of one tile: where it lies, whether it is stored and why not, what speaks against it and what to change,
/// then each measure that it has. Throws UsageError where there is no such tile.
std::vector<std::string> explain_tile(const Report& report, std::int64_t tile_id);

/// What the verdict rests on, strongest first (verdict/evidence.h), and each row that decides and is not good, with
/// what to do.
std::vector<std::string> explain_verdict(const Report& report);

/// explain_verdict, explain_leg or explain_tile of "verdict", "leg 3" or "tile 1204". Throws UsageError for anything
/// else.
std::vector<std::string> explain(const Report& report, const std::vector<LegAdvice>& advice, const std::string& what);

}  // namespace pilotage
