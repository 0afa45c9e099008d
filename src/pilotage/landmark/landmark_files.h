#pragma once

#include <filesystem>
#include <string>

#include "pilotage/landmark/score_landmarks.h"

namespace pilotage {

/// Landmarks and false alarms as points of WGS 84 (schemas/results/landmark-score.json says what their columns are).
/// GeoJSON or GeoPackage by the name's extension; throws as check_scored_landmarks_name() and write_geojson().
void write_scored_landmarks(const std::filesystem::path& path, const LandmarkScores& scores, bool overwrite);

/// Throws UsageError for a name that ends neither in .geojson nor in .gpkg.
void check_scored_landmarks_name(const std::filesystem::path& path);

/// "82.5 % (33 of 40; 95 % interval 67.2 to 92.7 %)"; "of none" of none.
std::string measured_share_text(const Share& share);

}  // namespace pilotage
