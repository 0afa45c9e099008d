#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "pilotage/raster/raster.h"

namespace pilotage {

enum class GeotiffCompression {
  kDeflate,  ///< Lossless.
  kJpeg,     ///< 8-bit RGB only: YCbCr JPEG, about a tenth of the size.
};

struct GeotiffOptions {
  GeotiffCompression compression = GeotiffCompression::kDeflate;
  int jpeg_quality = 90;
  /// TIFF tags and other metadata of the dataset, as GDAL names them ("TIFFTAG_DATETIME", …).
  std::vector<std::pair<std::string, std::string>> metadata;
};

/// Writes an 8-bit RGB raster as a tiled GeoTIFF in `crs` (anything GDAL understands: "EPSG:32633", WKT). Pixels that
/// are not valid are marked by an internal mask; a raster valid everywhere gets none. The same raster gives the same
/// bytes. The file appears complete or not at all. Throws UsageError for a raster of another type or an unknown CRS,
/// DataError when the file exists and `overwrite` is false, or cannot be written.
void write_rgb8_geotiff(const std::filesystem::path& path, const Raster& raster, const std::string& crs,
                        const GeotiffOptions& options = {}, bool overwrite = false);

/// Writes one CV_32F band, deflated with the floating-point predictor; pixels that are not valid become the no-data
/// value NaN. Otherwise as write_rgb8_geotiff.
void write_float32_geotiff(const std::filesystem::path& path, const Raster& raster, const std::string& crs,
                           const GeotiffOptions& options = {}, bool overwrite = false);

}  // namespace pilotage
