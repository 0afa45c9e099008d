#include "pilotage/survey/run_survey.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string_view>
#include <system_error>
#include <utility>

#include <nlohmann/json.hpp>

#include "pilotage/base/error.h"
#include "pilotage/base/json_object.h"
#include "pilotage/base/options_json.h"
#include "pilotage/base/output_file.h"
#include "pilotage/base/staging_folder.h"
#include "pilotage/base/wording.h"
#include "pilotage/gis/score_files.h"
#include "pilotage/ground/ground_imagery.h"
#include "pilotage/ground/ground_of_rasters.h"
#include "pilotage/ground/score_raster.h"
#include "pilotage/ground/tile_table.h"
#include "pilotage/mission/planned_landmarks.h"
#include "pilotage/raster/gdal_io.h"
#include "pilotage/registration/disagreement_raster.h"
#include "pilotage/report/plan_report.h"
#include "pilotage/score/predict_correct_fixes.h"
#include "pilotage/score/score_ground.h"
#include "pilotage/survey/survey.h"
#include "pilotage/survey/survey_layers.h"

namespace pilotage {
namespace {

namespace fs = std::filesystem;

constexpr std::array<std::string_view, 12> kSurveyFiles = {"survey_tiles.csv",
                                                           "survey_scores.tif",
                                                           "survey_scores.qml",
                                                           "survey_disagreement.tif",
                                                           "survey_classes.tif",
                                                           "survey_classes.qml",
                                                           "survey_classes.tif.aux.xml",
                                                           "survey_squares.csv",
                                                           "survey.gpkg",
                                                           "survey.kmz",
                                                           "survey.json",
                                                           "survey.html"};
constexpr int kSurveyOverviewSide_px = 1600;

void refuse_existing_survey(const fs::path& folder, bool overwrite) {
  if (overwrite) return;
  for (const std::string& name : earlier_survey_outputs(folder)) {
    throw DataError((folder / name).string() + ": exists already; give --overwrite to replace it");
  }
}

// Tiles of the rectangle around the imagery of which it shows too little are no part of the area: nobody knows their
// ground. Returns how many of them show some.
std::int64_t drop_tiles_without_ground(Ground& ground, std::vector<TileScores>& scores) {
  std::size_t kept = 0;
  std::int64_t partly = 0;
  for (std::size_t i = 0; i < scores.size(); ++i) {
    if (scores[i].status == TileStatus::kTooLittleGround) {
      partly += scores[i].valid_fraction > 0 ? 1 : 0;
      continue;
    }
    if (kept != i) {
      ground.tiles[kept] = ground.tiles[i];
      scores[kept] = std::move(scores[i]);
    }
    ++kept;
  }
  ground.tiles.resize(kept);
  scores.resize(kept);
  if (kept == 0) throw DataError("the imagery has too little ground: no tile of it can be judged");
  return partly;
}

void warn_of_missing_heights(const Ground& ground, const std::vector<TileScores>& scores,
                             std::vector<std::string>& warnings) {
  if (ground.elevation.empty()) return;
  const auto unknown =
      std::count_if(scores.begin(), scores.end(), [](const TileScores& tile) { return std::isnan(tile.relief_m); });
  if (unknown == 0) return;
  warnings.push_back(ground.elevation + ": gives no heights for " + std::to_string(unknown) + " of " +
                     std::to_string(scores.size()) + " tiles; steep ground is not told there");
}

std::vector<ImageryDataset> inspect_second_dates(const SurveyOptions& options, std::vector<std::string>& warnings,
                                                 const Progress& progress) {
  std::vector<ImageryDataset> dates;
  for (const std::string& dataset : options.score.second_epoch) {
    const ImageryInfo info = inspect_imagery(dataset, second_date_options(options.imagery_options), progress);
    dates.push_back({dataset, std::max(info.gsd_x_m, info.gsd_y_m), info.crs.name(), info.acquired, info.width_px,
                     info.height_px, "", info.licence});
    warnings.insert(warnings.end(), info.warnings.begin(), info.warnings.end());
  }
  return dates;
}

std::vector<InputFile> survey_inputs(const SurveyInput& input, const SurveyOptions& options) {
  std::vector<InputFile> files;
  for (const ImageryDataset& imagery : input.area.ground.imagery.datasets) {
    files.push_back(input_dataset("imagery", imagery.dataset, imagery.acquired, imagery.licence));
  }
  for (const ImageryDataset& imagery : input.second_dates) {
    files.push_back(input_dataset("second_epoch", imagery.dataset, imagery.acquired, imagery.licence));
  }
  if (!options.elevation.empty()) files.push_back(input_dataset("elevation", options.elevation, ""));
  if (!options.camera.file.empty()) files.push_back(input_file("camera", options.camera.file, ""));
  if (!options.score.model.empty()) files.push_back(input_file("model", options.score.model, ""));
  if (!options.landmarks.empty()) files.push_back(input_file("landmarks", options.landmarks, ""));
  return files;
}

}  // namespace

std::vector<std::string> earlier_survey_outputs(const fs::path& folder) {
  std::vector<std::string> names;
  std::error_code ignored;
  for (const std::string_view name : kSurveyFiles) {
    if (fs::exists(folder / name, ignored)) names.emplace_back(name);
  }
  std::sort(names.begin(), names.end());
  return names;
}

SurveyResult run_survey(const std::vector<std::string>& imagery, const SurveyOptions& options, const SurveyRun& run,
                        const Progress& progress) {
  refuse_existing_survey(run.output_folder, run.overwrite);
  constexpr int kParts = 3;
  const Progress planning = part_of(progress, 1, kParts);
  const Progress scoring = part_of(progress, 2, kParts);
  const Progress reporting = part_of(progress, 3, kParts);
  SurveyInput input;
  input.area = plan_survey(imagery, options, planning);
  input.second_dates = inspect_second_dates(options, input.area.warnings, planning);  // fails now, not after hours
  Ground& ground = input.area.ground;
  cut_all_tiles(ground, run.threads);
  if (!options.landmarks.empty()) input.landmarks = read_planned_landmarks(ground, options.landmarks);  // fails now

  const StagingFolder staging(run.output_folder);
  SurveyResult result;
  const auto publish_later = [&](const std::string& name) {
    result.files.push_back(name);
    return staging / name;
  };
  SurveyOptions measured = options;
  std::optional<GroundImagery> opened(open_imagery(ground));
  measured.score = with_usual_fine_contrast(ground, *opened, options.score, run.threads, scoring);
  GroundScores scored = score_ground(ground, measured.score, run.seed, run.threads, scoring, &*opened);
  opened.reset();  // the page shows it at other scales
  if (scored.second_epoch) {
    const SecondEpoch& epoch = *scored.second_epoch;
    const DisagreementRaster layer = disagreement_raster(epoch.registration.fit.field, epoch.area_m);
    write_score_raster(publish_later("survey_disagreement.tif"), layer.bands, ground.crs, layer.map_from_pixel, true,
                       scoring);
    input.second_date_assumption = second_date_assumption(epoch, options.score.registration);
  }
  input.scores = std::move(scored.scores);
  if (const std::int64_t partly = drop_tiles_without_ground(ground, input.scores); partly > 0) {
    input.area.notes.push_back(count_text(partly, "tile", "tiles") + " with ground in less than " +
                               percent_text(options.score.min_valid_fraction) +
                               " of each, at edges or holes of the imagery, are not judged and no part of the area");
  }
  if (input.landmarks) input.landmarks = landmarks_on_tiles(ground, *input.landmarks, options.landmarks);
  warn_of_missing_heights(ground, input.scores, input.area.warnings);

  report_progress(scoring, "writing scores", 0, 0);
  const ScoreTable table(ground, input.scores);
  write_file(publish_later("survey_tiles.csv"), tile_table_to_csv(ground, input.scores), true);
  const ScoreRaster raster = score_raster(table, 0);
  const fs::path scores_path = publish_later("survey_scores.tif");
  write_score_raster(scores_path, raster.bands, ground.crs, raster.map_from_pixel, true, scoring);
  if (const auto shown = shown_measure(raster, input.scores)) {
    result.files.push_back(write_heat_style(scores_path, *shown, true));
  }
  write_classes(publish_later("survey_classes.tif"), class_values(table, 0), ground.crs, raster.map_from_pixel, true);
  for (const char* name : {"survey_classes.qml", "survey_classes.tif.aux.xml"}) result.files.emplace_back(name);

  input.title = options.title;
  input.matcher = options.score.matcher;
  input.model = options.score.model;
  input.imagery = read_overview(ground, kSurveyOverviewSide_px);
  input.pictures = read_tile_pictures(ground, run.threads, reporting);
  input.geodetic_from_map = geodetic_from_map_of(ground.crs);
  SurveyOptions described = options;
  input.parameters = options_to_json(list_options(described));
  input.inputs = survey_inputs(input, options);
  input.sketched = sketched_flight(input.area, input.scores, imagery, measured);
  input.software_version = run.software_version;
  report_progress(reporting, "writing the report", 0, 0);
  const Survey survey = make_survey(input);
  write_file(publish_later("survey_squares.csv"), squares_csv(survey), true);
  write_survey_geopackage(publish_later("survey.gpkg"), survey, table);
  write_survey_kmz(publish_later("survey.kmz"), survey, table);
  write_file(publish_later("survey.json"), json_text(survey_json(survey)), true);
  write_file(publish_later("survey.html"), survey_html(survey), true);
  staging.publish(result.files, earlier_survey_outputs(run.output_folder));

  const GridLevel& level = ground.levels.front();
  const AreaStatistics& all = survey.statistics;
  result.headline = survey.headline;
  result.detail = survey.detail;
  result.assumptions = survey.assumptions;
  result.not_looked_at = survey.not_looked_at;
  if (survey.landmarks) {
    result.landmarks = survey.landmarks->said;
    result.landmarks_assume = survey.landmarks->assumes;
  }
  result.tiles = all.tiles.all();
  result.tile_m = level.matrix.tile_size_px * level.gsd_m;
  result.stride_m = level.matrix.stride_px * level.gsd_m;
  result.squares = std::ssize(survey.squares);
  result.area_km2 = all.area_km2;
  result.go_share = all.share(all.tiles.go);
  result.marginal_share = all.share(all.tiles.marginal);
  result.no_go_share = all.share(all.tiles.no_go);
  result.warnings = survey.warnings;
  return result;
}

}  // namespace pilotage
