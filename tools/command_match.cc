#include <algorithm>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "commands.h"
#include "signed_input.h"
#include "stage_files.h"
#include "standard_streams.h"

#include "pilotage/base/error.h"
#include "pilotage/base/nan.h"
#include "pilotage/base/output_file.h"
#include "pilotage/base/text.h"
#include "pilotage/camera/camera_options.h"
#include "pilotage/flightlog/fix_table.h"
#include "pilotage/flightlog/flight_frames.h"
#include "pilotage/flightlog/frame_exif.h"
#include "pilotage/flightlog/match_evaluation.h"
#include "pilotage/flightlog/match_flight.h"
#include "pilotage/flightlog/match_json.h"
#include "pilotage/flightlog/match_sequence.h"
#include "pilotage/ins/ins_error_model.h"

namespace pilotage {
namespace {

using Json = nlohmann::ordered_json;

struct MatchCommandOptions {
  std::string frames;
  std::vector<std::string> also_map;
  TrustOptions trust;
  std::optional<double> prior_lon_deg;
  std::optional<double> prior_lat_deg;
  std::optional<double> prior_sigma_m;
  std::optional<double> prior_east_sigma_m;
  std::optional<double> prior_north_sigma_m;
  std::optional<double> prior_covariance_en_m2;
  std::optional<double> height_agl_m;
  std::optional<double> yaw_deg;
  std::optional<double> pitch_deg;
  std::optional<double> roll_deg;
  bool from_exif = false;
  CameraOptions camera;
  bool allow_other_camera = false;
  std::optional<double> true_lon_deg;
  std::optional<double> true_lat_deg;
  FrameTruth truth = FrameTruth::kCenter;
  double correct_within_m = 5;
  bool timings = true;
  bool require_fix = false;
  std::optional<double> require_correct_rate;
  std::optional<double> require_false_rate;
  MatchOptions match;
  bool sequential = false;
  InsOptions ins;

  template <class Self, class Fields>
  static void describe(Self& self, Fields& fields) {
    fields.path("frames", self.frames, "A logged flight instead of one frame: frames.csv.");
    fields.path("also_map", self.also_map,
                "Another map of the ground, such as one of imagery of another date; each is asked, at its share of the "
                "rate of false fixes. Repeat for more.");
    TrustOptions::describe(self.trust, fields);
    fields.field("prior_lon_deg", self.prior_lon_deg, "Where the aircraft believes to be.", Range{-180, 360});
    fields.field("prior_lat_deg", self.prior_lat_deg, "Where the aircraft believes to be.", Range{-90, 90});
    fields.field("prior_sigma_m", self.prior_sigma_m,
                 "Standard deviation of that, along each of the two horizontal axes.", Range{0, 100000});
    fields.field("prior_east_sigma_m", self.prior_east_sigma_m,
                 "Instead, with the next two: standard deviation towards the east.", Range{0, 100000});
    fields.field("prior_north_sigma_m", self.prior_north_sigma_m, "Standard deviation towards the north.",
                 Range{0, 100000});
    fields.field("prior_covariance_en_m2", self.prior_covariance_en_m2, "Covariance of east and north.",
                 Range{-1e10, 1e10});
    fields.field("height_agl_m", self.height_agl_m, "Height above the ground.", Range{-1000, 100000});
    fields.field("yaw_deg", self.yaw_deg, "Heading of the nose, clockwise from true north.", Range{-360, 360});
    fields.field("pitch_deg", self.pitch_deg, "Above 0 raises the nose.", Range{-360, 360});
    fields.field("roll_deg", self.roll_deg, "Above 0 lowers the right wing.", Range{-360, 360});
    fields.field("from_exif", self.from_exif,
                 "Take from the pictures' EXIF and XMP (DJI) what is not given: position, height, attitude, focal "
                 "length.");
    fields.group("camera", self.camera, "The camera; without any of these the map's own.");
    fields.field("allow_other_camera", self.allow_other_camera,
                 "Take a camera that looks elsewhere than the one that the map was prepared for.");
    fields.field("true_lon_deg", self.true_lon_deg, "Where the frame really is, to judge the answer.",
                 Range{-180, 360});
    fields.field("true_lat_deg", self.true_lat_deg, "Where the frame really is, to judge the answer.", Range{-90, 90});
    fields.field("truth", self.truth,
                 "What true_lon_deg and true_lat_deg are: the ground at the centre of the image, or straight below the "
                 "aircraft. "
                 "Beside true_nadir_lon_deg they are the centre.");
    fields.field("correct_within_m", self.correct_within_m, "A fix with a larger error is false.", Range{0.001, 1e6});
    fields.field("timings", self.timings,
                 "Say how long matching took; without it the outputs are the same bytes in every run.");
    fields.field("require_fix", self.require_fix, "Exit with 3 when there is no fix (in a flight: not a single one).");
    fields.field("require_correct_rate", self.require_correct_rate, "Exit with 3 when correct fixes / frames is lower.",
                 Range{0, 1});
    fields.field("require_false_rate", self.require_false_rate, "Exit with 3 when false fixes / fixes is higher.",
                 Range{0, 1});
    fields.group("match", self.match, "How sure the prior is, how far is searched, what is accepted.",
                 FlagPrefix::kNone);
    fields.field("sequential", self.sequential,
                 "With --frames: one frame after the other, in the order of their times; fixes narrow the prior of the "
                 "next frame, and weak places that agree with the track become fixes.");
    fields.group("ins", self.ins, "How the inertial position drifts between the frames of --sequential.");
  }
};

// The fields of one frame that a table has as columns.
std::vector<std::pair<std::string, std::optional<double>>> fields_of_one_frame(const MatchCommandOptions& options) {
  return {{"prior_lon_deg", options.prior_lon_deg},
          {"prior_lat_deg", options.prior_lat_deg},
          {"prior_sigma_m", options.prior_sigma_m},
          {"prior_east_sigma_m", options.prior_east_sigma_m},
          {"prior_north_sigma_m", options.prior_north_sigma_m},
          {"prior_covariance_en_m2", options.prior_covariance_en_m2},
          {"height_agl_m", options.height_agl_m},
          {"yaw_deg", options.yaw_deg},
          {"pitch_deg", options.pitch_deg},
          {"roll_deg", options.roll_deg},
          {"true_lon_deg", options.true_lon_deg},
          {"true_lat_deg", options.true_lat_deg}};
}

std::string flag_of(std::string field) {
  std::replace(field.begin(), field.end(), '_', '-');
  return "--" + field;
}

/// NaN when nothing is said of it.
Eigen::Matrix2d prior_covariance_of(const MatchCommandOptions& options) {
  const bool ellipse = options.prior_east_sigma_m || options.prior_north_sigma_m || options.prior_covariance_en_m2;
  if (!ellipse) return isotropic_covariance_m2(options.prior_sigma_m.value_or(kNaN));
  if (options.prior_sigma_m) {
    throw UsageError("--prior-sigma-m and --prior-east-sigma-m ... exclude each other: say it in one way");
  }
  if (!options.prior_east_sigma_m || !options.prior_north_sigma_m) {
    throw UsageError("--prior-east-sigma-m and --prior-north-sigma-m go together: give both or --prior-sigma-m");
  }
  return prior_covariance(*options.prior_east_sigma_m, *options.prior_north_sigma_m,
                          options.prior_covariance_en_m2.value_or(0));
}

FrameRecord record_of_options(const MatchCommandOptions& options, const std::string& path) {
  FrameRecord frame;
  frame.file = path;
  frame.time_s = kNaN;
  frame.prior = {options.prior_lon_deg ? wrap_lon_deg(*options.prior_lon_deg) : kNaN,
                 options.prior_lat_deg.value_or(kNaN)};
  frame.prior_covariance_en_m2 = prior_covariance_of(options);
  frame.height_agl_m = options.height_agl_m.value_or(kNaN);
  frame.attitude = {options.yaw_deg.value_or(kNaN), options.pitch_deg.value_or(kNaN), options.roll_deg.value_or(kNaN)};
  if (options.require_correct_rate || options.require_false_rate) {
    throw UsageError("--require-correct-rate and --require-false-rate are for flights: give --frames");
  }
  if (options.true_lon_deg.has_value() != options.true_lat_deg.has_value()) {
    throw UsageError("--true-lon-deg and --true-lat-deg go together: give both or none");
  }
  if (options.true_lon_deg) {
    auto& truth = options.truth == FrameTruth::kNadir ? frame.true_nadir : frame.true_center;
    truth = {wrap_lon_deg(*options.true_lon_deg), *options.true_lat_deg};
  }
  return frame;
}

FrameSources sources_of(const MatchCommandOptions& options, const MapReader& map) {
  const CameraOptions& camera = options.camera;
  const CameraMount mount{camera.mount_yaw_deg, camera.mount_pitch_deg, camera.mount_roll_deg};
  FrameSources sources;
  sources.from_exif = options.from_exif;
  sources.exif_mount = mount;
  if (names_camera(camera)) sources.given = make_camera(camera);
  sources.of_map = map.camera();
  if (sources.of_map && !(mount == CameraMount{})) sources.of_map->mount = mount;
  return sources;
}

/// The maps that are asked, each checked as the first is.
struct AskedMaps {
  std::vector<std::filesystem::path> paths;
  std::vector<std::optional<SignedInput>> inputs;
  std::vector<MapReader> checked;
  std::vector<std::string> warnings;

  std::vector<MapReader> open() const {
    std::vector<MapReader> maps;
    for (std::size_t i = 0; i < paths.size(); ++i) {
      maps.push_back(inputs[i] ? MapReader::open(inputs[i]->map) : MapReader::open_unverified(paths[i]));
    }
    return maps;
  }
};

AskedMaps read_asked_maps(const MatchCommandOptions& options, const std::string& map) {
  MapRequirements required = requirements_of(options.trust);
  if (names_camera(options.camera) && !options.allow_other_camera) required.camera = make_camera(options.camera);
  AskedMaps maps;
  TrustOptions trust = options.trust;
  maps.inputs.push_back(read_signed_input(trust, map));
  trust.signature.reset();  // it is of the first; those of the others lie beside them
  maps.paths = asked_maps(map, options.also_map);
  for (std::size_t i = 1; i < maps.paths.size(); ++i) {
    maps.inputs.push_back(read_signed_input(trust, maps.paths[i].string()));
  }
  maps.checked = maps.open();
  // Frames of --from-exif may have another camera than any of the maps.
  if (!required.camera && !options.allow_other_camera && !options.from_exif) check_one_camera(maps.checked);
  for (const MapReader& one : maps.checked) {
    check_purpose(one, required);
    if (const auto expired = expiry_warning(one, options.trust)) maps.warnings.push_back(*expired);
  }
  return maps;
}

/// Says what was asked, and of a single frame which of them answers.
void add_maps(const AskedMaps& maps, const std::vector<FrameMatch>& matches, bool single, CommandResult& result) {
  Json paths = Json::array();
  for (const std::filesystem::path& path : maps.paths) paths.push_back(path.string());
  result.json["maps"] = std::move(paths);
  for (std::size_t i = 0; single && maps.paths.size() > 1 && i < maps.paths.size(); ++i) {
    const MatchResult& answer = matches.front().result;
    if (i >= answer.map_statuses.size()) break;
    result.text += maps.paths[i].string() + ": " + std::string(match_status_name(answer.map_statuses[i])) +
                   (i == answer.map_index && answer.status == answer.map_statuses[i] ? " (the answer)\n" : "\n");
  }
  for (const std::string& warning : warnings_of_maps(matches, maps.paths)) result.warnings.push_back(warning);
  result.warnings.insert(result.warnings.end(), maps.warnings.begin(), maps.warnings.end());
}

FlightFrames one_frame(const MatchCommandOptions& options, const Invocation& invocation, const MapReader& map) {
  const std::string& path = invocation.inputs[1];
  const FrameRecord record = record_of_options(options, path);
  FlightFrames frames = complete_frame(path, record, sources_of(options, map));
  std::vector<std::string> missing = missing_fields(frames.frames.front().frame);
  if (missing.empty()) return frames;
  for (std::string& field : missing) field = flag_of(field);
  throw UsageError(join(missing, ", ") + (missing.size() > 1 ? " are" : " is") + " missing" +
                   (options.from_exif ? ", and not in the EXIF of " + path
                                      : "; --from-exif takes what a drone's picture says of itself"));
}

FlightFrames whole_flight(const MatchCommandOptions& options, const MapReader& map) {
  for (const auto& [field, value] : fields_of_one_frame(options)) {
    if (value) throw UsageError(flag_of(field) + " and --frames exclude each other: the table says it of each frame");
  }
  const FrameColumns required = options.from_exif ? FrameColumns::kFileOnly : FrameColumns::kAll;
  const FrameTable table =
      frame_table_from_csv(options.frames, read_named_input(options.frames), {options.truth, required});
  const bool has_truth = std::any_of(table.frames.begin(), table.frames.end(),
                                     [](const FrameRecord& frame) { return frame.truth().has_value(); });
  if (!has_truth && (options.require_correct_rate || options.require_false_rate)) {
    throw UsageError(std::string(options.require_correct_rate ? "--require-correct-rate" : "--require-false-rate") +
                     " needs the truth, which " + options.frames +
                     " does not have (true_nadir_lon_deg, true_nadir_lat_deg)");
  }
  return complete_frames(options.frames, table, sources_of(options, map));
}

struct MatchedFrames {
  std::vector<FrameMatch> matches;
  std::optional<SequenceSummary> sequence;
  std::vector<std::string> warnings;
};

MatchedFrames match_frames(const MatchCommandOptions& options, const OpenMaps& open_maps,
                           const std::vector<FlightFrame>& frames, const Invocation& invocation) {
  if (!options.sequential) {
    return {match_flight(open_maps, frames, options.match, invocation.threads, invocation.progress), {}, {}};
  }
  MatchedSequence done =
      match_sequence(open_maps, frames, options.match, make_ins_error_model(options.ins), invocation.progress);
  MatchedFrames matched{std::move(done.matches), done.summary, {}};
  if (!options.ins.grade && !options.ins.name) {
    matched.warnings.push_back(
        "no inertial grade is given (--ins-grade): " + options_detail::enum_to_name(kAssumedInsGrade) + " is assumed");
  }
  if (const std::string warning = rows_jump_warning(done.summary); !warning.empty()) {
    matched.warnings.push_back(warning);
  }
  return matched;
}

CommandResult frame_result(const MatchCommandOptions& options, const FrameMatch& match, const FlightFrames& frames) {
  CommandResult result;
  result.text = frame_match_text(match, options.timings) + taken_text(frames.taken);
  result.json = to_json(match, frames.taken, options.timings);
  if (options.require_fix && !match.has_fix()) result.exit_code = kExitGateNotMet;
  return result;
}

CommandResult flight_result(const MatchCommandOptions& options, const MatchedFrames& matched,
                            const FlightFrames& frames, const std::string& output) {
  MatchEvaluation evaluation = evaluate_matches(matched.matches, options.correct_within_m, options.match);
  evaluation.sequence = matched.sequence;
  CommandResult result;
  result.text = evaluation_text(evaluation, options.timings) + taken_text(frames.taken);
  result.json = to_json(evaluation, options.timings);
  result.json["output"] = output.empty() ? Json(nullptr) : Json(output);
  result.json["taken"] = to_json(frames.taken);
  result.warnings = frames.warnings;
  result.warnings.insert(result.warnings.end(), matched.warnings.begin(), matched.warnings.end());
  for (const std::string& warning : lean_warnings(evaluation.lean, options.match)) {
    result.warnings.push_back(warning);
  }
  const bool no_fix_is_false = evaluation.false_fixes.of == 0;
  const bool met =
      (!options.require_fix || evaluation.accepted > 0) &&
      (!options.require_correct_rate || evaluation.correct.value() >= *options.require_correct_rate) &&
      (!options.require_false_rate || no_fix_is_false || evaluation.false_fixes.value() <= *options.require_false_rate);
  if (!met) result.exit_code = kExitGateNotMet;
  return result;
}

}  // namespace

Command make_match_command() {
  Command command;
  command.word = "match";
  command.group = CommandGroup::kInspect;
  command.summary = "Find the place of a frame, or of a whole flight, on the map";
  command.examples = {{"One frame, with what the aircraft knows.",
                       "pilotage match map.gpkg frame.jpg --prior-lon-deg 16.5 --prior-lat-deg 55.5 --prior-sigma-m 25 "
                       "--height-agl-m 120 --yaw-deg 152 --pitch-deg 1.5 --roll-deg -0.8 --camera camera.yaml"},
                      {"A logged flight; judged where the truth is in the table.",
                       "pilotage match map.gpkg --frames frames.csv --camera camera.yaml -o fixes.csv"},
                      {"Maps of two dates of the ground, each asked.",
                       "pilotage match map.gpkg --also-map older.gpkg --frames frames.csv -o fixes.csv"},
                      {"Only on a map that this key signed.",
                       "pilotage match map.gpkg --public-key key.pub --frames frames.csv -o fixes.csv"}};
  command.inputs = {.name = "MAP [FRAME]",
                    .help = "The map database, and the picture unless --frames is given.",
                    .min = 1,
                    .max = 2,
                    .stream_flags = {"frames"}};
  command.output = {.kind = OutputKind::kFile,
                    .help = "A table (CSV), one line for each frame.",
                    .required = false,
                    .stream_name = "fixes.csv"};
  command.reads_rasters = true;
  bind_options<MatchCommandOptions>(command, [](const MatchCommandOptions& options, const Invocation& invocation) {
    const bool single = invocation.inputs.size() > 1;
    if (single == !options.frames.empty()) {
      throw UsageError(single ? "FRAME and --frames exclude each other" : "FRAME is missing: a picture, or --frames");
    }
    if (single && options.sequential) throw UsageError("--sequential is for flights: give --frames");
    if (!options.sequential && (options.ins.grade || options.ins.name)) {
      throw UsageError("--ins-grade and --ins-name are for --sequential");
    }
    const AskedMaps maps = read_asked_maps(options, invocation.inputs.front());
    const MapReader& first = maps.checked.front();
    const FlightFrames frames = single ? one_frame(options, invocation, first) : whole_flight(options, first);
    const MatchedFrames matched = match_frames(
        options, [&] { return maps.open(); }, frames.frames, invocation);
    if (!invocation.output.empty()) {
      write_file(invocation.output, fix_table_to_csv(matched.matches, options.timings), invocation.overwrite);
    }
    CommandResult result = single ? frame_result(options, matched.matches.front(), frames)
                                  : flight_result(options, matched, frames, invocation.output);
    add_maps(maps, matched.matches, single, result);
    return result;
  });
  return command;
}

}  // namespace pilotage
