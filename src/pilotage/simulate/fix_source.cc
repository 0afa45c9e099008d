#include "pilotage/simulate/fix_source.h"

#include <memory>

#include "pilotage/base/random.h"
#include "pilotage/geo/position_covariance.h"
#include "pilotage/simulate/flight_streams.h"

namespace pilotage {
namespace {

/// The matcher searches a square of so many standard deviations of its prior to each side.
constexpr double kSearchSigmas = 3;

/// The draws of one flight.
class DrawnFixes {
 public:
  DrawnFixes(const SimulatedMission& mission, const SimulateOptions& options, std::uint64_t seed)
      : mission_(mission),
        options_(options),
        fixes_(flight_stream(seed, FlightStream::kFixes)),
        windows_seed_(flight_stream_seed(seed, FlightStream::kWindows)),
        frames_seed_(flight_stream_seed(seed, FlightStream::kFrames)),
        level_z_(flight_stream(seed, FlightStream::kLevel).normal()) {}

  TriedFix operator()(const FixTry& tried) {
    if (Random(derive_seed(frames_seed_, tried.sample)).uniform() < mission_.conditions.dropped_frames) {
      return {false, std::nullopt};
    }
    if (!tried.below) return {};
    const double u = Random(derive_seed(windows_seed_, static_cast<std::uint64_t>(tried.window))).uniform();
    if (u < p_at_level(mission_.tiles[*tried.below], level_z_)) {
      return {true, OfferedFix{innovation_of_fix(*tried.drawn, sigma_m(), fixes_), noise_m2(), true}};
    }
    if (!(fixes_.uniform() < options_.false_fix_rate.value_or(mission_.tries.false_fix_rate))) return {};
    // A false place lies anywhere in the square that is searched.
    const double half_m = kSearchSigmas * largest_sigma_m(innovation_covariance(*tried.drawn, Eigen::Matrix2d::Zero()));
    const double east_m = fixes_.uniform(-half_m, half_m);
    const double north_m = fixes_.uniform(-half_m, half_m);
    return {true, OfferedFix{{east_m, north_m}, noise_m2(), false}};
  }

 private:
  double sigma_m() const { return mission_.path.model.fix_sigma_m; }
  Eigen::Matrix2d noise_m2() const { return isotropic_covariance_m2(sigma_m()); }

  const SimulatedMission& mission_;
  const SimulateOptions& options_;
  Random fixes_;
  std::uint64_t windows_seed_;
  std::uint64_t frames_seed_;
  double level_z_;
};

}  // namespace

FixSource drawn_fixes(const SimulatedMission& mission, const SimulateOptions& options) {
  FixSource source;
  source.begin_flight = [&mission, &options](std::size_t, std::uint64_t seed, int,
                                             const std::function<bool()>&) -> FlightFixes {
    return DrawnFixes(mission, options, seed);
  };
  source.not_simulated = {
      "frames and the matcher: whether a fix comes is drawn by the P of the tile below",
      "heights: the barometer, the altimeter and the terrain's error move no drawn fix",
      "attitude of the aircraft and of the camera's mount, exposure, blur, frames that are answered late"};
  return source;
}

FixSource no_fixes() {
  FixSource source;
  source.begin_flight = [](std::size_t, std::uint64_t, int, const std::function<bool()>&) -> FlightFixes {
    return [](const FixTry&) { return TriedFix{false, std::nullopt}; };
  };
  source.notes = {"no fixes: the inertial system alone"};
  source.not_simulated = {"fixes of the map: none is tried"};
  return source;
}

}  // namespace pilotage
