#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "pilotage/flightlog/frame_match.h"

namespace pilotage {

/// One column of fixes.csv.
struct FixColumn {
  std::string name;                                     ///< With the unit as suffix.
  std::function<std::string(const FrameMatch&)> write;  ///< The cell; "" where there is nothing to say.
};

/// The columns of fixes.csv in their order (schemas/fixes-csv.md). `timings`: milliseconds too, the only column whose
/// bytes differ from run to run.
std::vector<FixColumn> fix_columns(bool timings = true);

/// fixes.csv: a line of names, then a line for each frame; comma separated, "\n", cells quoted where they must be.
/// Numbers are the shortest text that reads back as the same double.
std::string fix_table_to_csv(std::span<const FrameMatch> matches, bool timings = true);

}  // namespace pilotage
