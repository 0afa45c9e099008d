#include "pilotage/capture/capture.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Geometry>

#include "pilotage/base/angle.h"
#include "pilotage/base/error.h"
#include "pilotage/base/nan.h"
#include "pilotage/base/statistics.h"
#include "pilotage/base/text.h"
#include "pilotage/base/utc_time.h"
#include "pilotage/capture/capture_frames.h"
#include "pilotage/capture/check_points.h"
#include "pilotage/capture/contradictions.h"
#include "pilotage/capture/control_points.h"
#include "pilotage/capture/describe_capture.h"
#include "pilotage/capture/frame_pictures.h"
#include "pilotage/capture/map_grid.h"
#include "pilotage/capture/ortho_mosaic.h"
#include "pilotage/capture/reference_ties.h"
#include "pilotage/raster/elevation.h"
#include "pilotage/raster/gdal_gray.h"
#include "pilotage/raster/map_sigma.h"
#include "pilotage/raster/mission_crs.h"

namespace pilotage {
namespace {

constexpr int kTracksPerCell = 8;
constexpr double kLongestStep_s = 30;
/// Faster than this is no flight along the frames' order, but places drawn one by one, or a clock that is none.
constexpr double kFastest_mps = 100;
constexpr double kLeastFitting = 0.5;
constexpr double kGivenFocalSigma = 0.02;
constexpr double kTagFocalSigma = 0.1;
constexpr double kDistortionSigma = 0.1;

void keep_pictures(std::vector<FramePicture>& pictures, const std::vector<int>& numbers) {
  for (std::size_t to = 0; to < numbers.size(); ++to) {
    const auto from = static_cast<std::size_t>(numbers[to]);
    if (from != to) pictures[to] = std::move(pictures[from]);
  }
  pictures.resize(numbers.size());
}

/// From where the pictures put the frames before and after, by the camera's clock.
void take_velocities(const CaptureFrames& frames, const BlockStart& start, Block& block) {
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < start.poses.size(); ++i) {
    if (!std::isnan(frames.taken_s[i])) order.push_back(i);
  }
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return frames.taken_s[a] < frames.taken_s[b]; });
  for (std::size_t k = 0; k < order.size(); ++k) {
    const std::size_t before = order[k > 0 ? k - 1 : k];
    const std::size_t after = order[k + 1 < order.size() ? k + 1 : k];
    const double step_s = frames.taken_s[after] - frames.taken_s[before];
    if (!(step_s > 0) || step_s > 2 * kLongestStep_s) continue;
    const Eigen::Vector3d velocity_mps = (start.poses[after].center_enu_m - start.poses[before].center_enu_m) / step_s;
    if (velocity_mps.norm() <= kFastest_mps) block.measured[order[k]].velocity_enu_mps = velocity_mps;
  }
}

Block make_block(const CaptureFrames& frames, const CaptureOptions& options, const LocalFrame& local) {
  Block block;
  block.camera = frames.camera;
  block.body_from_camera = body_from_camera(frames.camera.mount);
  const bool few = frames.frames.size() < kFewFrames;
  block.focal_length_sigma = few ? kHeldSigma : frames.camera_is_given ? kGivenFocalSigma : kTagFocalSigma;
  block.distortion_sigma = few ? kHeldSigma : kDistortionSigma;
  block.tilt_sigma_deg = options.tilt_sigma_deg;
  block.heading_sigma_deg = options.heading_sigma_deg;
  block.position_bias_sigma_m = options.position_bias_sigma_m;
  block.control_sigma_m = options.control_sigma_m;
  for (std::size_t i = 0; i < frames.frames.size(); ++i) {
    const FrameRecord& frame = frames.frames[i].frame;
    MeasuredPose pose;
    pose.center_enu_m << east_north_m(local, frame.prior), frames.heights_m[i];
    const double variance_m2 = frame.prior_covariance_en_m2.trace() / 2;
    pose.sigma_en_m = variance_m2 > 0 ? std::sqrt(variance_m2) : options.position_sigma_m;
    pose.sigma_up_m = options.height_sigma_m;
    Attitude attitude = frame.attitude;
    attitude.yaw_deg -= convergence_deg(local, frame.prior);
    if (std::isfinite(attitude.yaw_deg + attitude.pitch_deg + attitude.roll_deg)) {
      pose.enu_from_camera = enu_from_camera(frames.camera.mount, attitude);
    }
    block.measured.push_back(pose);
  }
  return block;
}

std::string names_of(const CaptureFrames& frames, const std::vector<int>& numbers) {
  constexpr std::size_t kShown = 6;
  std::vector<std::string> names;
  for (const int number : numbers) {
    if (names.size() == kShown && numbers.size() > kShown + 1) {
      names.push_back("and " + std::to_string(numbers.size() - kShown) + " more");
      break;
    }
    names.push_back(frames.frames[static_cast<std::size_t>(number)].frame.file);
  }
  return join(names, ", ");
}

/// Only the largest part of what is tied together can be one map: names the frames of the others.
void refuse_other_parts(const std::vector<std::vector<int>>& parts, bool leave_out, CaptureFrames& frames) {
  if (parts.front().size() == 1)
    throw DataError("no two of the frames show the same ground: " + names_of(frames, {0, 1}));
  std::vector<std::string> problems;
  for (std::size_t i = 1; i < parts.size(); ++i) {
    for (const int number : parts[i]) {
      problems.push_back(frames.frames[static_cast<std::size_t>(number)].path +
                         (parts[i].size() == 1 ? ": shows nothing that the other frames show"
                                               : ": shows the ground of " + std::to_string(parts[i].size() - 1) +
                                                     " other frames, and nothing of the largest part's"));
    }
  }
  refuse_frames(problems, leave_out, frames,
                "the frames fall apart into " + std::to_string(parts.size()) + " parts, of which the largest has " +
                    std::to_string(parts.front().size()) + " frames: " + names_of(frames, parts.front()));
}

/// The place of a frame among the ascending `numbers` of those that are kept; -1 when it is none of them.
int place_among(const std::vector<int>& numbers, int frame) {
  const auto found = std::lower_bound(numbers.begin(), numbers.end(), frame);
  return found != numbers.end() && *found == frame ? static_cast<int>(found - numbers.begin()) : -1;
}

void keep_pairs(std::vector<FramePair>& pairs, const std::vector<int>& numbers) {
  for (FramePair& pair : pairs) {
    pair.first = place_among(numbers, pair.first);
    pair.second = place_among(numbers, pair.second);
  }
  std::erase_if(pairs, [](const FramePair& pair) { return pair.first < 0 || pair.second < 0; });
}

/// Points without a mark that is kept go, too.
void keep_marks(std::vector<ControlPoint>& points, const std::vector<int>& numbers) {
  for (ControlPoint& point : points) {
    for (ControlPoint::Mark& mark : point.marks) mark.frame = place_among(numbers, mark.frame);
    std::erase_if(point.marks, [](const ControlPoint::Mark& mark) { return mark.frame < 0; });
  }
  std::erase_if(points, [](const ControlPoint& point) { return point.marks.empty(); });
}

/// "2016:06:23 16:32:13", as TIFF has it.
std::string tiff_time(double taken_s) {
  const auto moment = UtcTime(std::chrono::seconds(static_cast<std::int64_t>(taken_s)));
  std::string text = format_utc_time(moment);  // 2016-06-23T16:32:13Z
  text[4] = text[7] = ':';
  text[10] = ' ';
  text.pop_back();
  return text;
}

/// Beside the map: how far it may be off, which frame it is of, and how many frames see it.
void write_map_sigma(const OutputFile& output, const OrthoMosaic& mosaic, const MosaicStats& stats,
                     CaptureResult& result) {
  GeoTransform map_from_cell = mosaic.map_from_pixel;
  for (double* step :
       {&map_from_cell.x_per_col, &map_from_cell.x_per_row, &map_from_cell.y_per_col, &map_from_cell.y_per_row}) {
    *step *= kMapCell_px;
  }
  write_score_raster(output,
                     {{"map_sigma", "m", stats.map_sigma_m},
                      {"frame", "", stats.cell_frame},
                      {"frames_seen", "", stats.cell_frames_seen}},
                     mosaic.crs, map_from_cell, true);
  const std::vector<double> sigmas_m = known_values(stats.map_sigma_m);
  const std::vector<double> seen = known_values(stats.cell_frames_seen);
  result.frames_seen_median = quantile(seen, 0.5);
  result.seen_by_three =
      static_cast<double>(std::count_if(seen.begin(), seen.end(), [](double count) { return count >= 3; })) /
      static_cast<double>(seen.size());
  result.map_sigma_median_m = quantile(sigmas_m, 0.5);
  result.map_sigma_p95_m = quantile(sigmas_m, 0.95);
}

/// A block of which hardly half fits together is of another camera than is said.
void refuse_misfit(const CaptureFrames& frames, const AdjustedBlock& adjusted) {
  const double fitting = static_cast<double>(adjusted.sightings) / static_cast<double>(adjusted.sightings_before);
  if (fitting >= kLeastFitting) return;
  throw DataError("only " + format_fixed(100 * fitting, 0) + " % of what the frames have in common fits together; " +
                  "is the camera (" + frames.camera_source + ") right?");
}

/// Of a list of points; none without one.
std::vector<ControlPoint> read_points(const std::string& list, const std::string& kind, const CaptureFrames& frames,
                                      const LocalFrame& local, CaptureResult& result) {
  if (list.empty()) return {};
  std::vector<std::string> paths;
  for (const FlightFrame& one : frames.frames) paths.push_back(one.path);
  int unused_marks = 0;
  std::vector<ControlPoint> points = read_control_points(list, paths, local, unused_marks);
  if (unused_marks > 0) {
    result.warnings.push_back(std::to_string(unused_marks) + " marks of " + kind +
                              " points are in pictures that are not among the frames");
  }
  return points;
}

/// What a map is made of, beside the frames.
struct MapParts {
  EastNorthBounds bounds;
  GroundSurface ground;
  double frame_gsd_m = 0;
  ColorBalance balance;
};

MapParts parts_of_map(const GroundPrior& prior, const std::optional<Elevation>& elevation,
                      const std::vector<FramePicture>& pictures, const AdjustedBlock& adjusted) {
  const EastNorthBounds bounds = shown_bounds(adjusted);
  const auto& [low, high] = bounds;
  MapParts parts{bounds,
                 elevation ? sample_surface(prior, elevation->resolution_m(), adjusted.points, low, high)
                           : fit_surface(adjusted.points, low, high),
                 0,
                 {}};
  parts.frame_gsd_m = median_agl_m(adjusted, parts.ground) / adjusted.camera.fx_px;
  parts.balance = balance_colors(pictures, adjusted);
  return parts;
}

OrthoMosaic mosaic_of(const CaptureFrames& frames, const AdjustedBlock& adjusted, const MapParts& parts,
                      const LocalFrame& local, const Crs& crs, double gsd_m) {
  OrthoMosaic mosaic{&adjusted, &parts.ground, &parts.balance, local, {}, 0, 0, crs, {}, gsd_m};
  mosaic.load = [&](std::size_t i) { return read_rgb8_picture(frames.frames[i].path); };
  place_grid(mosaic, parts.bounds);
  return mosaic;
}

}  // namespace

CaptureResult capture(const std::vector<std::string>& inputs, const CaptureOptions& options, const OutputFile& ortho,
                      const OutputFile& map_sigma, int threads, const Progress& progress) {
  check_map_options(options);
  std::optional<MatchFolder> folder;
  if (!options.matches.empty()) folder.emplace(options.matches);
  MatchFolder* const kept = folder ? &*folder : nullptr;
  CaptureFrames frames = read_capture_frames(inputs, options);
  const LocalFrame local = local_frame(frames);
  CaptureResult result;
  result.frames_given = static_cast<std::int64_t>(frames.frames.size() + frames.left_out.size());
  std::vector<ControlPoint> control_points = read_points(options.control_points, "control", frames, local, result);
  std::vector<ControlPoint> checks = read_points(options.check_points, "check", frames, local, result);
  refuse_adjusted_checks(checks, control_points);
  const std::size_t checks_given = checks.size();
  std::optional<Elevation> elevation;
  GroundPrior prior;
  if (!options.elevation.empty()) {
    elevation.emplace(options.elevation);
    std::vector<GeodeticPoint> nadirs;
    for (const FlightFrame& one : frames.frames) nadirs.push_back(one.frame.prior);
    for (const UndeclaredVoid& found : elevation->undeclared_voids(nadirs)) {
      result.warnings.push_back(undeclared_void_text(options.elevation, found));
    }
    prior.height_m = [&](const Eigen::Vector2d& en_m) { return elevation->amsl_m(point_at(local, en_m)); };
  }
  ImageryInfo reference;
  if (!options.align.empty()) {
    std::vector<GeodeticPoint> priors;
    for (const FlightFrame& one : frames.frames) priors.push_back(one.frame.prior);
    reference = inspect_reference(options, priors, progress);
  }
  std::vector<std::string> problems;
  std::vector<FramePicture> pictures =
      read_pictures(frames, all_numbers(frames.frames.size()), kept, threads, progress, problems);
  refuse_frames(problems, options.leave_out, frames);
  const std::vector<int> can_be_read = readable(pictures);
  keep_frames(frames, can_be_read);
  keep_pictures(pictures, can_be_read);
  keep_marks(control_points, can_be_read);
  keep_marks(checks, can_be_read);

  std::vector<FramePair> pairs =
      match_pairs(neighbouring_frames(nadirs_en_m(frames, local)), pictures, kept, threads, progress);
  if (folder && !folder->warning().empty()) result.warnings.push_back(folder->warning());
  auto parts = tied_parts(pairs, static_cast<int>(frames.frames.size()));
  Block block;
  BlockStart start;
  AdjustedBlock adjusted;
  const auto adjust = [&] {
    return adjust_block(block, start, join_tracks(block.pairs, block.features, kTracksPerCell), prior, threads,
                        progress);
  };
  // What hangs together by matches may fall apart when they are held against each other: then once more without it.
  for (;;) {
    if (parts.size() > 1) {
      refuse_other_parts(parts, options.leave_out, frames);
      keep_pairs(pairs, parts.front());
      keep_marks(control_points, parts.front());
      keep_marks(checks, parts.front());
      keep_frames(frames, parts.front());
      keep_pictures(pictures, parts.front());
    }
    block = make_block(frames, options, local);
    block.features = features_of(pictures);
    block.pairs = pairs;
    block.control_points = control_points;
    start = start_block(block);
    take_velocities(frames, start, block);
    adjusted = adjust();
    parts = tied_parts(shared_points(adjusted), static_cast<int>(frames.frames.size()));
    if (parts.size() == 1) break;
  }
  refuse_misfit(frames, adjusted);
  const Contradictions contradictions = find_contradictions(frames, block, start, adjusted);
  refuse_frames(contradictions.problems, options.leave_out, frames);
  result.warnings.insert(result.warnings.end(), contradictions.warnings.begin(), contradictions.warnings.end());

  MapParts map_parts = parts_of_map(prior, elevation, pictures, adjusted);
  refuse_control_contradictions(frames, block, adjusted, map_parts.frame_gsd_m);
  const double gsd_m = map_gsd_m(options, map_parts.frame_gsd_m);
  const MissionCrs crs = map_crs(options, local, map_parts.bounds);
  if (!options.align.empty()) {
    const OrthoMosaic first = mosaic_of(frames, adjusted, map_parts, local, crs.crs, gsd_m);
    result.alignment = tie_to_reference(first, options, reference, ortho, threads, progress, block);
    do {
      adjusted = adjust();
    } while (loosen_ties(adjusted, *result.alignment, block));
    refuse_misfit(frames, adjusted);
    map_parts = parts_of_map(prior, elevation, pictures, adjusted);
    refuse_control_contradictions(frames, block, adjusted, map_parts.frame_gsd_m);
  }
  const OrthoMosaic mosaic = mosaic_of(frames, adjusted, map_parts, local, crs.crs, gsd_m);

  describe_frames(frames, block, adjusted, map_parts.ground, map_parts.bounds, local, contradictions, result);
  describe_block(frames, block, adjusted, result);
  std::vector<std::pair<std::string, std::string>> metadata;
  for (const double taken_s : frames.taken_s) {
    if (!(taken_s > 1e8 && taken_s < 4e9)) continue;  // a table's own clock
    metadata.emplace_back("TIFFTAG_DATETIME", tiff_time(taken_s));
    break;
  }
  metadata.emplace_back(kMapSigmaTag, map_sigma.destination().filename().string());
  const MosaicStats stats = write_mosaic(ortho, mosaic, metadata, threads, progress);
  write_map_sigma(map_sigma, mosaic, stats, result);
  result.check_points = check_map(checks, frames, mosaic, stats);
  describe_checks(checks_given, result);
  if (result.alignment) {
    result.alignment->after = audit_against_reference(ortho, options, threads, progress);
    describe_alignment(result);
  }
  for (std::size_t i = 0; i < stats.frame_px.size(); ++i) result.frames[i].drawn_px = stats.frame_px[i];
  result.left_out = frames.left_out;
  result.assumptions =
      assumptions_of(frames, block, elevation ? elevation->vertical_datum() : "", result, options.registration);
  result.ground = elevation ? "elevation model " + options.elevation : "a smooth surface through the points seen";
  result.ground_spread_m = map_parts.ground.spread_m;
  result.gsd_m = mosaic.gsd_m;
  result.width_px = mosaic.width_px;
  result.height_px = mosaic.height_px;
  result.crs = mosaic.crs.name();
  result.area_m2 = static_cast<double>(stats.valid_px) * mosaic.gsd_m * mosaic.gsd_m;
  result.warnings.insert(result.warnings.end(), frames.notes.begin(), frames.notes.end());
  return result;
}

}  // namespace pilotage
