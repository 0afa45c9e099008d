#include "pilotage/simulate/rendered_fixes.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <mutex>
#include <utility>

#include <Eigen/LU>
#include <nlohmann/json.hpp>

#include "pilotage/base/angle.h"
#include "pilotage/base/error.h"
#include "pilotage/base/parallel.h"
#include "pilotage/geo/local_frame.h"
#include "pilotage/match/position_measurement.h"
#include "pilotage/simulate/degraded_frame.h"
#include "pilotage/simulate/flight_streams.h"

namespace pilotage {
namespace {

/// A frame that shows less of the imagery is none: the aircraft would see ground that nobody has.
constexpr double kLeastSeen = 0.9;
constexpr double kLeastAgl_m = 1;
/// As the filter that flies: what must be left of a fix's standard deviation without the map's (navigation_filter.h).
constexpr double kLeastNoise = 1e-3;

double wrapped_deg(double angle_deg) {
  return angle_deg - 360 * std::floor(angle_deg / 360);
}

std::string padded(std::size_t number) {
  const std::string text = std::to_string(number);
  return std::string(6 - std::min<std::size_t>(6, text.size()), '0') + text;
}

/// Whether a filter can take it.
bool is_noise(const Eigen::Matrix2d& noise_m2, const Eigen::Matrix2d& with_map_m2) {
  return noise_m2.allFinite() && noise_m2(0, 0) > 0 && noise_m2.determinant() > 0 &&
         smallest_sigma_m(noise_m2) > kLeastNoise * smallest_sigma_m(with_map_m2);
}

}  // namespace

struct RenderedRun {
  const Mission& mission;
  const SimulateOptions& simulate;
  const RenderedOptions& options;
  FrameSource frames;
  OpenMaps open_maps;

  /// What a thread keeps.
  struct Worker {
    std::vector<MapReader> maps;
    FrameTaker taker;
  };
  std::vector<std::unique_ptr<Worker>> workers;
  std::vector<std::vector<SimulatedTry>> tries;  ///< Of each flight.

  Worker& worker(int number) {
    std::unique_ptr<Worker>& own = workers[static_cast<std::size_t>(number)];
    if (!own) own = std::make_unique<Worker>(Worker{open_maps(), frames.open()});
    return *own;
  }
};

namespace {

/// One flight's tries: what is constant over it, and how a try is answered.
class RenderedFlight {
 public:
  RenderedFlight(std::shared_ptr<RenderedRun> run, std::size_t flight, std::uint64_t seed, int worker,
                 std::function<bool()> go_on)
      : run_(std::move(run)),
        flight_(flight),
        worker_(worker),
        go_on_(std::move(go_on)),
        frames_seed_(flight_stream_seed(seed, FlightStream::kFrames)),
        dropped_frames_(run_->simulate.dropped_frames.value_or(run_->mission.flight.conditions.dropped_frames)),
        degrader_(std::make_shared<FrameDegrader>(run_->options.degradation, frames_seed_)) {
    Random random(frames_seed_);
    const double sigma_deg = run_->options.boresight_sigma_deg;
    boresight_.yaw_deg = sigma_deg * random.normal();
    boresight_.pitch_deg = sigma_deg * random.normal();
    boresight_.roll_deg = sigma_deg * random.normal();
    height_told_ = std::max(0.1, 1 + run_->options.altimeter_sigma * random.normal());
  }

  TriedFix operator()(const FixTry& tried) {
    const RenderedOptions& options = run_->options;
    Random random(derive_seed(frames_seed_, 1 + tried.sample));
    const double pitch_deg = options.tilt_sigma_deg * random.normal();
    const double roll_deg = options.tilt_sigma_deg * random.normal();
    if (random.uniform() < dropped_frames_) return {false, std::nullopt};
    auto& worker = run_->worker(worker_);
    const std::optional<CameraPose> pose =
        true_pose(tried, {wrapped_deg(tried.heading_deg), pitch_deg, roll_deg}, worker.taker);
    if (!pose) return {false, std::nullopt};
    CameraPose seen_from = *pose;
    seen_from.attitude.yaw_deg += boresight_.yaw_deg;
    seen_from.attitude.pitch_deg += boresight_.pitch_deg;
    seen_from.attitude.roll_deg += boresight_.roll_deg;
    RenderedFrame frame = worker.taker.frame_at(seen_from);
    if (frame.valid_fraction < kLeastSeen) return {false, std::nullopt};
    if (run_->frames.of_the_map) degrader_->apply(frame.gray);
    blur_by_motion(frame.gray,
                   motion_in_image(run_->frames.camera, seen_from, options.exposure_ms / 1000 * tried.over_ground_mps));

    SimulatedTry done = begin_try(tried, *pose);
    const MatchPrior prior{done.match.frame.prior, done.match.frame.prior_covariance_en_m2,
                           done.match.frame.height_agl_m, done.match.frame.attitude};
    const auto start = std::chrono::steady_clock::now();
    done.match.result = match(frame.gray, prior, run_->frames.camera, pointers_to(worker.maps), options.match, go_on_);
    done.match.milliseconds =
        std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
    require_frame_was_tried(done.match.result, names_of(worker.maps));
    set_errors(done.match);
    const TriedFix answer{true, offered(done.match, prior)};
    run_->tries[flight_].push_back(std::move(done));
    return answer;
  }

 private:
  /// Nothing where the aircraft would be in the ground.
  std::optional<CameraPose> true_pose(const FixTry& tried, const Attitude& attitude, const FrameTaker& taker) const {
    const FlightSample& line = run_->mission.flight.samples[tried.sample];
    CameraPose pose;
    pose.position = LocalFrame(line.point).geodetic_from_enu({tried.off_line_m.x(), tried.off_line_m.y(), 0});
    pose.attitude = attitude;
    pose.height_agl_m = line.agl_m;
    // The height of the line is held: beside it the ground is another.
    const double ground_m = taker.ground_amsl_m(pose.position);
    const double rise_m =
        ground_m - (run_->frames.heights_of_the_map ? taker.ground_amsl_m(line.point) : line.amsl_m - line.agl_m);
    if (std::isfinite(rise_m)) {
      pose.height_agl_m -= rise_m;
      pose.height_amsl_m = ground_m + pose.height_agl_m;
    }
    if (!(pose.height_agl_m >= kLeastAgl_m)) return std::nullopt;
    return pose;
  }

  /// Truth and belief of a try, before it is answered.
  SimulatedTry begin_try(const FixTry& tried, const CameraPose& pose) const {
    SimulatedTry done;
    done.flight = static_cast<std::int64_t>(flight_);
    done.sample = tried.sample;
    done.pose = pose;
    if (tried.below) {
      done.below_tile_id = run_->mission.ground.tiles[*tried.below].tile_id;
      done.below_p = tried.below_p;
    }
    const DrawnErrors& drawn = *tried.drawn;
    FrameRecord& frame = done.match.frame;
    frame.file = "flight_" + padded(flight_) + "/sample_" + padded(tried.sample);
    frame.time_s = tried.time_s;
    frame.true_nadir = pose.position;
    // By the map, as the filter that flies says it: where the map is off, so is the place that it expects.
    const Eigen::Vector2d error_m = fix_by_map() * drawn.errors;
    frame.prior = LocalFrame(pose.position).geodetic_from_enu({error_m.x(), error_m.y(), 0});
    frame.prior_covariance_en_m2 = innovation_covariance(drawn, Eigen::Matrix2d::Zero());
    frame.height_agl_m = pose.height_agl_m * height_told_;
    frame.attitude = believed(pose.attitude, drawn);
    return done;
  }

  /// The attitude with the filter's errors: where the vertical that it computes leans ahead, the nose seems raised.
  static Attitude believed(Attitude attitude, const DrawnErrors& drawn) {
    const double yaw_rad = attitude.yaw_deg * kRadPerDeg;
    const Eigen::Vector2d lean = drawn.errors.segment<2>(InsState::kTilt) / kRadPerDeg;
    attitude.pitch_deg += lean.x() * std::sin(yaw_rad) + lean.y() * std::cos(yaw_rad);
    attitude.roll_deg -= lean.x() * std::cos(yaw_rad) - lean.y() * std::sin(yaw_rad);
    attitude.yaw_deg = wrapped_deg(attitude.yaw_deg + drawn.errors[InsState::kHeading] / kRadPerDeg);
    return attitude;
  }

  /// What the filter is offered of an answer, as the filter that flies takes it.
  std::optional<OfferedFix> offered(const FrameMatch& match, const MatchPrior& prior) const {
    if (!match.result.fix || !match.error) return std::nullopt;
    const PositionMeasurement measured = without_prior(*match.result.fix, prior);
    OfferedFix fix;
    fix.noise_m2 = measured.covariance_en_m2 - isotropic_covariance_m2(measured.map_sigma_m);
    if (!is_noise(fix.noise_m2, measured.covariance_en_m2)) return std::nullopt;
    fix.innovation_m = -LocalFrame(prior.position).enu_from_geodetic(measured.position).head<2>();
    fix.right = match.error->error_m <= run_->options.correct_within_m;
    return fix;
  }

  std::shared_ptr<RenderedRun> run_;
  std::size_t flight_;
  int worker_;
  std::function<bool()> go_on_;
  std::uint64_t frames_seed_;
  double dropped_frames_;
  std::shared_ptr<FrameDegrader> degrader_;
  Attitude boresight_;
  double height_told_ = 1;
};

}  // namespace

RenderedFixes::RenderedFixes(const Mission& mission, const SimulateOptions& simulate, const RenderedOptions& options,
                             FrameSource frames, OpenMaps open_maps, int threads)
    : run_(std::make_shared<RenderedRun>(
          RenderedRun{mission, simulate, options, std::move(frames), std::move(open_maps), {}, {}})) {
  check_options(options);
  if (options.match.deadline_ms) {
    throw UsageError("match_deadline_ms: what is simulated must not depend on how fast this machine is");
  }
  run_->workers.resize(static_cast<std::size_t>(thread_count(threads)));
  run_->tries.resize(static_cast<std::size_t>(simulate.flights));
}

FixSource RenderedFixes::source() {
  FixSource source;
  source.begin_flight = [run = run_](std::size_t flight, std::uint64_t seed, int worker,
                                     const std::function<bool()>& go_on) -> FlightFixes {
    return RenderedFlight(run, flight, seed, worker, go_on);
  };
  source.draws_map_error = run_->frames.of_the_map;
  source.notes = run_->frames.notes;
  source.not_simulated = run_->frames.not_simulated;
  return source;
}

std::vector<SimulatedTry> RenderedFixes::take_tries() {
  std::vector<SimulatedTry> all;
  for (std::vector<SimulatedTry>& flight : run_->tries) {
    for (SimulatedTry& tried : flight) all.push_back(std::move(tried));
    flight.clear();
  }
  return all;
}

Camera rendered_camera(const Mission& mission, const RenderedOptions& options) {
  const Camera& camera = mission.flight.camera;
  if (camera.width_px <= options.frame_width_px) return camera;
  const double share = static_cast<double>(options.frame_width_px) / camera.width_px;
  return resized_camera(camera, options.frame_width_px,
                        std::max(1, static_cast<int>(std::lround(share * camera.height_px))));
}

FrameSource rendered_frames(const RenderedWorld& world, const Camera& camera) {
  FrameSource frames;
  frames.camera = camera;
  frames.of_the_map = world.of_the_map;
  frames.heights_of_the_map = world.heights_of_the_map;
  frames.open = [&world, camera] {
    const auto eye = std::make_shared<WorldCamera>(world, camera);
    return FrameTaker{[eye](const CameraPose& pose) { return eye->frame_at(pose); },
                      [eye](GeodeticPoint point) { return eye->ground_amsl_m(point); }};
  };
  if (world.of_the_map) {
    frames.notes = {
        "optimistic: frames show the very imagery that the map was made of, changed by a model of another "
        "day; give another date with --world"};
  } else {
    frames.notes = {"the error of the map against the world is the one that their georeferences have, none is drawn"};
  }
  if (!world.heights_of_the_map) {
    frames.notes.push_back("frames show the heights of " + world.elevation +
                           "; the map and the planned height above sea level are of others");
  }
  frames.not_simulated = {
      "frames that are answered late: a fix comes at once", "light, shadow, weather and season other than the world's",
      "parallax of roofs and trees: frames show " +
          std::string(world.elevation.empty() ? "flat ground"
                                              : "the ground of the elevation model with the picture on it"),
      "the sensor's noise and compression, rolling shutter, turning while the shutter is open"};
  return frames;
}

std::vector<FrameMatch> matches_of(const std::vector<SimulatedTry>& tries) {
  std::vector<FrameMatch> matches;
  for (const SimulatedTry& tried : tries) matches.push_back(tried.match);
  return matches;
}

MatchEvaluation evaluate_tries(const std::vector<SimulatedTry>& tries, const RenderedOptions& options) {
  return evaluate_matches(matches_of(tries), options.correct_within_m, options.match);
}

nlohmann::ordered_json rendered_json(const RenderedOptions& options, const MatchEvaluation& matches) {
  return {{"world", options.world},
          {"world_elevation", options.world_elevation},
          {"frame_width_px", options.frame_width_px},
          {"tilt_sigma_deg", options.tilt_sigma_deg},
          {"boresight_sigma_deg", options.boresight_sigma_deg},
          {"altimeter_sigma", options.altimeter_sigma},
          {"exposure_ms", options.exposure_ms},
          {"degradation", options.world.empty() ? options.degradation : 0},
          {"matches", to_json(matches, false)}};
}

}  // namespace pilotage
