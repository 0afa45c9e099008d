#include <cmath>

#include <nlohmann/json.hpp>
#include <pilotage/base/options_json.h>
#include <pilotage/geo/geodesic.h>
#include <pilotage/raster/gdal_config.h>

// Geodesics, JSON and GDAL of the ground library, from somebody else's project.
int main() {
  const auto leg =
      pilotage::geodesic_between({.lon_deg = 7.0, .lat_deg = 45.0}, {.lon_deg = 7.0, .lat_deg = 45.0 + 1.0 / 60.0});
  const auto json = pilotage::parse_json("text", R"({"answer": 42})");
  return std::abs(leg.length_m - 1852.2) < 1.0 && json["answer"] == 42 && !pilotage::gdal_version().empty() ? 0 : 1;
}
