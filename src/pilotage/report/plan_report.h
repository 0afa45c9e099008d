#pragma once

#include <string>
#include <vector>

#include "pilotage/mission/selection.h"
#include "pilotage/mission/tile_plan.h"
#include "pilotage/mission/tile_scores.h"
#include "pilotage/report/report_input.h"

namespace pilotage {

/// Reads what a report shows beyond plan, scores, selection and `inputs` (input_files of the plan): a picture of the
/// corridor. Throws DataError when imagery cannot be read.
ReportInput make_report_input(const TilePlan& plan, const std::vector<TileScore>& scores, const Selection& selection,
                              const std::vector<InputFile>& inputs, const std::string& software_version);

}  // namespace pilotage
