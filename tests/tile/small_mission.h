#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "raster/raster_maker.h"

#include "pilotage/base/output_file.h"
#include "pilotage/base/random.h"
#include "pilotage/base/text.h"
#include "pilotage/raster/gdal_crs.h"
#include "pilotage/tile/tile_options.h"

namespace pilotage::testing {

/// A place of the small mission in metres: east and south of the upper left corner of its raster.
struct MissionPoint {
  double east_m;
  double south_m;
  double agl_m;
};

/// Where the raster of a small mission lies; 600 × 400 px of 1 m.
struct SmallPlace {
  std::string srs = "EPSG:32633";
  double west_m = 500000;
  double north_m = 5'000'000;
};

/// Writes ortho.tif (blocks of 8 px with random grays, so that every tile has corners and none repeats) and
/// route.geojson through `points` into a folder. The heights are heights above ground.
inline TileOptions make_small_mission(const std::filesystem::path& folder, const std::vector<MissionPoint>& points,
                                      const SmallPlace& place = {}) {
  RasterSpec spec;
  spec.width = 600;
  spec.height = 400;
  spec.srs = place.srs;
  spec.place = GeoTransform::north_up(place.west_m, place.north_m, 1);
  Random random(seed_from_name("small mission"));
  std::vector<double> blocks(75 * 50);
  for (double& block : blocks) block = 20.0 + static_cast<double>(random.below(200));
  spec.value = [&](int, int col, int row) { return blocks[static_cast<std::size_t>(row / 8 * 75 + col / 8)]; };
  const std::string ortho = make_raster(folder / "ortho.tif", spec);

  const CrsTransform transform(Crs::from_user_input(place.srs));
  std::vector<std::string> positions;
  for (const MissionPoint& point : points) {
    const GeodeticPoint at =
        transform.geodetic_from_map({place.west_m + point.east_m, place.north_m - point.south_m}).value();
    positions.push_back("[" + format_number(at.lon_deg) + "," + format_number(at.lat_deg) + "," +
                        format_number(point.agl_m) + "]");
  }
  write_file(folder / "route.geojson",
             R"({"type":"Feature","properties":{},"geometry":{"type":"LineString","coordinates":[)" +
                 join(positions, ",") + "]}}",
             true);

  TileOptions options;
  options.imagery = {ortho};
  options.route = (folder / "route.geojson").string();
  options.route_options.height_reference = HeightReference::kAgl;
  options.route_options.speed_mps = 18;
  options.camera.hfov_deg = 60;
  options.camera.width_px = 640;
  options.camera.height_px = 480;
  options.max_error_m = 20;
  return options;
}

/// Flat ground of `amsl_m` under and around a small mission, a height every `spacing_m`; returns the file's name.
inline std::string make_flat_elevation(const std::filesystem::path& folder, double amsl_m, double spacing_m = 10) {
  RasterSpec spec;
  spec.width = static_cast<int>(1000 / spacing_m);
  spec.height = static_cast<int>(800 / spacing_m);
  spec.type = GDT_Float32;
  spec.place = GeoTransform::north_up(499'800, 5'000'200, spacing_m);
  spec.value = [amsl_m](int, int, int) { return amsl_m; };
  return make_raster(folder / "elevation.tif", spec);
}

/// Two legs, 400 m and 100 m, at one height.
inline std::vector<MissionPoint> two_legs(double agl_m = 80) {
  return {{100, 150, agl_m}, {500, 150, agl_m}, {500, 250, agl_m}};
}

}  // namespace pilotage::testing
