#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

#include "pilotage/capture/capture.h"

namespace pilotage {

/// What the page is made of beside the numbers.
struct QualityPageInput {
  std::string title;      ///< The map's name.
  std::string map;        ///< Where the map stands now, and
  std::string map_sigma;  ///< what stands beside it.
};

/// How good a captured map is, as one HTML file that needs no other: rows judged by CaptureThresholds, where its frames
/// are and by how much their positions miss, how many frames see the ground, the map's own error, the shifts against
/// another map, check points and frames as tables. Throws DataError when a raster cannot be read.
std::string quality_page_html(const CaptureResult& done, const QualityPageInput& input,
                              const nlohmann::ordered_json& parameters, const std::string& software_version);

}  // namespace pilotage
