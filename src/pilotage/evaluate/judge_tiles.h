#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "pilotage/base/progress.h"
#include "pilotage/evaluate/evaluate_options.h"
#include "pilotage/evaluate/evaluated_tiles.h"
#include "pilotage/evaluate/tile_outcome.h"
#include "pilotage/flightlog/flight_frames.h"

namespace pilotage {

/// A tile of whose other date less is ground is not covered by it.
inline constexpr double kMinCoveredFraction = 0.9;

/// Tiles (indices into judged.ground.tiles) whose ground is looked for as an aircraft would: over the centre of each
/// hangs a camera whose frame is the tile, twice as fine and north up; it shows the other date (camera/render_frame.h),
/// over the ground's elevation model where it has one, as the map does.
/// Told are the true attitude and height with normal errors, and a prior displaced by up to the search radius in any
/// direction, σ a third of it. match() looks for the frame in `map`. A tile is not
/// covered whose frame is (kMinCoveredFraction). Draws are by tile (seed, tile_id), so that neither threads nor the
/// choice of tiles change an outcome. Throws DataError as open_gray and MapReader; UsageError when the search radius is
/// 0; Interrupted.
std::vector<TileOutcome> judge_by_voting(const LevelScores& judged, std::span<const std::size_t> tiles,
                                         const std::filesystem::path& map, const PlaceOnReference& place,
                                         const EvaluateOptions& options, double tolerance_m, std::uint64_t seed,
                                         int threads, const Progress& progress);

/// The same by normalised correlation (docs/methods/uniqueness.md): the tile as the other date shows it, on the scored
/// grid, is put at every position of its search area in the scored imagery, and the highest peak is its place. Nothing
/// is random and nothing refused, but ground without contrast.
std::vector<TileOutcome> judge_by_ncc(const LevelScores& judged, std::span<const std::size_t> tiles,
                                      const PlaceOnReference& place, const EvaluateOptions& options, double tolerance_m,
                                      int threads, const Progress& progress);

/// Real frames with truth, matched as in flight with the priors of their table; each belongs to the tile with enough
/// ground whose centre is nearest to its true place, and is not covered when it lies outside all tiles. Frames without
/// truth are left out. In the order of the frames.
std::vector<TileOutcome> judge_by_frames(const LevelScores& judged, const std::filesystem::path& map,
                                         const std::vector<FlightFrame>& frames, const EvaluateOptions& options,
                                         double tolerance_m, int threads, const Progress& progress);

}  // namespace pilotage
