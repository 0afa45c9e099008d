#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "pilotage/flightlog/frame_match.h"
#include "pilotage/flightlog/match_evaluation.h"
#include "pilotage/mapdb/parallel_reading.h"
#include "pilotage/simulate/fix_source.h"
#include "pilotage/simulate/rendered_options.h"
#include "pilotage/simulate/rendered_world.h"

namespace pilotage {

/// What takes frames for one thread: a renderer, or another program's simulated camera.
struct FrameTaker {
  std::function<RenderedFrame(const CameraPose&)> frame_at;  ///< Of the size of FrameSource::camera.
  std::function<double(GeodeticPoint)> ground_amsl_m;        ///< Height of the ground; NaN where it is not known.
};

/// Where the frames of simulated flights come from.
struct FrameSource {
  std::function<FrameTaker()> open;  ///< Called once for each thread, by any of them.
  Camera camera;                     ///< That takes them.
  bool of_the_map = false;           ///< They show the very imagery that the map was made of: they are degraded.
  bool heights_of_the_map = true;    ///< They show the ground's heights that the line was planned over.
  std::vector<std::string> notes;
  std::vector<std::string> not_simulated;
};

/// A try with a frame and what the matcher made of it.
struct SimulatedTry {
  std::int64_t flight = 0;
  std::size_t sample = 0;
  CameraPose pose;                            ///< The truth.
  std::optional<std::int64_t> below_tile_id;  ///< The stored tile truly below.
  double below_p = kNaN;                      ///< Its P.
  FrameMatch match;  ///< The truth is the point straight below; `file` names flight and sample.
};

struct RenderedRun;  // hidden: what the flights share

/// Fixes of simulated flights by the onboard matcher on a real map: for each try a frame is taken at the true pose and
/// matched with what the flight's filter believes (docs/methods/simulate.md).
class RenderedFixes {
 public:
  /// Everything given must outlive the object. Throws UsageError for options that would make the result depend on the
  /// machine.
  RenderedFixes(const Mission& mission, const SimulateOptions& simulate, const RenderedOptions& options,
                FrameSource frames, OpenMaps open_maps, int threads);

  FixSource source();

  /// Of the flights that source() served, flight by flight in the order of their tries.
  std::vector<SimulatedTry> take_tries();

 private:
  std::shared_ptr<RenderedRun> run_;
};

/// What became of their frames.
std::vector<FrameMatch> matches_of(const std::vector<SimulatedTry>& tries);

/// What the matcher made of all tries: the truth is the point straight below, and `correct_within_m` judges.
MatchEvaluation evaluate_tries(const std::vector<SimulatedTry>& tries, const RenderedOptions& options);

/// "rendered" of simulation.json: what frames were of, and what the matcher did with them, without times.
nlohmann::ordered_json rendered_json(const RenderedOptions& options, const MatchEvaluation& matches);

/// The mission's camera at the width that the options ask for.
Camera rendered_camera(const Mission& mission, const RenderedOptions& options);

/// Frames rendered from a world (rendered_world.h), which must outlive the source.
FrameSource rendered_frames(const RenderedWorld& world, const Camera& camera);

}  // namespace pilotage
