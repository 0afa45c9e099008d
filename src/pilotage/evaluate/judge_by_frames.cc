#include <algorithm>
#include <cmath>
#include <limits>

#include "pilotage/evaluate/judge_tiles.h"
#include "pilotage/flightlog/match_flight.h"

namespace pilotage {
namespace {

struct NearestTile {
  std::size_t tile = 0;
  bool holds_it = false;  ///< The point lies in the tile.
};

NearestTile nearest_tile(const LevelScores& judged, const Eigen::Vector2d& point_px) {
  NearestTile nearest;
  double least = std::numeric_limits<double>::infinity();
  const double half = judged.matrix().tile_size_px / 2.0;
  for (std::size_t i = 0; i < judged.ground.tiles.size(); ++i) {
    if (!judged.has(i) || judged.scores[i].status == TileStatus::kTooLittleGround) continue;
    const PixelWindow window = judged.matrix().tile_window(judged.ground.tiles[i].cell());
    const double x = std::abs(point_px.x() - static_cast<double>(window.col) - half);
    const double y = std::abs(point_px.y() - static_cast<double>(window.row) - half);
    if (std::hypot(x, y) >= least) continue;
    least = std::hypot(x, y);
    nearest = {i, std::max(x, y) <= half};
  }
  return nearest;
}

}  // namespace

std::vector<TileOutcome> judge_by_frames(const LevelScores& judged, const std::filesystem::path& map,
                                         const std::vector<FlightFrame>& frames, const EvaluateOptions& options,
                                         double tolerance_m, int threads, const Progress& progress) {
  std::vector<FlightFrame> with_truth;
  std::copy_if(frames.begin(), frames.end(), std::back_inserter(with_truth),
               [](const FlightFrame& frame) { return frame.frame.truth().has_value(); });
  MatchOptions match;
  match.attitude_sigma_deg = options.attitude_sigma_deg;
  match.yaw_sigma_deg = options.attitude_sigma_deg;
  match.height_sigma_fraction = options.height_sigma_fraction;
  match.chips = options.chips;
  const CrsTransform transform(judged.ground.crs);
  std::vector<TileOutcome> outcomes;
  const std::vector<std::string> names{map.string()};
  for (const FrameMatch& matched : match_flight(open_unverified_maps({map}), with_truth, match, threads, progress)) {
    if (matched.readable()) require_frame_was_tried(matched.result, names);
    TileOutcome outcome;
    outcome.frame = matched.frame.file;
    outcome.status = frame_status_name(matched);
    const FrameRecord& frame = matched.frame;
    const auto truth = transform.map_from_geodetic(frame.true_center ? *frame.true_center : *frame.true_nadir);
    const NearestTile nearest =
        truth ? nearest_tile(judged, judged.matrix().map_from_pixel.pixel_from_map(*truth)) : NearestTile{};
    outcome.tile = nearest.tile;
    if (matched.readable()) outcome.evidence = matched.result.stats.vote_peak;
    const std::optional<Fix>& best = matched.result.fix ? matched.result.fix : matched.result.candidate;
    if (matched.readable() && best) set_outcome_errors(outcome, *best, frame.true_center, frame.true_nadir);
    if (nearest.holds_it) {
      outcome.outcome = matched.has_fix() ? outcome_of_fix(outcome.error_m, tolerance_m) : Outcome::kRefused;
    }
    outcomes.push_back(std::move(outcome));
  }
  return outcomes;
}

}  // namespace pilotage
