#pragma once

#include <optional>
#include <string>

#include "pilotage/base/options.h"

#pragma GCC visibility push(default)

namespace pilotage {

/// What the heights of a KML, GPX, GeoJSON or GeoPackage file are measured from. Mission files say it themselves.
enum class HeightReference {
  kAuto,       ///< As the format says: KML by its altitudeMode, GPX above mean sea level, others unknown.
  kAmsl,       ///< Mean sea level (EGM96 geoid).
  kEllipsoid,  ///< WGS 84 ellipsoid, as RFC 7946 wants of GeoJSON; converted with the EGM96 grid of PROJ.
  kAgl,        ///< The ground below.
  kHome,       ///< The launch site, whose height `home_amsl_m` says.
};
inline EnumNames<HeightReference> enum_names(HeightReference) {
  return {{HeightReference::kAuto, "auto"},
          {HeightReference::kAmsl, "amsl"},
          {HeightReference::kEllipsoid, "ellipsoid"},
          {HeightReference::kAgl, "agl"},
          {HeightReference::kHome, "home"}};
}

/// How a route file is understood.
struct RouteOptions {
  std::optional<double> agl_m;
  std::optional<double> speed_mps;
  HeightReference height_reference = HeightReference::kAuto;
  std::optional<double> home_amsl_m;
  std::string layer;
  std::string feature;

  template <class Self, class Fields>
  static void describe(Self& self, Fields& fields) {
    fields.field("agl_m", self.agl_m, "Constant height above ground, instead of the heights of the route file.",
                 Range{1, 30000});
    fields.field("speed_mps", self.speed_mps, "Speed over ground, instead of the speeds of the route file.",
                 Range{0.1, 1000});
    fields.field("height_reference", self.height_reference,
                 "What the heights of a KML, GPX, GeoJSON or GeoPackage route are measured from.");
    fields.field("home_amsl_m", self.home_amsl_m,
                 "Height of the launch site above mean sea level, instead of the one of the route file.",
                 Range{-500, 9000});
    fields.field("layer", self.layer, "Layer of the route file that holds the route, when there are several.");
    fields.field("feature", self.feature,
                 "Name of the line to fly, or its number counted from 1, when there are several.");
  }
};

}  // namespace pilotage

#pragma GCC visibility pop
