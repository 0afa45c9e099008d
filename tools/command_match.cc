#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <map>
#include <optional>

#include "commands.h"

#include "pilotage/base/error.h"
#include "pilotage/base/json_object.h"
#include "pilotage/base/output_file.h"
#include "pilotage/base/text.h"
#include "pilotage/camera/camera_options.h"
#include "pilotage/match/fix_table.h"
#include "pilotage/match/flight_frames.h"
#include "pilotage/match/frame_exif.h"
#include "pilotage/match/match_evaluation.h"
#include "pilotage/match/match_flight.h"

namespace pilotage {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

struct MatchCommandOptions {
  std::string frames;
  std::optional<double> prior_lon_deg;
  std::optional<double> prior_lat_deg;
  std::optional<double> prior_sigma_m;
  std::optional<double> height_agl_m;
  std::optional<double> yaw_deg;
  std::optional<double> pitch_deg;
  std::optional<double> roll_deg;
  bool from_exif = false;
  CameraOptions camera;
  std::optional<double> true_lon_deg;
  std::optional<double> true_lat_deg;
  FrameTruth truth = FrameTruth::kCenter;
  double correct_within_m = 5;
  bool timings = true;
  bool require_fix = false;
  std::optional<double> require_correct_rate;
  std::optional<double> require_false_rate;
  MatchOptions match;

  template <class Self, class Fields>
  static void describe(Self& self, Fields& fields) {
    fields.path("frames", self.frames, "A logged flight instead of one frame: frames.csv.");
    fields.field("prior_lon_deg", self.prior_lon_deg, "Where the aircraft believes to be.", Range{-180, 360});
    fields.field("prior_lat_deg", self.prior_lat_deg, "Where the aircraft believes to be.", Range{-90, 90});
    fields.field("prior_sigma_m", self.prior_sigma_m,
                 "Standard deviation of that, along each of the two horizontal axes.", Range{0, 100000});
    fields.field("height_agl_m", self.height_agl_m, "Height above the ground.", Range{-1000, 100000});
    fields.field("yaw_deg", self.yaw_deg, "Heading of the nose, clockwise from true north.", Range{-360, 360});
    fields.field("pitch_deg", self.pitch_deg, "Above 0 raises the nose.", Range{-360, 360});
    fields.field("roll_deg", self.roll_deg, "Above 0 lowers the right wing.", Range{-360, 360});
    fields.field("from_exif", self.from_exif,
                 "Take from the pictures' EXIF and XMP (DJI) what is not given: position, height, attitude, focal "
                 "length.");
    fields.group("camera", self.camera, "The camera; without any of these the map's own.");
    fields.field("true_lon_deg", self.true_lon_deg, "Where the frame really is, to judge the answer.",
                 Range{-180, 360});
    fields.field("true_lat_deg", self.true_lat_deg, "Where the frame really is, to judge the answer.", Range{-90, 90});
    fields.field("truth", self.truth,
                 "What the true point is: the ground at the centre of the image, or straight below the aircraft.");
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
  }
};

// The fields of one frame that a table has as columns.
std::vector<std::pair<std::string, std::optional<double>>> fields_of_one_frame(const MatchCommandOptions& options) {
  return {{"prior_lon_deg", options.prior_lon_deg},
          {"prior_lat_deg", options.prior_lat_deg},
          {"prior_sigma_m", options.prior_sigma_m},
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

FrameRecord record_of_options(const MatchCommandOptions& options, const std::string& path) {
  FrameRecord frame;
  frame.file = path;
  frame.time_s = kNaN;
  frame.prior = {options.prior_lon_deg ? wrap_lon_deg(*options.prior_lon_deg) : kNaN,
                 options.prior_lat_deg.value_or(kNaN)};
  frame.prior_sigma_m = options.prior_sigma_m.value_or(kNaN);
  frame.height_agl_m = options.height_agl_m.value_or(kNaN);
  frame.attitude = {options.yaw_deg.value_or(kNaN), options.pitch_deg.value_or(kNaN), options.roll_deg.value_or(kNaN)};
  if (options.true_lon_deg.has_value() != options.true_lat_deg.has_value()) {
    throw UsageError("--true-lon-deg and --true-lat-deg go together: give both or none");
  }
  if (options.true_lon_deg) frame.truth = {wrap_lon_deg(*options.true_lon_deg), *options.true_lat_deg};
  return frame;
}

FrameSources sources_of(const MatchCommandOptions& options, const std::string& map_path) {
  const CameraOptions& camera = options.camera;
  const CameraMount mount{camera.mount_yaw_deg, camera.mount_pitch_deg, camera.mount_roll_deg};
  FrameSources sources;
  sources.from_exif = options.from_exif;
  sources.exif_mount = mount;
  const bool given = !camera.file.empty() || camera.hfov_deg || camera.width_px || camera.height_px ||
                     camera.sensor_width_mm || camera.sensor_height_mm || camera.focal_length_mm;
  if (given) sources.given = make_camera(camera);
  sources.of_map = camera_of_map(map_path, MapReader(map_path).info());
  if (sources.of_map && !(mount == CameraMount{})) sources.of_map->mount = mount;
  return sources;
}

FlightFrames one_frame(const MatchCommandOptions& options, const Invocation& invocation) {
  const std::string& path = invocation.inputs[1];
  const FrameRecord record = record_of_options(options, path);
  FlightFrames frames = complete_frame(path, record, sources_of(options, invocation.inputs.front()));
  std::vector<std::string> missing = missing_fields(frames.frames.front().frame);
  if (missing.empty()) return frames;
  for (std::string& field : missing) field = flag_of(field);
  throw UsageError(join(missing, ", ") + (missing.size() > 1 ? " are" : " is") + " missing" +
                   (options.from_exif ? ", and not in the EXIF of " + path
                                      : "; --from-exif takes what a drone's picture says of itself"));
}

FlightFrames whole_flight(const MatchCommandOptions& options, const Invocation& invocation) {
  for (const auto& [field, value] : fields_of_one_frame(options)) {
    if (value) throw UsageError(flag_of(field) + " and --frames exclude each other: the table says it of each frame");
  }
  std::error_code ignored;
  if (std::filesystem::equivalent(options.frames, invocation.output, ignored)) {
    throw UsageError("--output = \"" + invocation.output + "\" is also an input");
  }
  const FrameColumns required = options.from_exif ? FrameColumns::kFileOnly : FrameColumns::kAll;
  const FrameTable table = frame_table_from_csv(options.frames, read_file(options.frames), {options.truth, required});
  const bool has_truth = std::any_of(table.frames.begin(), table.frames.end(),
                                     [](const FrameRecord& frame) { return frame.truth.has_value(); });
  if (!has_truth && (options.require_correct_rate || options.require_false_rate)) {
    throw UsageError(std::string(options.require_correct_rate ? "--require-correct-rate" : "--require-false-rate") +
                     " needs the truth, which " + options.frames + " does not have (true_lon_deg, true_lat_deg)");
  }
  return complete_frames(options.frames, table, sources_of(options, invocation.inputs.front()));
}

Json place_json(const Fix& fix, GeodeticPoint Fix::*point, Eigen::Matrix2d Fix::*covariance) {
  const Eigen::Matrix2d& c = fix.*covariance;
  return {
      {"lon_deg", json_number((fix.*point).lon_deg)},
      {"lat_deg", json_number((fix.*point).lat_deg)},
      {"east_sigma_m", json_number(std::sqrt(c(0, 0)))},
      {"north_sigma_m", json_number(std::sqrt(c(1, 1)))},
      {"covariance_en_m2", {json_number(c(0, 0)), json_number(c(0, 1)), json_number(c(1, 0)), json_number(c(1, 1))}}};
}

Json fix_json(const std::optional<Fix>& fix, const std::optional<FixError>& error) {
  if (!fix) return nullptr;
  Json json = place_json(*fix, &Fix::position, &Fix::covariance_en_m2);
  json["center"] = place_json(*fix, &Fix::center, &Fix::center_covariance_en_m2);
  json["yaw_deg"] = json_number(fix->yaw_deg);
  json["pitch_deg"] = json_number(fix->pitch_deg);
  json["roll_deg"] = json_number(fix->roll_deg);
  json["yaw_sigma_deg"] = json_number(fix->yaw_sigma_deg);
  json["height_agl_m"] = json_number(fix->height_agl_m);
  json["height_sigma_m"] = json_number(fix->height_sigma_m);
  json["scale"] = json_number(fix->scale);
  json["tile_id"] = fix->tile_id;
  if (!error) return json;
  json["error_m"] = json_number(error->error_m);
  json["error_east_m"] = json_number(error->east_m);
  json["error_north_m"] = json_number(error->north_m);
  json["nees"] = json_number(error->nees);
  return json;
}

Json stats_json(const MatchStats& stats) {
  return {{"level", stats.level},
          {"gsd_m", json_number(stats.gsd_m)},
          {"frame_features", stats.frame_features},
          {"map_features", stats.map_features},
          {"vote_peak", json_number(stats.vote_peak)},
          {"vote_rival", json_number(stats.vote_rival)},
          {"inliers", stats.inliers},
          {"residual_m", json_number(stats.residual_m)},
          {"ncc", json_number(stats.ncc)},
          {"ncc_rival", json_number(stats.ncc_rival)},
          {"confidence", json_number(stats.confidence)}};
}

Json taken_json(const std::vector<TakenField>& taken) {
  Json list = Json::array();
  for (const TakenField& one : taken) {
    list.push_back({{"file", one.file}, {"field", one.field}, {"value", json_number(one.value)}, {"tag", one.tag}});
  }
  return list;
}

// One line for each field and tag, with the number of frames when there are several.
std::string taken_text(const std::vector<TakenField>& taken) {
  std::map<std::pair<std::string, std::string>, std::vector<double>> values;
  for (const TakenField& one : taken) values[{one.field, one.tag}].push_back(one.value);
  std::string text;
  for (const auto& [key, numbers] : values) {
    text += "from the picture: " + key.first +
            (numbers.size() == 1 ? " = " + format_number(numbers.front())
                                 : " of " + std::to_string(numbers.size()) + " frames") +
            " (" + key.second + ")\n";
  }
  return text;
}

std::string fix_text(const Fix& fix) {
  const Eigen::Matrix2d& c = fix.covariance_en_m2;
  return "aircraft: lon " + format_fixed(fix.position.lon_deg, 7) + ", lat " + format_fixed(fix.position.lat_deg, 7) +
         ", sigma east " + format_fixed(std::sqrt(c(0, 0)), 2) + " m, north " + format_fixed(std::sqrt(c(1, 1)), 2) +
         " m\ncentre of the image: lon " + format_fixed(fix.center.lon_deg, 7) + ", lat " +
         format_fixed(fix.center.lat_deg, 7) + "\nyaw " + format_fixed(fix.yaw_deg, 2) + " deg, height " +
         format_fixed(fix.height_agl_m, 1) + " m above ground, tile " + std::to_string(fix.tile_id) + "\n";
}

CommandResult tell_frame(const MatchCommandOptions& options, const FrameMatch& match, const FlightFrames& frames) {
  CommandResult result;
  const MatchStats& stats = match.result.stats;
  result.text = frame_status_name(match) + ": " + frame_status_text(match) + "\n";
  if (match.has_fix()) result.text += fix_text(*match.result.fix);
  if (match.error) result.text += "error: " + format_fixed(match.error->error_m, 2) + " m\n";
  result.text += std::to_string(stats.inliers) + " inliers of " + std::to_string(stats.frame_features) +
                 " features, against " + std::to_string(stats.map_features) + " of the map; vote " +
                 format_fixed(stats.vote_peak, 1) + ", rival " + format_fixed(stats.vote_rival, 1) + ", confidence " +
                 format_fixed(stats.confidence, 6) + "\n";
  if (options.timings) result.text += "time of matching: " + format_fixed(match.milliseconds, 1) + " ms\n";
  result.text += taken_text(frames.taken);
  result.json = {{"frame", match.frame.file},
                 {"status", frame_status_name(match)},
                 {"reason", frame_status_text(match)},
                 {"fix", fix_json(match.result.fix, match.error)},
                 {"candidate", fix_json(match.result.candidate, match.candidate_error)},
                 {"stats", stats_json(stats)},
                 {"taken", taken_json(frames.taken)}};
  if (options.timings) result.json["milliseconds"] = json_number(match.milliseconds);
  if (options.require_fix && !match.has_fix()) result.exit_code = kExitGateNotMet;
  return result;
}

CommandResult tell_flight(const MatchCommandOptions& options, const std::vector<FrameMatch>& matches,
                          const FlightFrames& frames, const std::string& output) {
  const MatchEvaluation evaluation = evaluate_matches(matches, options.correct_within_m);
  CommandResult result;
  result.text = evaluation_text(evaluation, options.timings) + taken_text(frames.taken);
  result.json = to_json(evaluation, options.timings);
  result.json["output"] = output.empty() ? Json(nullptr) : Json(output);
  result.json["taken"] = taken_json(frames.taken);
  result.warnings = frames.warnings;
  const bool no_fix_is_false = evaluation.false_fixes.of == 0;
  const bool met =
      (!options.require_fix || evaluation.accepted > 0) &&
      (!options.require_correct_rate || evaluation.correct.rate >= *options.require_correct_rate) &&
      (!options.require_false_rate || no_fix_is_false || evaluation.false_fixes.rate <= *options.require_false_rate);
  if (!met) result.exit_code = kExitGateNotMet;
  return result;
}

}  // namespace

Command make_match_command() {
  Command command;
  command.word = "match";
  command.group = CommandGroup::kFlight;
  command.summary = "Find the place of a frame, or of a whole flight, on the map";
  command.examples = {{"One frame, with what the aircraft knows.",
                       "pilotage match map.gpkg frame.jpg --prior-lon-deg 16.5 --prior-lat-deg 55.5 --prior-sigma-m 25 "
                       "--height-agl-m 120 --yaw-deg 152 --pitch-deg 1.5 --roll-deg -0.8 --camera camera.yaml"},
                      {"A logged flight; judged where the truth is in the table.",
                       "pilotage match map.gpkg --frames frames.csv --camera camera.yaml -o fixes.csv"}};
  command.inputs = {
      .name = "MAP", .help = "The map database, and the FRAME unless --frames is given.", .min = 1, .max = 2};
  command.output = {.kind = OutputKind::kFile, .help = "A table (CSV), one line for each frame.", .required = false};
  bind_options<MatchCommandOptions>(command, [](const MatchCommandOptions& options, const Invocation& invocation) {
    const bool single = invocation.inputs.size() > 1;
    if (single == !options.frames.empty()) {
      throw UsageError(single ? "FRAME and --frames exclude each other" : "FRAME is missing: a picture, or --frames");
    }
    const FlightFrames frames = single ? one_frame(options, invocation) : whole_flight(options, invocation);
    const std::vector<FrameMatch> matches = match_flight(invocation.inputs.front(), frames.frames, options.match,
                                                         options.truth, invocation.threads, invocation.progress);
    if (!invocation.output.empty()) {
      write_file(invocation.output, fix_table_to_csv(matches, options.timings), invocation.overwrite);
    }
    return single ? tell_frame(options, matches.front(), frames)
                  : tell_flight(options, matches, frames, invocation.output);
  });
  return command;
}

}  // namespace pilotage
