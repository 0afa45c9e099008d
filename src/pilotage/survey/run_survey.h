#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "pilotage/base/progress.h"
#include "pilotage/survey/survey_options.h"

#pragma GCC visibility push(default)

namespace pilotage {

/// Where the outputs go, and how the work is done.
struct SurveyRun {
  std::filesystem::path output_folder;
  bool overwrite = false;
  std::uint64_t seed = 1;
  int threads = 0;
  std::string software_version;
};

struct SurveyResult {
  std::string headline;  ///< As on the page, and the next three.
  std::string detail;
  std::vector<std::string> assumptions;
  std::string not_looked_at;
  std::string landmarks;  ///< What landmarks promise, "" without; modelled and not counted.
  std::string landmarks_assume;
  std::int64_t tiles = 0;
  double tile_m = 0;    ///< Side of a tile.
  double stride_m = 0;  ///< From one to the next.
  std::int64_t squares = 0;
  double area_km2 = 0;
  double go_share = 0;  ///< 0 … 1; so the next two.
  double marginal_share = 0;
  double no_go_share = 0;
  std::vector<std::string> files;  ///< Written, in the output folder.
  std::vector<std::string> warnings;
};

/// Names of the outputs of an earlier survey in a folder, sorted: what run_survey() replaces there.
std::vector<std::string> earlier_survey_outputs(const std::filesystem::path& folder);

/// Where could a camera find its place? The whole area of `imagery` is cut into tiles of the camera's footprint
/// (survey/plan_survey.h) and scored (score_ground); tiles without any imagery are left out. Writes the page, the same
/// numbers as JSON, table, rasters and layers, all named "survey…", into the output folder, which is made when it does
/// not exist. All of them appear at the end, in place of those of an earlier survey, or none. The same bytes for any
/// number of threads. Throws as the stages; DataError when an output exists and overwrite is not set.
SurveyResult run_survey(const std::vector<std::string>& imagery, const SurveyOptions& options, const SurveyRun& run,
                        const Progress& progress = {});

}  // namespace pilotage

#pragma GCC visibility pop
