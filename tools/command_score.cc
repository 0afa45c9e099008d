#include <algorithm>
#include <cmath>
#include <optional>

#include "commands.h"
#include "version.h"

#include "pilotage/base/error.h"
#include "pilotage/base/output_file.h"
#include "pilotage/base/text.h"
#include "pilotage/camera/camera_options.h"
#include "pilotage/evaluate/evaluation_files.h"
#include "pilotage/mission/plan_file.h"
#include "pilotage/mission/plan_imagery.h"
#include "pilotage/mission/score_raster.h"
#include "pilotage/raster/gdal_io.h"
#include "pilotage/score/score_imagery.h"
#include "pilotage/score/score_plan.h"

namespace pilotage {
namespace {

struct ScoreCommandOptions {
  ScoreImageryOptions imagery;
  std::string table;
  int level = 0;
  EvaluateOptions evaluate;
  CameraOptions camera;

  template <class Self, class Fields>
  static void describe(Self& self, Fields& fields) {
    ScoreImageryOptions::describe(self.imagery, fields);
    fields.path("table", self.table, "Also write the scores as a table (CSV), one line per tile.");
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
};

bool is_plan(const std::vector<std::string>& inputs) {
  return inputs.size() == 1 && inputs.front().ends_with(".json");
}

Scored score_plan_file(const ScoreCommandOptions& options, const Invocation& invocation) {
  const TilePlan plan = read_plan(invocation.inputs.front());
  if (options.level >= static_cast<int>(plan.levels.size())) {
    throw UsageError("level = " + std::to_string(options.level) + ": the plan has " +
                     std::to_string(plan.levels.size()) + " level(s)");
  }
  const PlanLevel& level = plan.levels[static_cast<std::size_t>(options.level)];
  const auto scores = score_plan(plan, options.imagery.score, invocation.seed, invocation.threads, invocation.progress);
  const Crs crs = Crs::from_user_input(plan.crs_wkt);
  Scored scored{crs, level.matrix, tile_rows(plan, scores), {}, {}, plan.camera};
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
  return {std::move(scored.crs),      scored.matrix,     std::move(scored.rows),
          std::move(scored.warnings), std::move(ground), {}};
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
  const Evaluation evaluation = evaluate(scored.ground, frames.frames, options.evaluate, scratch, invocation.seed,
                                         invocation.threads, invocation.progress);
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
  for (const ScoreColumn& column : score_columns()) {
    std::vector<double> values;
    for (const TileRow& row : rows) {
      if (const double value = column.get(row.score); !std::isnan(value)) values.push_back(value);
    }
    if (values.empty()) continue;
    std::sort(values.begin(), values.end());
    const double median = values[values.size() / 2];
    result.text += column.name + ": " + for_people(values.front()) + " … " + for_people(median) + " … " +
                   for_people(values.back()) + (column.unit.empty() ? "" : " " + column.unit) + "\n";
    result.json["measures"][column.name] = {
        {"minimum", values.front()}, {"median", median}, {"maximum", values.back()}, {"tiles", values.size()}};
  }
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
    const Scored scored =
        is_plan(invocation.inputs) ? score_plan_file(options, invocation) : score_rasters(options, invocation);
    CommandResult result = tell(scored, invocation);
    if (evaluation) add_evaluation(options, invocation, scored, frames, *evaluation, result);
    const ScoreRaster raster = score_raster(scored.matrix, scored.rows);
    if (table) table->write(tile_table_to_csv(scored.rows));
    write_score_raster(invocation.output, raster.bands, scored.crs, raster.map_from_pixel, invocation.overwrite);
    if (table) table->commit();  // all appear, or none
    if (evaluation) evaluation->commit();
    return result;
  });
  return command;
}

}  // namespace pilotage
