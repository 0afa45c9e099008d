#include "score_outputs.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "spread_output.h"
#include "version.h"
#include <nlohmann/json.hpp>

#include "pilotage/base/error.h"
#include "pilotage/base/json_object.h"
#include "pilotage/base/text.h"
#include "pilotage/evaluate/registered_place.h"
#include "pilotage/gis/qgis_style.h"
#include "pilotage/gis/score_files.h"
#include "pilotage/ground/ground_imagery.h"
#include "pilotage/ground/imagery_months.h"
#include "pilotage/ground/score_raster.h"
#include "pilotage/raster/gdal_io.h"
#include "pilotage/registration/disagreement_raster.h"

namespace pilotage {
namespace {

std::filesystem::path folder_of_outputs(const ScoreOutputOptions& options, const Invocation& invocation) {
  const std::filesystem::path beside = options.table.empty() ? invocation.output : options.table;
  return beside.has_parent_path() ? beside.parent_path() : ".";
}

FrameTable read_frame_table(const EvaluateOptions& options) {
  if (options.frames.empty()) return {};
  return frame_table_from_csv(options.frames, read_file(options.frames), {options.frames_truth, FrameColumns::kAll});
}

FlightFrames complete(const FrameTable& table, const ScoreOutputOptions& options,
                      const std::optional<Camera>& of_plan) {
  FrameSources sources;
  sources.of_map = of_plan;
  if (names_camera(options.camera) || !of_plan) sources.given = make_camera(options.camera);
  return complete_frames(options.evaluate.frames, table, sources);
}

// Entropies differ in the sixth digit.
std::string for_people(double number) {
  return std::abs(number) < 1e-3 ? format_number(number) : format_fixed(number, 6);
}

// One line per measure: how far it ranges.
void summarise(const std::vector<TileScores>& scores, CommandResult& result) {
  std::vector<std::vector<double>> numbers(measures().size());
  for (const TileScores& tile : scores) {
    for (std::size_t i = 0; i < numbers.size(); ++i) {
      if (const double value = measures()[i].get(tile); !std::isnan(value)) numbers[i].push_back(value);
    }
  }
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const Measure& measure = measures()[i];
    std::vector<double>& values = numbers[i];
    if (values.empty()) continue;
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    const double median = *middle;
    const auto [low, high] = std::minmax_element(values.begin(), values.end());
    result.text += measure.name + ": " + for_people(*low) + " … " + for_people(median) + " … " + for_people(*high) +
                   (measure.unit.empty() ? "" : " " + measure.unit) + "\n";
    result.json["measures"][measure.name] = {
        {"minimum", *low}, {"median", median}, {"maximum", *high}, {"tiles", values.size()}};
  }
}

void summarise(const SecondEpoch& epoch, const RegistrationOptions& options, const std::vector<TileScores>& scores,
               CommandResult& result) {
  const Registration& registration = epoch.registration;
  const WarpFit& fit = registration.fit;
  const auto unknown = std::count_if(scores.begin(), scores.end(),
                                     [](const TileScores& tile) { return std::isnan(tile.epoch.disagreement_m); });
  result.text += "second epoch: " + std::to_string(registration.finest_ties) + " ties at " +
                 std::to_string(registration.places) + " places and " +
                 std::to_string(static_cast<std::int64_t>(registration.ties.size()) - registration.finest_ties) +
                 " coarser ones, " + std::to_string(fit.outliers) + " outliers\n";
  result.text += "  disagreement: " + spread_text(fit.disagreement_m) + "\n  residual: " + spread_text(fit.residual_m) +
                 "\n  residual of ties left out: " + spread_text(fit.left_out_m) + "\n";
  const std::string assumption = second_date_assumption(epoch, options);
  result.text += "  assumes: " + assumption + "\n";
  result.json["second_epoch"] = {
      {"gsd_m", registration.gsd_m},
      {"places", registration.places},
      {"ties", registration.finest_ties},
      {"coarser_ties", static_cast<std::int64_t>(registration.ties.size()) - registration.finest_ties},
      {"outliers", fit.outliers},
      {"disagreement_m", spread_json(fit.disagreement_m)},
      {"residual_m", spread_json(fit.residual_m)},
      {"left_out_m", spread_json(fit.left_out_m)},
      {"tiles_unknown", unknown},
      {"assumption", assumption}};
  if (unknown == 0) return;
  result.warnings.push_back("the second date could not be brought onto the reference at " + std::to_string(unknown) +
                            " of " + std::to_string(scores.size()) + " tiles");
}

CommandResult tell(const GroundScores& scored, const ScoreRun& run, const Invocation& invocation) {
  const auto of_status = [&](TileStatus status) {
    return std::count_if(scored.scores.begin(), scored.scores.end(),
                         [&](const TileScores& tile) { return tile.status == status; });
  };
  CommandResult result;
  result.text = std::to_string(scored.scores.size()) + " tiles, " + std::to_string(of_status(TileStatus::kScored)) +
                " scored, " + std::to_string(of_status(TileStatus::kFlat)) + " flat, " +
                std::to_string(of_status(TileStatus::kTooLittleGround)) + " with too little ground\n";
  result.json = {{"output", invocation.output},
                 {"tiles", scored.scores.size()},
                 {"scored", of_status(TileStatus::kScored)},
                 {"flat", of_status(TileStatus::kFlat)},
                 {"too_little_ground", of_status(TileStatus::kTooLittleGround)}};
  summarise(scored.scores, result);
  result.warnings = run.warnings;
  if (scored.second_epoch) summarise(*scored.second_epoch, run.options.score.registration, scored.scores, result);
  return result;
}

}  // namespace

ScoreOutputs::ScoreOutputs(const ScoreOutputOptions& options, const Invocation& invocation, const ScoreRun& run)
    : options_(options), invocation_(invocation), run_(run) {
  if (options.level >= std::ssize(run.ground.levels)) {
    throw UsageError("level = " + std::to_string(options.level) + ": the plan has " +
                     std::to_string(run.ground.levels.size()) + " level(s)");
  }
  if (!options.table.empty()) table_.emplace(options.table, invocation.overwrite);
  if (const std::filesystem::path style = style_path(invocation.output); style != invocation.output) {
    refuse_shared_files(invocation.named_inputs, {{"-o", style}});
    style_.emplace(style, invocation.overwrite);
  }
  if (options.evaluate.wanted()) {
    check_evaluation(options.evaluate);
    std::vector<NamedFile> outputs;
    for (const auto& file : evaluation_outputs(folder_of_outputs(options, invocation))) {
      outputs.push_back({"--evaluate", file});
    }
    refuse_shared_files(invocation.named_inputs, outputs);
    evaluation_.emplace(folder_of_outputs(options, invocation), invocation.overwrite);
  }
  frames_ = read_frame_table(options.evaluate);
  for (const std::string& dataset : run.options.score.second_epoch) {
    const ImageryInfo info =
        inspect_imagery(dataset, second_date_options(run.ground.imagery.options), invocation.progress);
    second_date_warnings_.insert(second_date_warnings_.end(), info.warnings.begin(), info.warnings.end());
  }
  if (options.second_epoch_output.empty()) return;
  if (run.options.score.second_epoch.empty()) throw UsageError("--second-epoch-output needs --second-epoch");
  const OutputFile refused(options.second_epoch_output, invocation.overwrite);
}

CommandResult ScoreOutputs::write(const Ground& ground, const GroundScores& scored) {
  const ScoreTable table(ground, scored.scores);
  CommandResult result = tell(scored, run_, invocation_);
  result.warnings.insert(result.warnings.end(), second_date_warnings_.begin(), second_date_warnings_.end());
  if (evaluation_) add_evaluation(table, scored, result);
  report_progress(invocation_.progress, "writing scores", 0, 0);
  const ScoreRaster raster = score_raster(table, options_.level);
  if (table_) table_->write(tile_table_to_csv(ground, scored.scores));
  OutputFile scores(invocation_.output, invocation_.overwrite);
  write_score_raster(scores.temporary_path(), raster.bands, ground.crs, raster.map_from_pixel, true,
                     invocation_.progress);
  std::vector<const OutputFile*> outputs{&scores};
  if (table_) outputs.push_back(&*table_);
  if (const auto shown = shown_measure(raster, scored.scores); style_ && shown) {
    style_->write(qgis_heat_style(shown->scale, shown->band));
    outputs.push_back(&*style_);
  }
  std::optional<OutputFile> disagreement;
  if (!options_.second_epoch_output.empty()) {
    const SecondEpoch& epoch = *scored.second_epoch;
    const DisagreementRaster layer = disagreement_raster(epoch.registration.fit.field, epoch.area_m);
    disagreement.emplace(options_.second_epoch_output, invocation_.overwrite);
    write_score_raster(disagreement->temporary_path(), layer.bands, ground.crs, layer.map_from_pixel, true,
                       invocation_.progress);
    outputs.push_back(&*disagreement);
  }
  if (evaluation_) {
    evaluation_->commit(outputs);
  } else {
    OutputFile::commit(outputs, {});
  }
  return result;
}

// Shows how well each predictor does, and writes the evaluation's files without letting them appear.
void ScoreOutputs::add_evaluation(const ScoreTable& table, const GroundScores& scored, CommandResult& result) {
  FlightFrames frames;
  if (!frames_.frames.empty()) {
    frames = complete(frames_, options_, run_.flight ? std::optional<Camera>(run_.flight->camera) : std::nullopt);
  }
  const std::filesystem::path scratch = folder_of_outputs(options_, invocation_) / "evaluation_map.gpkg";
  // The date that is judged by may be the second one as well: its registration then corrects the truth.
  const std::vector<std::string>& second_epoch = run_.options.score.second_epoch;
  const bool registered = second_epoch.size() == 1 && second_epoch.front() == options_.evaluate.file;
  const LevelScores judged(table, options_.level);
  const Evaluation evaluation = evaluate(
      judged, frames.frames, options_.evaluate, scratch, run_.seed, invocation_.threads, invocation_.progress,
      registered ? registered_place(scored.second_epoch->registration.fit.field) : PlaceOnReference(same_place));
  const EvaluationSource source{run_.inputs, version_line(), options_.evaluate, run_.seed};
  evaluation_->write(judged, evaluation, source);
  result.json["evaluation"] = evaluation_json(evaluation, source);
  result.text += evaluation_text(evaluation);
  if (run_.options.score.model.empty() && imagery_months(run_.ground)) {
    result.warnings.push_back(
        "P(correct fix) is that of the flight on " + run_.ground.flight_time +
        ", for the age that the imagery then has; what it is judged by was taken at another time");
  }
  result.warnings.insert(result.warnings.end(), frames.warnings.begin(), frames.warnings.end());
  result.warnings.insert(result.warnings.end(), evaluation.warnings.begin(), evaluation.warnings.end());
}

}  // namespace pilotage
