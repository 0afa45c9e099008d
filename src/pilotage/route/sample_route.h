#pragma once

#include <functional>
#include <string>
#include <vector>

#include "pilotage/geo/geodetic_point.h"
#include "pilotage/route/route.h"

namespace pilotage {

/// Height of the ground above mean sea level in metres; NaN where it is not known.
using TerrainHeight = std::function<double(GeodeticPoint)>;

/// The route every `step_m` metres or less along the WGS 84 geodesics of its legs, heights above ground resolved. Each
/// leg has samples at both of its ends, so a vertex between two legs appears twice (with two azimuths, and two heights
/// after a vertical climb).
///
/// Heights of a leg are linear in distance between its ends:
///   - both ends above ground: agl_m is interpolated; amsl_m = ground + agl_m where `terrain` knows the ground, else
///   NaN;
///   - both ends above sea level: amsl_m is interpolated and agl_m = amsl_m − ground;
///   - one of each: the one above ground is brought to sea level with the ground below it, then as before.
/// On a leg that starts or ends on the ground (landing) a negative agl_m down to −kLandingTolerance_m becomes 0,
/// because home's height and the elevation model never agree to the metre. speed_mps is the speed of the vertex the leg
/// leads to, NaN when the route does not say.
///
/// `terrain` may be empty. Throws UsageError when step_m is not positive and finite or would give more than
/// kMaxRouteSamples; DataError when a height above ground cannot be had (naming the option that would give it), or when
/// the route runs below the ground (naming leg, place and depth).
std::vector<RouteSample> sample_route(const Route& route, double step_m, const TerrainHeight& terrain = {});

/// Lower flight is warned of unless a caller says otherwise.
inline constexpr double kLowAgl_m = 20;

/// What a planner should look at again: home's height against the ground (more than 30 m apart; not looked at where
/// every height of the route is above ground), stretches flown lower than `low_agl_m` above the ground on legs that do
/// not land. Sentences; empty when all is well.
std::vector<std::string> route_height_warnings(const Route& route, const std::vector<RouteSample>& samples,
                                               const TerrainHeight& terrain = {}, double low_agl_m = kLowAgl_m);

inline constexpr double kLandingTolerance_m = 50;

/// Half around the Earth in steps of 10 m; some 300 MB.
inline constexpr std::size_t kMaxRouteSamples = 2'000'000;

}  // namespace pilotage
