#pragma once

#include "pilotage/report/report.h"

namespace pilotage {

/// The pictures and shapes of the page's map for the tiles, legs and gaps of `report`, in their order.
ReportDisplay make_display(const ReportInput& input, const Report& report);

}  // namespace pilotage
