#pragma once

#include <string>
#include <utility>
#include <vector>

#include "pilotage/report/report.h"

namespace pilotage {

/// Heat maps as KML: folders with ground overlays and a legend, and the pictures that they name.
struct DegreeOverlay {
  std::string kml;                                            ///< Folders, to stand in a document; "" without scores.
  std::vector<std::pair<std::string, std::string>> pictures;  ///< File name and PNG.
};

/// The first measure of the report that has values, level by level; only the first level is visible. A picture covers
/// at most 256 × 256 cells with 8 × 8 pixels each, so that edges of cells stay within an eighth of a cell however long
/// the route is. Throws DataError when a picture has no place in WGS 84.
DegreeOverlay heat_overlay(const ReportInput& input, const Report& report);

}  // namespace pilotage
