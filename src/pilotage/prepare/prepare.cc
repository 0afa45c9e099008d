#include "pilotage/prepare/prepare.h"

#include <algorithm>
#include <memory>
#include <optional>
#include <system_error>
#include <utility>

#include <nlohmann/json.hpp>

#include "pilotage/base/error.h"
#include "pilotage/base/json_object.h"
#include "pilotage/base/options_json.h"
#include "pilotage/base/output_file.h"
#include "pilotage/base/staging_folder.h"
#include "pilotage/gis/score_files.h"
#include "pilotage/ground/ground_imagery.h"
#include "pilotage/ground/score_raster.h"
#include "pilotage/ground/tile_table.h"
#include "pilotage/mapdb/map_delta.h"
#include "pilotage/mapdb/map_signature.h"
#include "pilotage/mission/landmark_file.h"
#include "pilotage/mission/plan_file.h"
#include "pilotage/mission/planned_landmarks.h"
#include "pilotage/mission/selection_file.h"
#include "pilotage/mission/simulation_file.h"
#include "pilotage/pack/field_pack.h"
#include "pilotage/raster/gdal_io.h"
#include "pilotage/raster/gray_stretch.h"
#include "pilotage/registration/disagreement_raster.h"
#include "pilotage/report/plan_report.h"
#include "pilotage/report/report.h"
#include "pilotage/score/score_ground.h"
#include "pilotage/score/score_second_epoch.h"
#include "pilotage/select/route_ageing.h"
#include "pilotage/select/select_tiles.h"
#include "pilotage/simulate/simulate_flights.h"
#include "pilotage/tile/plan_tiles.h"
#include "pilotage/verdict/evidence.h"

namespace pilotage {
namespace {

namespace fs = std::filesystem;

std::string score_raster_name(int level) {
  return level == 0 ? "scores.tif" : "scores_level" + std::to_string(level) + ".tif";
}

constexpr const char* kPlan = "plan.json";
constexpr const char* kTable = "tiles.csv";
constexpr const char* kSelection = "selection.json";
constexpr const char* kSimulation = "simulation.json";
constexpr const char* kMap = kPackMapName;
constexpr const char* kDisagreement = "disagreement.tif";
constexpr const char* kPackRoute = "pack_route";  // with the ending of the file that the planner gave
constexpr const char* kReport = "report";         // what the names of its files begin with

/// Of the endings that route files have.
bool is_pack_route(const std::string& name) {
  for (const char* ending : {".plan", ".mission", ".waypoints", ".txt", ".kml", ".kmz", ".wpml", ".csv", ".json",
                             ".gpx", ".geojson", ".gpkg", ".route"}) {
    if (name == kPackRoute + std::string(ending)) return true;
  }
  return false;
}

}  // namespace

std::vector<std::string> earlier_outputs(const fs::path& folder) {
  std::vector<std::string> names;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    const std::string name = entry.path().filename().string();
    const bool route_of_pack = is_pack_route(name) && entry.symlink_status(error).type() == fs::file_type::regular;
    const bool one_of_ours = name == kPlan || name == kTable || name == kSelection || name == kSimulation ||
                             name == kMap || name == signature_path_of(kMap) || name == chunk_list_path_of(kMap) ||
                             name == kDisagreement || name == kPackManifestName ||
                             name == signature_path_of(kPackManifestName) || route_of_pack ||
                             name == map_delta_path_of(kMap) || name == signature_path_of(map_delta_path_of(kMap)) ||
                             name == score_raster_name(0) || name == "scores.qml" || is_report_output(kReport, name);
    const bool further_level = name.starts_with("scores_level") && (name.ends_with(".tif") || name.ends_with(".qml"));
    if (one_of_ours || further_level) names.push_back(name);
  }
  std::sort(names.begin(), names.end());
  return names;
}

std::vector<ReportOutput> outputs_of(const PrepareOptions& options) {
  std::vector<ReportOutput> outputs = options.outputs;
  if (!asks_for(outputs, ReportOutput::kPack)) return outputs;
  for (const ReportOutput part : {ReportOutput::kHtml, ReportOutput::kImagery}) {
    if (!asks_for(outputs, part)) outputs.push_back(part);
  }
  return outputs;
}

namespace {

/// The route as its planner gave it, for the pack; its name, "" where it is no file.
std::string copy_route(const fs::path& given, const StagingFolder& staging) {
  std::error_code error;
  if (!fs::is_regular_file(given, error)) return "";
  std::string name = kPackRoute + given.extension().string();
  if (!is_pack_route(name)) name = kPackRoute + std::string(".route");
  write_file(staging / name, read_file(given), true);
  return name;
}

/// The route in the pack must be the one that was planned on, by the digest that stands among the inputs.
void refuse_changed_route(const PackManifest& manifest) {
  for (const PackFile& file : manifest.files) {
    if (!is_pack_route(file.name)) continue;
    for (const InputFile& input : manifest.inputs) {
      if (input.role != "route" || input.digest == file.digest) continue;
      throw DataError(input.name + ": has changed while the mission was prepared");
    }
  }
}

/// What a pack should say and does not.
std::vector<std::string> pack_warnings(const PackManifest& manifest, bool is_signed) {
  std::vector<std::string> warnings;
  if (!is_signed) warnings.emplace_back("the pack is not signed: who takes it cannot tell whose it is; --sign-key");
  for (const InputFile& input : manifest.inputs) {
    const bool is_shown = input.role == "imagery" || input.role == "elevation" || input.role == "second_epoch";
    if (!is_shown || !input.licence.terms.empty()) continue;
    const bool is_elevation = input.role == "elevation";
    warnings.push_back(input.name + ": its licence is not known; " +
                       (input.role == "second_epoch"
                            ? std::string("its tag PILOTAGE_LICENCE says it")
                            : std::string(is_elevation ? "--elevation-licence" : "--licence")));
  }
  return warnings;
}

/// The manifest of all files written so far, and its signature; their names.
std::vector<std::string> write_manifest(const PackManifest& manifest, const PrepareRun& run,
                                        const StagingFolder& staging) {
  write_file(staging / kPackManifestName, pack_manifest_text(manifest), true);
  if (!run.secret_key) return {kPackManifestName};
  const std::string signature = signature_path_of(kPackManifestName).string();
  sign_whole_file(staging / kPackManifestName, staging / signature, *run.secret_key, run.sign);
  return {kPackManifestName, signature};
}

/// What turns the map that is there into the one in the staging folder, and its signature; their names.
std::vector<std::string> write_delta(const std::vector<std::string>& files, const PrepareRun& run,
                                     const StagingFolder& staging, const Progress& progress) {
  const auto if_written = [&](const fs::path& name) -> std::optional<fs::path> {
    if (std::find(files.begin(), files.end(), name.string()) == files.end()) return std::nullopt;
    return staging / name.string();
  };
  const std::string delta = map_delta_path_of(kMap).string();
  write_map_delta(staging / delta, *run.update, staging / kMap, if_written(signature_path_of(kMap)),
                  if_written(chunk_list_path_of(kMap)), progress);
  if (!run.secret_key) return {delta};
  const std::string signature = signature_path_of(delta).string();
  sign_whole_file(staging / delta, staging / signature, *run.secret_key, run.sign);
  return {delta, signature};
}

void refuse_existing(const fs::path& folder, bool overwrite) {
  if (overwrite) return;
  for (const std::string& name : earlier_outputs(folder)) {
    throw DataError((folder / name).string() + ": exists already; give --overwrite to replace it");
  }
}

nlohmann::ordered_json described(PrepareOptions options) {
  return options_to_json(list_options(options));
}

}  // namespace

ScoreOptions score_options_of(const PrepareOptions& options) {
  ScoreOptions score = options.score;
  score.features = options.build.features;
  if (options.build.chips.chips) {
    score.matcher = FlyingMatcher::kFeaturesAndChips;
  } else if (score.matcher == FlyingMatcher::kFeaturesAndChips) {
    throw UsageError("matcher = features_and_chips: the map gets no chips; ask for them (chips), or leave matcher out");
  }
  return score;
}

std::optional<Simulation> fly_plan(const Mission& mission, const std::vector<TileScores>& scores,
                                   const Selection& selection, const PrepareOptions& options, std::uint64_t seed,
                                   int threads, const Progress& progress) {
  if (options.flights == 0 || !selection.probability) return std::nullopt;
  SimulateOptions drawn;
  drawn.flights = options.flights;
  return simulate_flights(mission, scores, selection, drawn, seed, threads, progress);
}

PrepareResult prepare(const PrepareOptions& options, const PrepareRun& run, const Progress& progress) {
  check_options(options);
  if (!options.build.landmarks.empty()) read_map_landmarks(options.build.landmarks);  // before hours of work
  const ScoreOptions score_options = score_options_of(options);
  const std::vector<ReportOutput> outputs = outputs_of(options);
  if (options.build.keep_features != KeepFeatures::kAll && options.score.second_epoch.empty()) {
    throw UsageError("keep_features = stable needs a second date: give --second-epoch");
  }
  refuse_unnamed_autopilot(options.outputs, options.tile.autopilot);
  refuse_existing(run.output_folder, run.overwrite);
  const MapPurpose purpose = make_purpose(options.purpose);
  if (run.update) check_map_to_update(*run.update, purpose);
  constexpr int kParts = 6;
  const Progress planning = part_of(progress, 1, kParts);
  const Progress scoring = part_of(progress, 2, kParts);
  const Progress selecting = part_of(progress, 3, kParts);
  const Progress flying = part_of(progress, 4, kParts);
  const Progress building = part_of(progress, 5, kParts);
  const Progress reporting = part_of(progress, 6, kParts);
  std::vector<ImageryInfo> second_dates;
  for (const std::string& dataset : options.score.second_epoch) {  // fails now, not after hours
    second_dates.push_back(inspect_imagery(dataset, second_date_options(options.tile.imagery_options), planning));
  }

  const Mission mission = plan_tiles(options.tile, planning);
  const StagingFolder staging(run.output_folder);
  PrepareResult result;
  const auto publish_later = [&](const std::string& name) {
    result.files.push_back(name);
    return staging / name;
  };
  if (asks_for(outputs, ReportOutput::kPack)) {
    const std::string route = copy_route(mission.flight.route_file, staging);
    if (!route.empty()) result.files.push_back(route);
  }
  write_file(publish_later(kPlan), json_text(plan_to_json(mission)), true);

  report_progress(scoring, "reading imagery", 0, 0);  // until there are tiles to count
  std::optional<GroundImagery> imagery = open_imagery(mission.ground);
  const GroundScores scored = score_ground(mission.ground, score_options, run.seed, run.threads, scoring, &*imagery);
  const std::vector<TileScores>& scores = scored.scores;
  if (scored.second_epoch) {
    const SecondEpoch& epoch = *scored.second_epoch;
    const DisagreementRaster layer = disagreement_raster(epoch.registration.fit.field, epoch.area_m);
    write_score_raster(publish_later(kDisagreement), layer.bands, mission.ground.crs, layer.map_from_pixel, true,
                       scoring);
  }
  report_progress(scoring, "writing scores", 0, 0);
  const ScoreTable table(mission.ground, scores);
  write_file(publish_later(kTable), tile_table_to_csv(mission.ground, scores), true);
  for (const GridLevel& level : mission.ground.levels) {
    const ScoreRaster raster = score_raster(table, level.matrix.level);
    if (raster.bands.empty()) continue;
    const fs::path path = publish_later(score_raster_name(level.matrix.level));
    write_score_raster(path, raster.bands, mission.ground.crs, raster.map_from_pixel, true, scoring);
    const auto shown = shown_measure(raster, scores);
    if (shown && asks_for(outputs, ReportOutput::kCog)) {
      result.files.push_back(write_heat_style(path, *shown, true));
    }
  }

  report_progress(selecting, "selecting", 0, 0);
  Selection selection =
      select_tiles(mission, scores, stored_size(options.build, mission.ground), options.select, run.threads);
  selection.ageing = age_route(mission, scores, selection, run.threads);
  write_file(publish_later(kSelection), json_text(selection_to_json(selection)), true);

  std::optional<Simulation> simulation = fly_plan(mission, scores, selection, options, run.seed, run.threads, flying);
  if (simulation) {
    simulation->inputs =
        simulated_inputs((staging / kPlan).string(), (staging / kTable).string(), (staging / kSelection).string());
    write_file(publish_later(kSimulation), json_text(simulation_to_json(*simulation)), true);
  }

  std::vector<InputFile> inputs = input_files(mission);  // hashed once, for map and report
  for (const ImageryInfo& info : second_dates) {
    inputs.push_back(input_dataset("second_epoch", info.dataset, info.acquired, info.licence));
  }
  if (!options.build.landmarks.empty()) inputs.push_back(input_file("landmarks", options.build.landmarks, ""));
  std::optional<SecondDate> second_date;
  if (scored.second_epoch) {
    const Registration& registration = scored.second_epoch->registration;
    second_date = SecondDate{options.score.second_epoch, registration.fit.field};
  }
  result.map = build_map(publish_later(kMap), mission, scores, selection, inputs, run.software_version, options.build,
                         true, run.threads, building, second_date, &*imagery, purpose);
  if (run.secret_key) {
    SignOptions sign = run.sign;
    sign.signature_path = publish_later(signature_path_of(kMap));
    const fs::path chunk_list = chunk_list_path_of(kMap);
    sign.chunk_list_path = staging / chunk_list.string();
    if (sign_file(staging / kMap, *run.secret_key, sign).chunk_list) result.files.push_back(chunk_list.string());
  }
  if (run.update) {
    const std::vector<std::string> of_delta = write_delta(result.files, run, staging, building);
    result.files.insert(result.files.end(), of_delta.begin(), of_delta.end());
    result.difference = difference_of_maps(*run.update, staging / kMap);
  }
  OpenLevel open_second;
  if (second_date) {
    open_second = [&](const GridLevel& level) { return open_second_date(*second_date, mission.ground, level); };
  }
  ReportInput input = make_report_input(mission, scores, selection, inputs, run.software_version);
  if (asks_for(outputs, ReportOutput::kHtml)) {
    const OpenLevel open_own = [&](const GridLevel& level) {
      return stretch_to_8bit(imagery->levels[static_cast<std::size_t>(level.matrix.level)].gray);
    };
    add_pictures(input, run.threads, reporting, open_second, open_own);
  }
  imagery.reset();  // what is left reads it at other scales
  report_progress(reporting, "writing the report", 0, 0);
  if (simulation) {
    input.simulations.push_back(*std::move(simulation));
    InputFile& flown = input.inputs.emplace_back(input_file("simulation", (staging / kSimulation).string(), ""));
    flown.name = kSimulation;
  }
  if (scored.second_epoch) {
    input.assumptions.push_back(second_date_assumption(*scored.second_epoch, options.score.registration));
  }
  if (!options.build.landmarks.empty())
    input.landmarks = std::make_shared<MapLandmarks>(read_planned_landmarks(mission.ground, options.build.landmarks));
  input.parameters = described(options);
  input.title = purpose.mission_name.value_or("");
  input.inputs.push_back({"map", "map.gpkg", "", "blake2b-256:" + result.map.content_digest});
  Report report = make_report(input);
  for (const ImageryInfo& info : second_dates) {
    report.warnings.insert(report.warnings.end(), info.warnings.begin(), info.warnings.end());
  }
  const std::vector<std::string> written =
      write_report_outputs(staging / "", kReport, input, report, outputs, false, run.threads, reporting);
  result.files.insert(result.files.end(), written.begin(), written.end());
  std::vector<std::string> pack_notes;
  if (asks_for(outputs, ReportOutput::kPack)) {
    PackManifest manifest{run.software_version,
                          report.title,
                          report.verdict_text,
                          report.assumptions,
                          evidence_line(report.quality),
                          purpose,
                          result.map.content_digest,
                          {},
                          report.inputs};
    for (const std::string& name : result.files) manifest.files.push_back(pack_file(staging / "", name));
    refuse_changed_route(manifest);
    const std::vector<std::string> of_pack = write_manifest(manifest, run, staging);
    result.files.insert(result.files.end(), of_pack.begin(), of_pack.end());
    pack_notes = pack_warnings(manifest, run.secret_key.has_value());
  }
  std::vector<std::string> in_order = result.files;
  std::stable_partition(in_order.begin(), in_order.end(), [](const std::string& name) { return name != kMap; });
  staging.publish(in_order, earlier_outputs(run.output_folder));  // the map last: with it the output is whole

  result.verdict = report.verdict_text;
  result.assumptions = report.assumptions;
  result.evidence = evidence_line(report.quality);
  if (report.ageing) result.holds = report.ageing->sentence;
  result.planned_tiles = static_cast<std::int64_t>(mission.ground.tiles.size());
  result.selected_tiles = static_cast<std::int64_t>(selection.tile_ids.size());
  result.matchable_fraction = selection.matchable_fraction;
  result.within_limit = selection.within_limit;
  result.meets_gate = report.verdict != QualityStatus::kBad;
  result.warnings = report.warnings;
  if (const auto warning = missing_imagery_warning(outputs, written)) result.warnings.push_back(*warning);
  result.warnings.insert(result.warnings.end(), pack_notes.begin(), pack_notes.end());
  if (options.build.keep_features != KeepFeatures::kAll && score_options.measure(ScoreMeasure::kCorrectFix)) {
    result.warnings.emplace_back(
        "keep_features = stable: P(correct fix), the selection and the verdict are those of a map with all its "
        "features");
  }
  return result;
}

}  // namespace pilotage
