#pragma once

#include <array>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include <gdal_priv.h>

#include "pilotage/geo/geo_transform.h"
#include "pilotage/raster/crs.h"

namespace pilotage::testing {

/// A small raster for a test to read.
struct RasterSpec {
  int width = 60;
  int height = 40;
  int bands = 1;
  GDALDataType type = GDT_Byte;
  std::string srs = "EPSG:32633";  ///< "" = states none.
  GeoTransform place = GeoTransform::north_up(500000, 5'000'000, 0.5);
  bool georeferenced = true;
  std::vector<std::string> creation_options{};
  /// Value of a band (from 0) at a pixel.
  std::function<double(int band, int col, int row)> value = [](int band, int col, int row) {
    return (band * 50 + col * 3 + row * 7) % 251;
  };
  /// Whatever else the raster has: colours, masks, metadata.
  std::function<void(GDALDataset&)> finish = [](GDALDataset&) {};
};

/// The CRS that a RasterSpec has unless it says otherwise.
inline Crs utm33() {
  return Crs::from_user_input(RasterSpec{}.srs);
}

/// Writes it as GeoTIFF and returns the path as text.
std::string make_raster(const std::filesystem::path& path, const RasterSpec& spec);

/// Opens a raster for update, calls `change`, closes it.
void change_raster(const std::filesystem::path& path, const std::function<void(GDALDataset&)>& change);

}  // namespace pilotage::testing
