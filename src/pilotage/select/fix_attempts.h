#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "pilotage/ground/tile_chances.h"
#include "pilotage/mission/chances_beside_line.h"
#include "pilotage/mission/gnss_availability.h"
#include "pilotage/mission/mission.h"
#include "pilotage/mission/selection.h"

namespace pilotage {

/// A place on the route where a tile can be tried: the middle of the stretch that is flown over it.
struct FixAttempt {
  std::size_t sample = 0;   ///< Index into plan.flight.samples.
  std::size_t tile = 0;     ///< Index into plan.ground.tiles.
  std::int64_t window = 0;  ///< Attempts of one window succeed or fail together.
};

/// The tile under each sample of the route.
std::vector<std::optional<std::size_t>> tiles_under_route(const Mission& mission);

/// Those of `tiles`, one for each sample, that a flight cannot do without: none where GNSS is had.
std::vector<std::optional<std::size_t>> tiles_without_gnss(std::vector<std::optional<std::size_t>> tiles,
                                                           const GnssAvailability& gnss);

/// The places where tiles can be tried, in the order of flight. The route is cut into windows of one decorrelation
/// distance (`decorrelation_m`, else the width of the sample's tiles) or of one fix interval, whichever is longer. A
/// stretch over one tile is one attempt, or as many equal ones as it has decorrelation distances, and belongs to the
/// window of its middle.
std::vector<FixAttempt> fix_attempts(const Mission& mission, const std::vector<std::optional<std::size_t>>& tiles,
                                     double fix_interval_s, std::optional<double> decorrelation_m);

/// The attempts that count, ascending: of each window the one with the largest P above 0, the first among equals, and
/// no other, because within a window they succeed or fail together: P(any) = max P. `p_of_tile` is 0 for a tile that is
/// not stored.
std::vector<std::size_t> counted_attempts(const std::vector<FixAttempt>& attempts,
                                          const std::vector<double>& p_of_tile);

/// What tries along the route may give.
struct RouteChances {
  std::vector<double> p;             ///< Of each sample: P that a try there gives a correct fix; 0 where there is none.
  std::vector<std::int64_t> window;  ///< Of each sample. Within a window one draw u from [0, 1) decides: a try with P >
                                     ///< u succeeds.
  double fix_interval_s = 0;         ///< No fix comes sooner after another.
  double false_fix_rate = 0;         ///< Of the tries without a correct fix, those with a false one.
  std::vector<ChancesBesideLine> beside_line;  ///< Of each sample; may be empty.
};

/// The chances of attempts at tiles of which some are stored: `p_of_tile` is 0 for the others.
RouteChances route_chances(const std::vector<FixAttempt>& attempts, const std::vector<double>& p_of_tile,
                           std::size_t sample_count, const FixTries& tries);

/// The chances at a level that the place may have, and how much that level counts.
struct LevelChances {
  double weight = 1;
  RouteChances chances;
};

/// route_chances() at each level of `tiles`, with what they are beside the line by the P over all levels. `samples` are
/// the mission's, or those of a line beside them.
std::vector<LevelChances> level_chances(const Mission& mission, const std::vector<FlightSample>& samples,
                                        const std::vector<FixAttempt>& attempts, const TileChances& tiles,
                                        const FixTries& tries);

/// Correct fixes, and false ones at most, that a flight along the route must expect with one try every interval
/// over stored ground, as far as frames come. Expectations add up whether tries depend on each other or not, so every
/// one counts.
struct ExpectedFixes {
  double correct = 0;
  double wrong = 0;  ///< Σ (1 − P) · false_fix_rate.
};
ExpectedFixes expected_fixes(const Mission& mission, const std::vector<std::optional<std::size_t>>& tiles,
                             const std::vector<bool>& stored, const std::vector<double>& p_of_tile,
                             const FixTries& tries);

}  // namespace pilotage
