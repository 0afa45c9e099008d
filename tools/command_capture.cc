#include <cmath>
#include <filesystem>
#include <optional>

#include "commands.h"
#include "spread_output.h"
#include "version.h"

#include "pilotage/base/csv.h"
#include "pilotage/base/error.h"
#include "pilotage/base/json_object.h"
#include "pilotage/base/options_json.h"
#include "pilotage/base/output_file.h"
#include "pilotage/base/shard.h"
#include "pilotage/base/text.h"
#include "pilotage/capture/capture.h"
#include "pilotage/capture/match_shard.h"
#include "pilotage/capture/quality_page.h"
#include "pilotage/raster/map_sigma.h"

namespace pilotage {
namespace {

struct CaptureCommandOptions {
  CaptureOptions capture;
  std::string log;
  std::string camera_log;
  std::string quality;
  std::string shard;

  template <class Self, class Fields>
  static void describe(Self& self, Fields& fields) {
    CaptureOptions::describe(self.capture, fields);
    fields.path("log", self.log,
                "Also write the frames with their adjusted attitude and place, as a table that match and score take "
                "(frames.csv).");
    fields.path(
        "camera_log", self.camera_log,
        "Also write the camera as adjusted, as ROS camera_info (YAML): the table's heights are those of this one.");
    fields.path("quality", self.quality,
                "Also write a page on how good the map is: error, overlap, frames, shifts, check points (HTML).");
    fields.field(
        "shard", self.shard,
        "Make no map, but match a part of the pairs into the folder of matches, for one of several machines: "
        "3/16 is the third of 16 shards; auto/16 as `pilotage score` has it. Which frames there are is said by "
        "the options of the camera and leave_out; those of the map alone are only checked.");
  }
};

/// schemas/frames-csv.md. Priors are the measured places; the adjusted ones stand as truth.
std::string frames_table(const CaptureResult& done, const std::string& log) {
  const std::filesystem::path folder = std::filesystem::absolute(log).parent_path();
  std::string table =
      "file,time_s,prior_lon_deg,prior_lat_deg,prior_sigma_m,height_agl_m,yaw_deg,pitch_deg,roll_deg,"
      "true_nadir_lon_deg,true_nadir_lat_deg\n";
  for (const CapturedFrame& frame : done.frames) {
    const std::string path = std::filesystem::absolute(frame.path).lexically_relative(folder).generic_string();
    const double time_s = std::isnan(frame.time_s) ? static_cast<double>(&frame - done.frames.data()) : frame.time_s;
    table += csv_cell(path) + "," + format_fixed(time_s, 3);
    for (const double degrees : {frame.measured.lon_deg, frame.measured.lat_deg})
      table += "," + format_fixed(degrees, 9);
    table += "," + format_fixed(frame.measured_sigma_m, 3) + "," +
             (std::isnan(frame.agl_m) ? "" : format_fixed(frame.agl_m, 3));
    for (const double degrees : {frame.yaw_deg, frame.pitch_deg, frame.roll_deg})
      table += "," + format_fixed(degrees, 4);
    for (const double degrees : {frame.adjusted.lon_deg, frame.adjusted.lat_deg})
      table += "," + format_fixed(degrees, 9);
    table += "\n";
  }
  return table;
}

/// As camera_file.h reads it: the first pixel's centre is at 0.
std::string camera_yaml(const Camera& camera) {
  const auto numbers = [](const std::vector<double>& values) {
    std::vector<std::string> texts;
    for (const double value : values) texts.push_back(format_number(value));
    return "[" + join(texts, ", ") + "]";
  };
  return "image_width: " + std::to_string(camera.width_px) + "\nimage_height: " + std::to_string(camera.height_px) +
         "\ncamera_name: captured\ncamera_matrix:\n  rows: 3\n  cols: 3\n  data: " +
         numbers({camera.fx_px, 0, camera.cx_px - 0.5, 0, camera.fy_px, camera.cy_px - 0.5, 0, 0, 1}) +
         "\ndistortion_model: plumb_bob\ndistortion_coefficients:\n  rows: 1\n  cols: 5\n  data: " +
         numbers({camera.distortion.begin(), camera.distortion.end()}) + "\n";
}

/// The map against the one it was tied to.
nlohmann::ordered_json audit_json(const MapAudit& audit) {
  return {{"compared", audit.compared},
          {"median_shift_m", {json_number(audit.median_shift_en_m.x()), json_number(audit.median_shift_en_m.y())}},
          {"shift_m", spread_json(audit.shift_m)},
          {"about_median_m", spread_json(audit.about_median_m)}};
}

nlohmann::ordered_json alignment_json(const std::optional<MapAlignment>& alignment) {
  if (!alignment) return nullptr;
  return {{"reference", alignment->reference},
          {"reference_sigma_m", alignment->reference_sigma_m},
          {"reference_sigma_is", options_detail::enum_to_name(alignment->sigma_source)},
          {"counted_sigma_m", alignment->counted_sigma_m},
          {"ties", alignment->ties},
          {"tie_rms_m", alignment->tie_rms_m},
          {"before", audit_json(alignment->before)},
          {"after", audit_json(alignment->after)}};
}

nlohmann::ordered_json checks_json(const CaptureResult& done) {
  if (done.check_points.empty()) return nullptr;
  nlohmann::ordered_json points = nlohmann::ordered_json::array();
  for (const CheckedPoint& one : done.check_points) {
    points.push_back({{"name", one.name},
                      {"file", one.file},
                      {"miss_east_m", one.miss_east_m},
                      {"miss_north_m", one.miss_north_m},
                      {"is_shown", one.is_shown},
                      {"map_sigma_m", json_number(one.map_sigma_m)}});
  }
  return {{"rms_m", done.check_rms_m}, {"ratio", json_number(done.check_ratio)}, {"points", std::move(points)}};
}

std::string audit_text(const MapAudit& audit) {
  if (audit.compared_m2 == 0) return "cannot be compared";
  return format_fixed(audit.median_shift_en_m.x(), 2) + " m east, " + format_fixed(audit.median_shift_en_m.y(), 2) +
         " m north (medians); its length " + spread_text(audit.shift_m) + "; " + format_fixed(100 * audit.compared, 0) +
         " % of the common ground compared";
}

nlohmann::ordered_json result_json(const CaptureResult& done, const std::string& output) {
  nlohmann::ordered_json frames = nlohmann::ordered_json::array();
  for (const CapturedFrame& frame : done.frames) {
    frames.push_back({{"file", frame.file},
                      {"lon_deg", frame.adjusted.lon_deg},
                      {"lat_deg", frame.adjusted.lat_deg},
                      {"agl_m", json_number(frame.agl_m)},
                      {"yaw_deg", frame.yaw_deg},
                      {"pitch_deg", frame.pitch_deg},
                      {"roll_deg", frame.roll_deg},
                      {"residual_east_m", frame.residual_east_m},
                      {"residual_north_m", frame.residual_north_m},
                      {"residual_up_m", frame.residual_up_m},
                      {"sightings", frame.sightings},
                      {"reprojection_rms_px", json_number(frame.rms_px)},
                      {"drawn_px", frame.drawn_px}});
  }
  return {{"output", output},
          {"gsd_m", done.gsd_m},
          {"width_px", done.width_px},
          {"height_px", done.height_px},
          {"crs", done.crs},
          {"area_m2", done.area_m2},
          {"map_sigma",
           {{"file", map_sigma_path(output).string()},
            {"median_m", json_number(done.map_sigma_median_m)},
            {"p95_m", json_number(done.map_sigma_p95_m)}}},
          {"frames_given", done.frames_given},
          {"frames_seen", {{"median", done.frames_seen_median}, {"by_three", done.seen_by_three}}},
          {"pairs", done.pairs},
          {"points", done.points},
          {"sightings", done.sightings},
          {"sightings_found", done.sightings_found},
          {"reprojection_rms_px", done.reprojection_rms_px},
          {"position_rms_m", done.position_rms_m},
          {"position_ratio", done.position_ratio},
          {"contradicted_positions", done.contradicted_positions},
          {"camera",
           {{"source", done.camera_source},
            {"given_focal_length_px", done.given_focal_length_px},
            {"focal_length_px", done.camera.fx_px},
            {"k1", done.camera.distortion[0]},
            {"k2", done.camera.distortion[1]},
            {"boresight_deg", {done.boresight_x_deg, done.boresight_y_deg, done.boresight_z_deg}},
            {"clock_offset_s", done.clock_offset_s}}},
          {"control_points", done.control_points},
          {"control_rms_m", json_number(done.control_rms_m)},
          {"position_bias_m", {done.bias_east_m, done.bias_north_m}},
          {"check_points", checks_json(done)},
          {"alignment", alignment_json(done.alignment)},
          {"ground", done.ground},
          {"ground_spread_m", done.ground_spread_m},
          {"left_out", done.left_out},
          {"assumptions", done.assumptions},
          {"frames", frames}};
}

std::string result_text(const CaptureResult& done, const std::string& output) {
  std::string text = output + ": " + std::to_string(done.width_px) + " x " + std::to_string(done.height_px) +
                     " pixels of " + format_number(done.gsd_m) + " m, " + format_fixed(done.area_m2 / 1e4, 2) +
                     " ha, " + done.crs + "\n";
  text += "the map's own error, each axis, modelled: " + format_fixed(done.map_sigma_median_m, 2) + " m (median), " +
          format_fixed(done.map_sigma_p95_m, 2) + " m (95 %); " + map_sigma_path(output).string() + "\n";
  text += std::to_string(done.frames.size()) + " frames, " + std::to_string(done.pairs) + " pairs, " +
          std::to_string(done.points) + " points; reprojection error " + format_fixed(done.reprojection_rms_px, 2) +
          " px over " + std::to_string(done.sightings) + " of " + std::to_string(done.sightings_found) + " sightings\n";
  text += "frames' positions: " + format_fixed(done.position_rms_m, 2) + " m RMS from where the pictures put them\n";
  text += "camera: focal length " + format_fixed(done.camera.fx_px, 1) + " px (" + done.camera_source + ": " +
          format_fixed(done.given_focal_length_px, 1) + "), k1 " + format_fixed(done.camera.distortion[0], 4) +
          ", k2 " + format_fixed(done.camera.distortion[1], 4) + "\n";
  if (done.control_points > 0) {
    text += std::to_string(done.control_points) + " control points: " + format_fixed(done.control_rms_m, 3) +
            " m RMS; frames' positions shifted by " + format_fixed(done.bias_east_m, 2) + " m east, " +
            format_fixed(done.bias_north_m, 2) + " m north\n";
  }
  if (!done.check_points.empty()) {
    text += std::to_string(done.check_points.size()) + " check points: the map misses them by " +
            format_fixed(done.check_rms_m, 2) + " m RMS, each axis, " + format_fixed(done.check_ratio, 1) +
            " times what it says of itself there; measured\n";
  }
  if (done.alignment) {
    const MapAlignment& alignment = *done.alignment;
    text += "tied to " + alignment.reference + " (" + std::to_string(alignment.ties) +
            " ties); the map less that one, before: " + audit_text(alignment.before) + "\n";
    text += "  after: " + audit_text(alignment.after) + "; ties miss by " + format_fixed(alignment.tie_rms_m, 2) +
            " m, each axis\n";
  }
  text += "ground: " + done.ground + ", points lie " + format_fixed(done.ground_spread_m, 2) + " m from it\n";
  for (const std::string& one : done.assumptions) text += "assumes: " + one + "\n";
  for (const std::string& one : done.left_out) text += "left out: " + one + "\n";
  return text;
}

/// What is of the map is made by the run without --shard.
CommandResult run_shard(const CaptureCommandOptions& options, const Invocation& invocation) {
  const std::pair<const char*, bool> given[] = {{"-o", !invocation.output.empty()},
                                                {"--log", !options.log.empty()},
                                                {"--camera-log", !options.camera_log.empty()},
                                                {"--quality", !options.quality.empty()}};
  for (const auto& [flag, is_given] : given) {
    if (is_given)
      throw UsageError(std::string(flag) + " does not go with --shard; give it to the run that makes the map");
  }
  const Shard shard = parse_shard(options.shard, environment_of_process);
  const MatchedShard done =
      match_shard(invocation.inputs, options.capture, shard, invocation.threads, invocation.progress);
  CommandResult result;
  result.text = "shard " + std::to_string(shard.number) + "/" + std::to_string(shard.count) + ": " +
                std::to_string(done.pairs) + " of " + std::to_string(done.pairs_in) + " pairs, of " +
                std::to_string(done.frames) + " frames; " + std::to_string(done.in_common) +
                " show ground in common: " + options.capture.matches + "\n";
  for (const std::string& one : done.left_out) result.text += "left out: " + one + "\n";
  result.json = {{"shard", shard.number},
                 {"shards", shard.count},
                 {"pairs", done.pairs},
                 {"pairs_in", done.pairs_in},
                 {"in_common", done.in_common},
                 {"frames", done.frames},
                 {"folder", options.capture.matches},
                 {"left_out", done.left_out}};
  result.warnings = done.warnings;
  return result;
}

CommandResult run_capture(const CaptureCommandOptions& options, const Invocation& invocation) {
  if (!options.shard.empty()) return run_shard(options, invocation);
  if (invocation.output.empty()) throw UsageError("-o OUTPUT is missing: where the map goes");
  OutputFile ortho(invocation.output, invocation.overwrite);
  std::optional<OutputFile> log;
  if (!options.log.empty()) log.emplace(options.log, invocation.overwrite);
  const OutputFile map_sigma(map_sigma_path(invocation.output), invocation.overwrite);
  const CaptureResult done =
      capture(invocation.inputs, options.capture, ortho, map_sigma, invocation.threads, invocation.progress);
  std::vector<const OutputFile*> outputs{&map_sigma};
  if (log) {
    log->write(frames_table(done, options.log));
    outputs.push_back(&*log);
  }
  std::optional<OutputFile> quality;
  if (!options.quality.empty()) {
    CaptureCommandOptions described = options;
    const nlohmann::ordered_json parameters = options_to_json(list_options(described));
    quality.emplace(options.quality, invocation.overwrite)
        .write(quality_page_html(done,
                                 {std::filesystem::path(invocation.output).filename().string(),
                                  ortho.temporary_path().string(), map_sigma.temporary_path().string()},
                                 parameters, version_line()));
    outputs.push_back(&*quality);
  }
  std::optional<OutputFile> camera;
  if (!options.camera_log.empty()) {
    camera.emplace(options.camera_log, invocation.overwrite).write(camera_yaml(done.camera));
    outputs.push_back(&*camera);
  }
  outputs.push_back(&ortho);
  OutputFile::commit(outputs, {});
  CommandResult result;
  result.text = result_text(done, invocation.output);
  result.json = result_json(done, invocation.output);
  result.warnings = done.warnings;
  return result;
}

}  // namespace

Command make_capture_command() {
  Command command;
  command.word = "capture";
  command.group = CommandGroup::kPrepare;
  command.summary = "Make a reference map of the frames of a flight";
  command.examples = {
      {"The photos of a drone; positions and camera are in their tags.", "pilotage capture photos/ -o reference.tif"},
      {"A camera and an elevation model of one's own, and the adjusted frames as a table.",
       "pilotage capture frames.csv --camera camera.yaml --elevation dem.tif --log adjusted.csv -o "
       "reference.tif"},
      {"Tied to the satellite's map, which lies to within 2 m.",
       "pilotage capture photos/ --align satellite.tif --align-sigma-m 2 --quality quality.html -o reference.tif"},
      {"Matched in 16 parts, for as many machines; then the map.",
       "pilotage capture photos/ --matches parts --shard 3/16"}};
  command.inputs = {
      .name = "FRAMES", .help = "Pictures, folders of them, or one frames.csv.", .min = 1, .max = InputSpec::kMany};
  command.output = {
      .kind = OutputKind::kFile,
      .help =
          "The map: a Cloud-Optimised GeoTIFF. Beside it, its own error: reference.map_sigma.tif. Not with "
          "--shard.",
      .required = false,
      .flags = {"log", "camera-log", "quality", "matches"},
      .files =
          [](const std::string& output) {
            return std::vector<std::filesystem::path>{output, map_sigma_path(output)};
          },
  };
  command.reads_rasters = true;
  bind_options<CaptureCommandOptions>(command, run_capture);
  return command;
}

}  // namespace pilotage
