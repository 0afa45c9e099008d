#include <algorithm>
#include <cmath>
#include <optional>

#include "commands.h"
#include "stage_files.h"
#include "version.h"

#include "pilotage/base/error.h"
#include "pilotage/base/json_object.h"
#include "pilotage/base/output_file.h"
#include "pilotage/base/text.h"
#include "pilotage/camera/camera_options.h"
#include "pilotage/evaluate/evaluation_files.h"
#include "pilotage/evaluate/registered_place.h"
#include "pilotage/mission/plan_file.h"
#include "pilotage/mission/plan_imagery.h"
#include "pilotage/mission/score_raster.h"
#include "pilotage/raster/gdal_io.h"
#include "pilotage/registration/disagreement_raster.h"
#include "pilotage/score/score_imagery.h"
#include "pilotage/score/score_plan.h"

namespace pilotage {
namespace {

struct ScoreCommandOptions {
  ScoreImageryOptions imagery;
  std::string table;
  std::string second_epoch_output;
  int level = 0;
  EvaluateOptions evaluate;
  CameraOptions camera;

  template <class Self, class Fields>
  static void describe(Self& self, Fields& fields) {
    ScoreImageryOptions::describe(self.imagery, fields);
    fields.path("table", self.table, "Also write the scores as a table (CSV), one line per tile.");
    fields.path("second_epoch_output", self.second_epoch_output,
                "Also write the disagreement of both dates' georeferences as a raster (GeoTIFF).");
    fields.field("level", self.level, "Level of a plan that the raster shows; the table has all.", Range{0, 30});
    fields.group("evaluate", self.evaluate, "What the scores are worth, held against another date or real frames.");
    fields.group("camera", self.camera, "The camera of --evaluate-frames; without it the plan's.");
  }
};

struct Scored {
  Crs crs;
  TileMatrix matrix;
  std::vector<TileRow> rows;
  std::vector<std::string> warnings;
  ScoredGround ground;            ///< What an evaluation needs; empty when none is wanted.
  std::optional<Camera> of_plan;  ///< The plan's camera.
  std::optional<SecondEpoch> second_epoch;
};

bool is_plan(const std::vector<std::string>& inputs) {
  return inputs.size() == 1 && inputs.front().ends_with(".json");
}

Scored score_plan_file(const ScoreCommandOptions& options, const Invocation& invocation) {
  const TilePlan plan = read_stage_plan(invocation.inputs.front());
  if (options.level >= static_cast<int>(plan.levels.size())) {
    throw UsageError("level = " + std::to_string(options.level) + ": the plan has " +
                     std::to_string(plan.levels.size()) + " level(s)");
  }
  const PlanLevel& level = plan.levels[static_cast<std::size_t>(options.level)];
  const ScoreOptions& score = options.imagery.score;
  ScoredPlan of_plan = score_plan(plan, score, invocation.seed, invocation.threads, invocation.progress);
  const Crs crs = Crs::from_user_input(plan.crs_wkt);
  Scored scored{crs, level.matrix, tile_rows(plan, of_plan.scores), {},
                {},  plan.camera,  std::move(of_plan.second_epoch)};
  if (!options.evaluate.wanted()) return scored;
  scored.ground = {crs,           level.matrix, level.search_radius_px, {}, dataset_names(plan), plan.imagery_options,
                   plan.elevation};
  std::copy_if(scored.rows.begin(), scored.rows.end(), std::back_inserter(scored.ground.rows),
               [&](const TileRow& row) { return row.tile.level == level.matrix.level; });
  return scored;
}

Scored score_rasters(const ScoreCommandOptions& options, const Invocation& invocation) {
  ScoredImagery scored =
      score_imagery(invocation.inputs, options.imagery, invocation.seed, invocation.threads, invocation.progress);
  ScoredGround ground;
  if (options.evaluate.wanted()) {
    ground = {scored.crs,  scored.matrix,     options.imagery.grid.search_radius_px,
              scored.rows, invocation.inputs, options.imagery.imagery,
              ""};
  }
  return {std::move(scored.crs),         scored.matrix,     std::move(scored.rows),
          std::move(scored.warnings),    std::move(ground), {},
          std::move(scored.second_epoch)};
}

std::filesystem::path folder_of_outputs(const ScoreCommandOptions& options, const Invocation& invocation) {
  const std::filesystem::path beside = options.table.empty() ? invocation.output : options.table;
  return beside.has_parent_path() ? beside.parent_path() : ".";
}

FrameTable read_frame_table(const EvaluateOptions& options) {
  if (options.frames.empty()) return {};
  return frame_table_from_csv(options.frames, read_file(options.frames), {options.frames_truth, FrameColumns::kAll});
}

FlightFrames complete(const FrameTable& table, const ScoreCommandOptions& options,
                      const std::optional<Camera>& of_plan) {
  FrameSources sources;
  sources.of_map = of_plan;
  if (names_camera(options.camera) || !of_plan) sources.given = make_camera(options.camera);
  return complete_frames(options.evaluate.frames, table, sources);
}

// Shows how well each predictor does, and writes the evaluation's files without letting them appear.
void add_evaluation(const ScoreCommandOptions& options, const Invocation& invocation, const Scored& scored,
                    const FrameTable& table, EvaluationFiles& files, CommandResult& result) {
  FlightFrames frames;
  if (!table.frames.empty()) frames = complete(table, options, scored.of_plan);
  const std::filesystem::path scratch = folder_of_outputs(options, invocation) / "evaluation_map.gpkg";
  // The date that is judged by may be the second one as well: its registration then corrects the truth.
  const std::vector<std::string>& second_epoch = options.imagery.score.second_epoch;
  const bool registered = second_epoch.size() == 1 && second_epoch.front() == options.evaluate.file;
  const Evaluation evaluation = evaluate(
      scored.ground, frames.frames, options.evaluate, scratch, invocation.seed, invocation.threads, invocation.progress,
      registered ? registered_place(scored.second_epoch->registration.fit.field) : PlaceOnReference(same_place));
  const EvaluationSource source{invocation.inputs, version_line(), options.evaluate, invocation.seed};
  files.write(scored.ground, evaluation, source);
  result.json["evaluation"] = evaluation_json(evaluation, source);
  result.text += evaluation_text(evaluation);
  result.warnings.insert(result.warnings.end(), frames.warnings.begin(), frames.warnings.end());
  result.warnings.insert(result.warnings.end(), evaluation.warnings.begin(), evaluation.warnings.end());
}

// Entropies differ in the sixth digit.
std::string for_people(double number) {
  return std::abs(number) < 1e-3 ? format_number(number) : format_fixed(number, 6);
}

// One line per measure: how far it ranges.
void summarise(const std::vector<TileRow>& rows, CommandResult& result) {
  const std::vector<ScoreColumn>& columns = score_columns();
  std::vector<std::vector<double>> numbers(columns.size());
  for (const TileRow& row : rows) {
    for (std::size_t i = 0; i < columns.size(); ++i) {
      if (const double value = columns[i].get(row.score); !std::isnan(value)) numbers[i].push_back(value);
    }
  }
  for (std::size_t i = 0; i < columns.size(); ++i) {
    std::vector<double>& values = numbers[i];
    if (values.empty()) continue;
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    const double median = *middle;
    const auto [low, high] = std::minmax_element(values.begin(), values.end());
    result.text += columns[i].name + ": " + for_people(*low) + " … " + for_people(median) + " … " + for_people(*high) +
                   (columns[i].unit.empty() ? "" : " " + columns[i].unit) + "\n";
    result.json["measures"][columns[i].name] = {
        {"minimum", *low}, {"median", median}, {"maximum", *high}, {"tiles", values.size()}};
  }
}

// Refuses what can be refused before the work is done.
std::optional<OutputFile> check_second_epoch(const ScoreCommandOptions& options, const Invocation& invocation) {
  for (const std::string& dataset : options.imagery.score.second_epoch) inspect_imagery(dataset);
  if (options.second_epoch_output.empty()) return std::nullopt;
  if (options.imagery.score.second_epoch.empty()) throw UsageError("--second-epoch-output needs --second-epoch");
  return std::optional<OutputFile>(std::in_place, options.second_epoch_output, invocation.overwrite);
}

void write_disagreement(const ScoreCommandOptions& options, const Invocation& invocation, const Scored& scored) {
  const SecondEpoch& epoch = *scored.second_epoch;
  const DisagreementRaster raster = disagreement_raster(epoch.registration.fit.field, epoch.area_m);
  write_score_raster(options.second_epoch_output, raster.bands, scored.crs, raster.map_from_pixel,
                     invocation.overwrite);
}

std::string metres(const Spread& spread) {
  if (std::isnan(spread.median)) return "not known";
  return format_fixed(spread.median, 2) + " m median, " + format_fixed(spread.quantile_95, 2) + " m 95 %, " +
         format_fixed(spread.largest, 2) + " m largest";
}

nlohmann::ordered_json json_of(const Spread& spread) {
  return {{"median", json_number(spread.median)},
          {"quantile_95", json_number(spread.quantile_95)},
          {"largest", json_number(spread.largest)}};
}

void summarise(const SecondEpoch& epoch, CommandResult& result) {
  const Registration& registration = epoch.registration;
  const WarpFit& fit = registration.fit;
  const auto unknown = std::count_if(epoch.scores.begin(), epoch.scores.end(),
                                     [](const EpochScores& score) { return std::isnan(score.disagreement_m); });
  result.text += "second epoch: " + std::to_string(registration.finest_ties) + " ties at " +
                 std::to_string(registration.places) + " places and " +
                 std::to_string(static_cast<std::int64_t>(registration.ties.size()) - registration.finest_ties) +
                 " coarser ones, " + std::to_string(fit.outliers) + " outliers\n";
  result.text += "  disagreement: " + metres(fit.disagreement_m) + "\n  residual: " + metres(fit.residual_m) +
                 "\n  residual of ties left out: " + metres(fit.left_out_m) + "\n";
  result.json["second_epoch"] = {
      {"gsd_m", registration.gsd_m},
      {"places", registration.places},
      {"ties", registration.finest_ties},
      {"coarser_ties", static_cast<std::int64_t>(registration.ties.size()) - registration.finest_ties},
      {"outliers", fit.outliers},
      {"disagreement_m", json_of(fit.disagreement_m)},
      {"residual_m", json_of(fit.residual_m)},
      {"left_out_m", json_of(fit.left_out_m)},
      {"tiles_unknown", unknown}};
  if (unknown == 0) return;
  result.warnings.push_back("the second date could not be brought onto the reference at " + std::to_string(unknown) +
                            " of " + std::to_string(epoch.scores.size()) + " tiles");
}

CommandResult tell(const Scored& scored, const Invocation& invocation) {
  const auto of_status = [&](TileStatus status) {
    return std::count_if(scored.rows.begin(), scored.rows.end(),
                         [&](const TileRow& row) { return row.score.status == status; });
  };
  CommandResult result;
  result.text = std::to_string(scored.rows.size()) + " tiles, " + std::to_string(of_status(TileStatus::kScored)) +
                " scored, " + std::to_string(of_status(TileStatus::kFlat)) + " flat, " +
                std::to_string(of_status(TileStatus::kTooLittleGround)) + " with too little ground\n";
  result.json = {{"output", invocation.output},
                 {"tiles", scored.rows.size()},
                 {"scored", of_status(TileStatus::kScored)},
                 {"flat", of_status(TileStatus::kFlat)},
                 {"too_little_ground", of_status(TileStatus::kTooLittleGround)}};
  summarise(scored.rows, result);
  result.warnings = scored.warnings;
  if (scored.second_epoch) summarise(*scored.second_epoch, result);
  return result;
}

}  // namespace

Command make_score_command() {
  Command command;
  command.word = "score";
  command.group = CommandGroup::kStages;
  command.summary = "Score tiles: variance, entropy, uniqueness";
  command.examples = {
      {"A raster on its own pixel grid.",
       "pilotage score ortho.tif --tile-size-px 256 --stride-px 64 --search-radius-px 128 -o scores.tif "
       "--table tiles.csv"},
      {"The tiles of a plan.", "pilotage score plan.json -o scores.tif --table tiles.csv"},
      {"Measured against a second date.",
       "pilotage score plan.json --second-epoch last_year.tif --second-epoch-output disagreement.tif -o scores.tif"},
      {"What the scores are worth: the matcher on another date.",
       "pilotage score ortho.tif --gsd-m 0.6 --tile-size-px 128 --evaluate later.tif -o scores.tif"}};
  command.inputs = {
      .name = "RASTER", .help = "GDAL datasets, or one tile plan (plan.json).", .min = 1, .max = InputSpec::kMany};
  command.output = {.kind = OutputKind::kFile, .help = "Score raster (Cloud-Optimised GeoTIFF), one band per measure."};
  bind_options<ScoreCommandOptions>(command, [](const ScoreCommandOptions& options, const Invocation& invocation) {
    std::optional<OutputFile> table;  // what exists is refused before the work is done
    if (!options.table.empty()) table.emplace(options.table, invocation.overwrite);
    std::optional<EvaluationFiles> evaluation;
    if (options.evaluate.wanted()) {
      check_evaluation(options.evaluate);
      evaluation.emplace(folder_of_outputs(options, invocation), invocation.overwrite);
    }
    const FrameTable frames = read_frame_table(options.evaluate);
    const std::optional<OutputFile> refused = check_second_epoch(options, invocation);
    const Scored scored =
        is_plan(invocation.inputs) ? score_plan_file(options, invocation) : score_rasters(options, invocation);
    CommandResult result = tell(scored, invocation);
    if (evaluation) add_evaluation(options, invocation, scored, frames, *evaluation, result);
    report_progress(invocation.progress, "writing scores", 0, 0);
    const ScoreRaster raster = score_raster(scored.matrix, scored.rows);
    if (table) table->write(tile_table_to_csv(scored.rows));
    write_score_raster(invocation.output, raster.bands, scored.crs, raster.map_from_pixel, invocation.overwrite);
    if (!options.second_epoch_output.empty()) write_disagreement(options, invocation, scored);
    if (table) table->commit();  // all appear, or none
    if (evaluation) evaluation->commit();
    return result;
  });
  return command;
}

}  // namespace pilotage
