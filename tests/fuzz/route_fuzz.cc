// Whatever the bytes of a route file: a sound Route, or one of our own errors.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include <nlohmann/json.hpp>

#include "pilotage/base/error.h"
#include "pilotage/route/describe_route.h"
#include "pilotage/route/read_route.h"
#include "pilotage/route/route_json.h"
#include "pilotage/route/sample_route.h"

namespace {

void require(bool condition) {
  if (!condition) std::abort();
}

void check_route(const pilotage::Route& route) {
  require(!route.legs.empty());
  for (const auto& vertex : route.vertices) {
    require(std::abs(vertex.point.lat_deg) <= 90 && std::abs(vertex.point.lon_deg) <= 180);
    require(!std::isinf(vertex.amsl_m) && !std::isinf(vertex.agl_m));
  }
  for (const auto& leg : route.legs) {
    require(leg.length_m > 0 && leg.from >= 0 && leg.to >= 0);
    require(static_cast<std::size_t>(leg.from) < route.vertices.size());
    require(static_cast<std::size_t>(leg.to) < route.vertices.size());
  }
  require(!pilotage::describe_route_text(route).empty());
  const auto json = pilotage::route_to_json(route);
  require(pilotage::route_to_json(pilotage::route_from_json(json, "again")) == json);
  try {
    pilotage::sample_route(route, pilotage::route_length_m(route) / 10, [](pilotage::GeodeticPoint) { return 0.0; });
  } catch (const pilotage::DataError&) {
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  pilotage::RouteOptions options;
  // Without the option most files end at "relative to home"; with it more of the code is reached.
  options.agl_m = size % 2 == 0 ? std::optional<double>(100) : std::nullopt;
  try {
    check_route(pilotage::parse_route("fuzz", bytes, options));
  } catch (const pilotage::DataError&) {
  }
  return 0;
}
