#pragma once

#include <filesystem>

#include "report/report_scene.h"

#include "pilotage/report/report.h"

namespace pilotage::testing {

/// A drawn mission on a grid that GIS programs know: an azimuthal projection around the origin, in which the scene's
/// places lie to a metre. Some tiles have a P of a correct fix, some are not known; one gap; probabilities of legs.
/// `two_levels` false leaves level 1 out.
ReportInput gis_scene(GeodeticPoint origin = {7.6, 51.96}, bool two_levels = true);

/// The same with imagery that is there, in `folder`: the scene names some that nobody took.
ReportInput with_imagery(ReportInput scene, const std::filesystem::path& folder);

}  // namespace pilotage::testing
