// Whatever the bytes of a route file: a sound Route, or one of our own errors.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "fuzz/fuzz_targets.h"
#include <nlohmann/json.hpp>

#include "pilotage/base/error.h"
#include "pilotage/route/describe_route.h"
#include "pilotage/route/read_route.h"
#include "pilotage/route/route_json.h"
#include "pilotage/route/sample_route.h"

namespace pilotage {
namespace {

void check_route(const Route& route) {
  require(!route.legs.empty(), "a route has a leg");
  for (const auto& vertex : route.vertices) {
    require(std::abs(vertex.point.lat_deg) <= 90 && std::abs(vertex.point.lon_deg) <= 180, "vertices lie on the earth");
    require(!std::isinf(vertex.amsl_m) && !std::isinf(vertex.agl_m), "heights are finite or NaN");
  }
  for (const auto& leg : route.legs) {
    require(leg.length_m > 0 && leg.from >= 0 && leg.to >= 0, "a leg has a length and two ends");
    require(static_cast<std::size_t>(leg.from) < route.vertices.size(), "a leg begins at a vertex");
    require(static_cast<std::size_t>(leg.to) < route.vertices.size(), "a leg ends at a vertex");
  }
  require(!describe_route_text(route).empty(), "a route can be described");
  const auto json = route_to_json(route);
  require(route_to_json(route_from_json(json, "again")) == json, "the route's JSON gives the route again");
  try {
    sample_route(route, route_length_m(route) / 10, [](GeodeticPoint) { return 0.0; });
  } catch (const DataError&) {
  }
}

}  // namespace

void fuzz_route(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  RouteOptions options;
  // Without the option most files end at "relative to home"; with it more of the code is reached.
  options.agl_m = size % 2 == 0 ? std::optional<double>(100) : std::nullopt;
  try {
    check_route(parse_route("fuzz", bytes, options));
  } catch (const DataError&) {
  }
}

}  // namespace pilotage
