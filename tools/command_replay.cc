#include <algorithm>
#include <filesystem>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "commands.h"
#include "input_guard.h"
#include "stage_files.h"
#include "standard_streams.h"

#include "pilotage/base/error.h"
#include "pilotage/base/json_object.h"
#include "pilotage/base/nan.h"
#include "pilotage/base/output_file.h"
#include "pilotage/base/staging_folder.h"
#include "pilotage/base/text.h"
#include "pilotage/base/work_folder.h"
#include "pilotage/camera/camera_options.h"
#include "pilotage/flightlog/fix_lean.h"
#include "pilotage/flightlog/fix_table.h"
#include "pilotage/flightlog/match_flight.h"
#include "pilotage/flightlog/match_sequence.h"
#include "pilotage/mission/plan_file.h"
#include "pilotage/mission/selection_file.h"
#include "pilotage/raster/elevation.h"
#include "pilotage/replay/calibration_files.h"
#include "pilotage/replay/log_frames.h"
#include "pilotage/replay/replay.h"
#include "pilotage/replay/replay_file.h"
#include "pilotage/vehiclelog/vehicle_log.h"
#include "pilotage/version.h"

namespace pilotage {
namespace {

struct ReplayCommandOptions {
  std::string map;
  std::vector<std::string> also_map;
  std::string plan;
  std::string photos;
  std::string world;
  std::string world_elevation;
  std::string frames;
  LogPriors priors = LogPriors::kDrawn;
  double prior_sigma_m = 30;
  std::optional<double> ground_amsl_m;
  double every_s = 2;
  std::optional<double> origin_lon_deg;
  std::optional<double> origin_lat_deg;
  double origin_amsl_m = 0;
  CameraOptions camera;
  FrameTruth truth = FrameTruth::kCenter;
  double correct_within_m = 5;
  std::optional<double> max_prior_sigma_m;
  double block_m = 500;
  std::string fixes;
  std::string evaluation;
  std::optional<double> require_observed_rate;
  bool sequential = false;
  MatchOptions match;
  InsOptions ins;

  template <class Self, class Fields>
  static void describe(Self& self, Fields& fields) {
    fields.path("map", self.map, "The map that was flown with; map.gpkg of --plan if not given.");
    fields.path("also_map", self.also_map,
                "Another map of the ground that was flown with; each is asked. Repeat for more.");
    fields.path("plan", self.plan,
                "The folder that prepare wrote: its plan.json and selection.json are held against the "
                "flight, leg by leg.");
    fields.path("photos", self.photos, "The pictures of the log's captures: a folder.");
    fields.path("world", self.world,
                "Instead, for a log without pictures: imagery that frames are rendered from, at the "
                "log's true poses.");
    fields.path("world_elevation", self.world_elevation,
                "The heights that these frames show, an elevation model. Default: that of --plan, else flat ground.");
    fields.path("frames", self.frames, "Beside a table of fixes: the frames.csv that was matched.");
    fields.field("priors", self.priors,
                 "What the frames of a log are matched with: its truth, off as a drawn inertial system (--ins-...) "
                 "drifts, or the autopilot's own position.");
    fields.field("prior_sigma_m", self.prior_sigma_m, "With --priors log: standard deviation of each axis.",
                 Range{0.01, 100000});
    fields.field("ground_amsl_m", self.ground_amsl_m,
                 "Height of the ground where the log says no height above it; if not given the elevation model of "
                 "--plan, else the flat ground it assumed, else the log's own lowest height.",
                 Range{-1000, 10000});
    fields.field("every_s", self.every_s, "Time between frames that are rendered from a log without captures.",
                 Range{0.05, 3600});
    fields.field("origin_lon_deg", self.origin_lon_deg, "Where an AirSim recording's own frame begins.",
                 Range{-180, 180});
    fields.field("origin_lat_deg", self.origin_lat_deg, "Where an AirSim recording's own frame begins.",
                 Range{-90, 90});
    fields.field("origin_amsl_m", self.origin_amsl_m, "Height of that place.", Range{-1000, 10000});
    fields.group("camera", self.camera, "The camera; without any of these the map's own.");
    fields.field(
        "truth", self.truth,
        "What true_lon_deg and true_lat_deg of frames.csv are: the ground at the centre of the image, or straight "
        "below the aircraft. Beside true_nadir_lon_deg they are the centre.");
    fields.field("correct_within_m", self.correct_within_m, "A fix with a larger error is false.", Range{0.001, 1e6});
    fields.field(
        "max_prior_sigma_m", self.max_prior_sigma_m,
        "Tries with a less sure prior say nothing of P; the plan's limit over its sigma multiple if not given.",
        Range{0.01, 1e6});
    fields.field("block_m", self.block_m,
                 "Intervals re-draw whole pieces of the way of this length: tries in one are not independent.",
                 Range{1, 1e6});
    fields.path("fixes", self.fixes, "Also write what became of each frame: fixes.csv.");
    fields.path("evaluation", self.evaluation,
                "Also write evaluation.json and evaluation.csv into this folder, for `calibrate`.");
    fields.field("require_observed_rate", self.require_observed_rate,
                 "Exit with 3 when the lower end of the interval of the observed share of fixes is lower.",
                 Range{0, 1});
    fields.field("sequential", self.sequential, "Match one frame after the other, as `match --sequential`.");
    fields.group("match", self.match, "How sure the prior is, how far is searched, what is accepted.",
                 FlagPrefix::kNone);
    fields.group("ins", self.ins, "The inertial system that flew, or is drawn: what its drift is held against.");
  }
};

/// What a LOG is.
enum class InputKind { kFixes, kFrames, kPhotos, kAirSimFolder, kLog };

constexpr const char* kRecordingName = "airsim_rec.txt";

InputKind kind_of_log(const std::string& path) {
  if (std::filesystem::is_directory(path)) {
    return std::filesystem::exists(std::filesystem::path(path) / kRecordingName) ? InputKind::kAirSimFolder
                                                                                 : InputKind::kPhotos;
  }
  const std::string bytes = read_file(path);
  if (log_format_of(bytes)) return InputKind::kLog;
  const std::string first_line = "," + bytes.substr(0, std::min(bytes.find_first_of("\r\n"), bytes.size())) + ",";
  if (first_line.find(",status,") != std::string::npos && first_line.find("file,") != std::string::npos) {
    return InputKind::kFixes;
  }
  if (first_line.find("file,") != std::string::npos) return InputKind::kFrames;
  throw DataError(path +
                  ": is no log that is known (ULog, DataFlash, a telemetry log of MAVLink, airsim_rec.txt), no table "
                  "of frames or fixes, and no folder");
}

struct PlanFiles {
  Mission mission;
  Selection selection;
};

std::optional<PlanFiles> planned_flight_of(const std::string& folder) {
  if (folder.empty()) return std::nullopt;
  const std::string plan = (std::filesystem::path(folder) / "plan.json").string();
  const std::string selection = (std::filesystem::path(folder) / "selection.json").string();
  PlanFiles files{read_stage_plan(plan), {}};
  need_file(selection, "select");
  files.selection = read_selection(selection);
  return files;
}

/// What is the same for all logs.
struct ReplaySetup {
  const ReplayCommandOptions& options;
  const Invocation& invocation;
  const std::optional<PlanFiles>& plan;
  std::vector<std::filesystem::path> maps;
  OpenMaps open_maps;
  std::optional<Camera> map_camera;
  InsErrorModel model;
  std::vector<FrameMatch> matches;  ///< Of all logs, for --fixes.
};

FrameSources sources_of_replay(const ReplaySetup& setup) {
  const CameraOptions& camera = setup.options.camera;
  const CameraMount mount{camera.mount_yaw_deg, camera.mount_pitch_deg, camera.mount_roll_deg};
  FrameSources sources;
  sources.exif_mount = mount;
  if (names_camera(camera)) sources.given = make_camera(camera);
  sources.of_map = setup.map_camera;
  if (sources.of_map && !(mount == CameraMount{})) sources.of_map->mount = mount;
  return sources;
}

Camera camera_of_replay(const ReplaySetup& setup) {
  const FrameSources sources = sources_of_replay(setup);
  if (sources.given) return *sources.given;
  if (sources.of_map) return *sources.of_map;
  throw UsageError("the map names no camera: give --camera, or --camera-hfov-deg and the size of the pictures");
}

ReplayedFlight matched_flight(ReplaySetup& setup, const FlightFrames& frames) {
  const ReplayCommandOptions& options = setup.options;
  const Invocation& invocation = setup.invocation;
  std::vector<FrameMatch> matches;
  ReplayedFlight flight;
  if (options.sequential) {
    MatchedSequence done =
        match_sequence(setup.open_maps, frames.frames, options.match, setup.model, invocation.progress);
    flight.notes.push_back("in sequence: " + std::to_string(done.summary.confirmed) +
                           " fixes confirmed by the track, " + std::to_string(done.summary.gate_refusals) +
                           " refused by it");
    if (const std::string warning = rows_jump_warning(done.summary); !warning.empty()) flight.notes.push_back(warning);
    matches = std::move(done.matches);
  } else {
    matches = match_flight(setup.open_maps, frames.frames, options.match, invocation.threads, invocation.progress);
  }
  std::vector<std::string> names;
  for (const std::filesystem::path& map : setup.maps) names.push_back(map.string());
  for (const FrameMatch& match : matches) {
    if (match.readable()) require_frame_was_tried(match.result, names);
  }
  for (const std::string& warning : lean_warnings(lean_of_fixes(matches, options.match), options.match)) {
    flight.notes.push_back(warning);
  }
  flight.frames = replayed_frames(matches, frames.frames, options.correct_within_m);
  setup.matches.insert(setup.matches.end(), matches.begin(), matches.end());
  return flight;
}

ReplayedFlight flight_of_rows(ReplaySetup& setup, const LogFrames& frames, const std::string& table_path) {
  const Camera camera = camera_of_replay(setup);
  FlightFrames flight;
  for (const FrameRecord& row : frames.rows) flight.frames.push_back({frame_path(table_path, row.file), row, camera});
  ReplayedFlight replayed = matched_flight(setup, flight);
  replayed.priors = setup.options.priors == LogPriors::kDrawn ? "drawn" : "autopilot";
  replayed.notes.insert(replayed.notes.begin(), frames.notes.begin(), frames.notes.end());
  return replayed;
}

std::optional<LogOrigin> origin_of(const ReplayCommandOptions& options) {
  if (options.origin_lon_deg.has_value() != options.origin_lat_deg.has_value()) {
    throw UsageError("--origin-lon-deg and --origin-lat-deg go together: give both or none");
  }
  if (!options.origin_lon_deg) return std::nullopt;
  return LogOrigin{{*options.origin_lon_deg, *options.origin_lat_deg}, options.origin_amsl_m};
}

LogFrameOptions log_frame_options(const ReplaySetup& setup) {
  const ReplayCommandOptions& options = setup.options;
  LogFrameOptions frames{options.priors, options.prior_sigma_m, options.ground_amsl_m, "", {}, options.every_s};
  if (setup.plan) {
    frames.elevation = setup.plan->mission.ground.elevation;
    frames.flat_ground_amsl_m = setup.plan->mission.flight.flat_ground_amsl_m;
  }
  return frames;
}

/// "": flat ground, with a note where the plan's model cannot be read: it may lie on the machine that planned.
std::string elevation_of_world(const ReplaySetup& setup, std::vector<std::string>& notes) {
  if (!setup.options.world_elevation.empty()) return setup.options.world_elevation;
  const std::string of_plan = setup.plan ? setup.plan->mission.ground.elevation : "";
  try {
    if (!of_plan.empty()) Elevation{of_plan};
  } catch (const DataError& error) {
    notes.push_back(std::string("frames are rendered over flat ground, not over the plan's heights: ") + error.what());
    return "";
  }
  return of_plan;
}

/// Leaves the captures that have a photo, with its name.
std::string pair_with_photos(VehicleLog& log, const std::string& folder) {
  const std::vector<Photo> photos = photos_of_folder(folder);
  const PhotoPairs pairs = pair_photos(log.captures, photos, log.utc_minus_log_s);
  std::vector<LoggedCapture> captures;
  for (std::size_t i = 0; i < log.captures.size(); ++i) {
    const auto& photo = pairs.photo_of_capture[i];
    if (!photo) continue;
    captures.push_back(log.captures[i]);
    captures.back().file = photos[*photo].file;
  }
  log.captures = std::move(captures);
  return pairs.how;
}

ReplayedFlight replay_log(ReplaySetup& setup, const std::string& path) {
  const ReplayCommandOptions& options = setup.options;
  VehicleLog log = read_vehicle_log(path, origin_of(options));
  std::vector<std::string> notes = notes_of_log(log);
  const bool has_pictures = std::any_of(log.captures.begin(), log.captures.end(),
                                        [](const LoggedCapture& capture) { return !capture.file.empty(); });
  if (!options.photos.empty() && !options.world.empty()) throw UsageError("--photos and --world exclude each other");
  std::string table_path = path;
  if (!options.photos.empty()) {
    notes.push_back(pair_with_photos(log, options.photos));
    table_path = (std::filesystem::path(options.photos) / "frames").string();
  } else if (options.world.empty() && !has_pictures) {
    throw UsageError(path +
                     ": says when pictures were taken, if at all, but does not hold them: give --photos, or "
                     "--world to render frames from imagery");
  }
  const bool renders = options.photos.empty() && !options.world.empty();
  LogFrames frames = frames_of_log(log, log_frame_options(setup), setup.model, renders, setup.invocation.seed);
  std::unique_ptr<WorkFolder> rendered;
  if (renders) {
    const std::filesystem::path output(setup.invocation.output);
    rendered = std::make_unique<WorkFolder>(output.has_parent_path() ? output.parent_path() : ".");
    render_log_frames(frames, camera_of_replay(setup), options.world, elevation_of_world(setup, notes),
                      rendered->path(), setup.invocation.threads, setup.invocation.progress);
    table_path = (rendered->path() / "frames").string();
  }
  ReplayedFlight flight = flight_of_rows(setup, frames, table_path);
  flight.notes.insert(flight.notes.begin(), notes.begin(), notes.end());
  return flight;
}

ReplayedFlight replay_frames(ReplaySetup& setup, const std::string& path) {
  const FrameTable table = frame_table_from_csv(path, read_file(path), {setup.options.truth, FrameColumns::kAll});
  const FlightFrames frames = complete_frames(path, table, sources_of_replay(setup));
  ReplayedFlight flight = matched_flight(setup, frames);
  flight.priors = "inertial";
  flight.notes.insert(flight.notes.end(), table.warnings.begin(), table.warnings.end());
  return flight;
}

/// Pictures that say themselves where they were taken: that is the truth, or what they are matched with.
ReplayedFlight replay_photos(ReplaySetup& setup, const std::string& folder) {
  FrameTable table;
  for (const Photo& photo : photos_of_folder(folder)) {
    FrameRecord row;
    row.file = photo.file;
    row.time_s = photo.taken_s.value_or(kNaN);
    row.prior = {kNaN, kNaN};
    row.prior_covariance_en_m2 = isotropic_covariance_m2(setup.options.prior_sigma_m);
    row.height_agl_m = kNaN;
    row.attitude = {kNaN, kNaN, kNaN};
    table.frames.push_back(std::move(row));
  }
  FrameSources sources = sources_of_replay(setup);
  sources.from_exif = true;
  const std::string table_path = (std::filesystem::path(folder) / "frames").string();
  FlightFrames frames = complete_frames(table_path, table, sources);
  std::vector<FrameRecord> rows;
  for (FlightFrame& frame : frames.frames) {
    if (std::isnan(frame.frame.prior.lat_deg)) continue;
    frame.frame.true_nadir = frame.frame.prior;
    rows.push_back(frame.frame);
  }
  if (rows.empty()) throw DataError(folder + ": not one picture says in its EXIF where it was taken");
  std::vector<std::string> notes = frames.warnings;
  std::set<std::string> place_tags;
  for (const TakenField& field : frames.taken) {
    if (field.field == "prior_lat_deg") place_tags.insert(field.tag);
  }
  notes.push_back("the pictures' own place counts as the truth: " +
                  join(std::vector<std::string>(place_tags.begin(), place_tags.end()), "; "));
  if (setup.options.priors == LogPriors::kDrawn) {
    const bool timed = std::all_of(rows.begin(), rows.end(), [](const auto& row) { return std::isfinite(row.time_s); });
    if (!timed) {
      throw DataError(folder + ": priors cannot be drawn, for pictures have no DateTimeOriginal; give --priors log");
    }
    if (rows.size() != frames.frames.size()) {
      throw DataError(folder + ": priors cannot be drawn, for pictures have no position; give --priors log");
    }
    draw_priors(rows, setup.model, setup.invocation.seed);
    for (std::size_t i = 0; i < rows.size(); ++i) frames.frames[i].frame = rows[i];
  }
  ReplayedFlight flight = matched_flight(setup, frames);
  flight.priors = setup.options.priors == LogPriors::kDrawn ? "drawn" : "autopilot";
  flight.notes.insert(flight.notes.begin(), notes.begin(), notes.end());
  return flight;
}

ReplayedFlight replay_fixes(const ReplaySetup& setup, const std::string& path) {
  const ReplayCommandOptions& options = setup.options;
  FrameTable table;
  if (!options.frames.empty()) {
    table = frame_table_from_csv(options.frames, read_file(options.frames), {options.truth, FrameColumns::kAll});
  }
  ReplayedFlight flight;
  flight.frames = frames_of_fix_table(path, read_file(path), table.frames, options.correct_within_m);
  flight.priors = options.frames.empty() ? "none" : "inertial";
  flight.notes = table.warnings;
  return flight;
}

ReplayedFlight replay_input(ReplaySetup& setup, const std::string& path) {
  ReplayedFlight flight;
  switch (kind_of_log(path)) {
    case InputKind::kFixes:
      flight = replay_fixes(setup, path);
      break;
    case InputKind::kFrames:
      flight = replay_frames(setup, path);
      break;
    case InputKind::kPhotos:
      flight = replay_photos(setup, path);
      break;
    case InputKind::kAirSimFolder:
      flight = replay_log(setup, (std::filesystem::path(path) / kRecordingName).string());
      break;
    case InputKind::kLog:
      flight = replay_log(setup, path);
      break;
  }
  flight.name = path;
  return flight;
}

std::string map_of(const ReplayCommandOptions& options) {
  if (!options.map.empty()) return options.map;
  if (options.plan.empty()) throw UsageError("--map is missing: the map that was flown with, or --plan with one in it");
  return (std::filesystem::path(options.plan) / "map.gpkg").string();
}

std::string grade_name_of(const InsOptions& ins) {
  if (ins.name) return *ins.name;
  return options_detail::enum_to_name(ins.grade.value_or(kAssumedInsGrade));
}

/// Whether there is an inertial system whose drift can be looked at.
bool has_inertial_priors(const std::vector<ReplayedFlight>& flights) {
  return std::any_of(flights.begin(), flights.end(), [](const ReplayedFlight& flight) {
    return flight.priors == "inertial" || flight.priors == "drawn";
  });
}

/// The replay, and what else is asked for, which all appear at once.
void write_outputs(const Replay& replay, const std::string& json, const ReplaySetup& setup, bool chips) {
  const ReplayCommandOptions& options = setup.options;
  const Invocation& invocation = setup.invocation;
  std::vector<const OutputFile*> outputs;
  std::optional<StagingFolder> folder;  // made where there is none, and gone again if the files do not come
  std::optional<OutputFile> evaluation_json;
  std::optional<OutputFile> evaluation_csv;
  if (!options.evaluation.empty()) {
    EvaluationSource source;
    source.inputs = invocation.inputs;
    source.software_version = "pilotage " PILOTAGE_VERSION;
    source.seed = invocation.seed;
    const CalibrationFiles files = calibration_files(replay, chips, source);
    const std::filesystem::path place(options.evaluation);
    folder.emplace(place);
    evaluation_json.emplace(place / "evaluation.json", invocation.overwrite).write(files.json);
    evaluation_csv.emplace(place / "evaluation.csv", invocation.overwrite).write(files.csv);
    outputs = {&*evaluation_json, &*evaluation_csv};
  }
  std::optional<OutputFile> fixes;
  if (!options.fixes.empty()) {
    fixes.emplace(options.fixes, invocation.overwrite).write(fix_table_to_csv(setup.matches, false));
    outputs.push_back(&*fixes);
  }
  OutputFile output(invocation.output, invocation.overwrite);
  output.write(json);
  outputs.push_back(&output);  // the last: where it stands, the others do
  OutputFile::commit(outputs, {});
}

/// The program knows --evaluation as a folder, and not what is written into it.
void refuse_shared_evaluation(const ReplayCommandOptions& options, const Invocation& invocation) {
  if (options.evaluation.empty()) return;
  std::vector<NamedFile> inputs;
  for (const NamedFile& input : invocation.named_inputs) {
    std::error_code ignored;
    if (std::filesystem::is_regular_file(input.path, ignored)) inputs.push_back(input);
  }
  const std::filesystem::path folder(options.evaluation);
  std::vector<NamedFile> outputs{{"--evaluation", folder / "evaluation.json"},
                                 {"--evaluation", folder / "evaluation.csv"},
                                 {"--output", invocation.output}};
  if (!options.fixes.empty()) outputs.push_back({"--fixes", options.fixes});
  refuse_shared_files(inputs, outputs);
}

constexpr const char* kOneMapLearns = "`calibrate` learns from it how often one map is found";

/// What was matched on several maps, now or before, says nothing of how often the first is found.
void say_of_several_maps(const ReplaySetup& setup, std::vector<ReplayedFlight>& flights) {
  const ReplayCommandOptions& options = setup.options;
  if (!options.also_map.empty() && setup.matches.empty()) {
    throw UsageError("--also-map has no meaning where no frame is matched: fixes.csv says what was asked");
  }
  for (ReplayedFlight& flight : flights) {
    const bool several = std::any_of(flight.frames.begin(), flight.frames.end(),
                                     [](const ReplayedFrame& frame) { return frame.map_count > 1; });
    if (!several) continue;
    if (!options.evaluation.empty()) {
      throw UsageError("--evaluation: " + flight.name + " was matched on several maps; " + kOneMapLearns);
    }
    const std::string note = several_maps_note(setup.maps);
    flight.notes.push_back((note.empty() ? "was matched on several maps; P(correct fix) is of one" : note) +
                           ", so no try is held against it");
  }
}

void refuse_several_maps(const ReplayCommandOptions& options) {
  if (options.also_map.empty()) return;
  if (!options.evaluation.empty()) {
    throw UsageError(std::string("--evaluation and --also-map exclude each other: ") + kOneMapLearns);
  }
  if (options.require_observed_rate) {
    throw UsageError("--require-observed-rate and --also-map exclude each other: what was promised is of one map");
  }
}

/// Frames are rendered for logs alone: of other inputs they are there.
void refuse_world_without_log(const ReplayCommandOptions& options, const std::vector<std::string>& inputs) {
  if (options.world.empty()) {
    if (!options.world_elevation.empty()) throw UsageError("--world-elevation has no meaning without --world");
    return;
  }
  const bool renders = std::any_of(inputs.begin(), inputs.end(), [](const std::string& input) {
    const InputKind kind = kind_of_log(input);
    return kind == InputKind::kLog || kind == InputKind::kAirSimFolder;
  });
  if (!renders) throw UsageError("--world has no meaning without a log: other inputs have their frames");
}

CommandResult run_replay(const ReplayCommandOptions& options, const Invocation& invocation) {
  refuse_world_without_log(options, invocation.inputs);
  refuse_shared_evaluation(options, invocation);
  const std::string map = map_of(options);
  refuse_several_maps(options);
  MapReader reader = MapReader::open_unverified(map);
  const std::optional<PlanFiles> plan = planned_flight_of(options.plan);
  const auto maps = asked_maps(map, options.also_map);
  ReplaySetup setup{
      options, invocation, plan, maps, open_asked_maps(maps), reader.camera(), make_ins_error_model(options.ins), {}};
  std::vector<ReplayedFlight> flights;
  for (const std::string& input : invocation.inputs) flights.push_back(replay_input(setup, input));
  say_of_several_maps(setup, flights);
  PredictedTiles tiles(reader);
  const auto flown = plan ? std::optional(FlownPlan{plan->mission, plan->selection}) : std::nullopt;
  const auto model = has_inertial_priors(flights) ? std::optional(setup.model) : std::nullopt;
  ReplayScoring scoring{options.correct_within_m, options.block_m, options.max_prior_sigma_m, invocation.seed,
                        invocation.threads};
  if (plan && !scoring.max_prior_sigma_m) {
    scoring.max_prior_sigma_m = plan->selection.max_error_m / plan->selection.sigma_multiple;
  }
  Replay replay = score_replay(flights, tiles, flown, model, scoring);
  replay.grade_name = grade_name_of(options.ins);
  if (!replay.prediction)
    replay.notes.emplace_back("no try by one map was over a stored tile with a P, with a prior that P is of");
  if (options.require_observed_rate && !replay.prediction) {
    throw DataError("--require-observed-rate: no try by one map was over a stored tile with a P");
  }
  CommandResult result;
  result.json = replay_to_json(replay);
  write_outputs(replay, json_text(result.json), setup, reader.has_chips() && options.match.chips);
  result.text = replay_text(replay);
  result.warnings = replay.notes;
  for (const std::string& warning : warnings_of_maps(setup.matches, setup.maps)) result.warnings.push_back(warning);
  if (model && !options.ins.grade && !options.ins.name) {
    result.warnings.push_back("no inertial grade is given (--ins-grade): " + replay.grade_name + " is assumed");
  }
  if (options.require_observed_rate && replay.prediction->observed.interval().low < *options.require_observed_rate) {
    result.exit_code = kExitGateNotMet;
  }
  return result;
}

}  // namespace

Command make_replay_command() {
  Command command;
  command.word = "replay";
  command.group = CommandGroup::kInspect;
  command.summary = "Hold a flight that was flown against what was predicted of it";
  command.examples = {
      {"A flight's frames, matched again, beside the plan.", "pilotage replay frames.csv --plan out -o replay.json"},
      {"A log and the photos of its camera.",
       "pilotage replay flight.ulg --photos photos --plan out --camera camera.yaml -o replay.json"},
      {"What was matched before, as food for calibrate.",
       "pilotage replay fixes.csv --frames frames.csv --plan out --evaluation here -o replay.json"}};
  command.inputs = {
      .name = "LOG",
      .help =
          "ULog, DataFlash (.bin), telemetry (.tlog), AirSim's recording or its folder, a folder of photos, "
          "frames.csv, or fixes.csv; one flight each.",
      .min = 1,
      .max = InputSpec::kMany};
  command.output = {.kind = OutputKind::kFile,
                    .help = "The replay (JSON).",
                    .flags = {"fixes"},
                    .folder_flags = {"evaluation"},
                    .stream_name = "replay.json"};
  command.reads_rasters = true;
  bind_options<ReplayCommandOptions>(command, run_replay);
  return command;
}

}  // namespace pilotage
