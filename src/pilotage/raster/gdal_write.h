#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "pilotage/base/progress.h"
#include "pilotage/geo/geo_transform.h"
#include "pilotage/raster/gdal_crs.h"

namespace pilotage {

/// One measure of a score raster.
struct ScoreBand {
  std::string name;  ///< Becomes the band's description: "gray_variance".
  std::string unit;  ///< Becomes the band's unit: "gray levels", or "".
  cv::Mat values;    ///< CV_64F or CV_32F, one channel; NaN where there is no score.
};

/// Writes a Cloud-Optimised GeoTIFF of bands that are all Float64 or all Float32. Scores are Float64: two tiles'
/// Frieden entropies differ in the sixth digit, which Float32 would lose. No data is NaN, because every finite number
/// may be a score. Descriptions, units and statistics (minimum, maximum, mean, standard deviation over the valid
/// pixels) stand in the file itself. The same input gives the same bytes. Written under a temporary name and renamed.
/// Throws UsageError for bands of wrong type or differing size, DataError when it cannot be written, Interrupted.
void write_score_raster(const std::filesystem::path& path, const std::vector<ScoreBand>& bands, const Crs& crs,
                        const GeoTransform& map_from_pixel, bool overwrite, const Progress& progress = {});

/// One class of a class raster; its value is its place in the list.
struct RasterClass {
  std::string name;
  std::array<std::uint8_t, 3> rgb{};
};

/// The value that means "no data" in a class raster; drawn transparent.
inline constexpr std::uint8_t kNoClass = 255;

/// Writes a paletted Cloud-Optimised GeoTIFF of classes: Byte values 0 … n − 1 (n ≤ 255) and kNoClass. GeoTIFF has no
/// place for class names, so they stand in the band's metadata as CLASS_0, CLASS_1, … . Otherwise as
/// write_score_raster.
void write_class_raster(const std::filesystem::path& path, const std::string& name, const cv::Mat& values,
                        const std::vector<RasterClass>& classes, const Crs& crs, const GeoTransform& map_from_pixel,
                        bool overwrite);

/// Writes MBTiles of a picture, for web maps and programs in the field: PNG tiles in EPSG:3857 on the zoom level next
/// to the picture's own resolution and up to four coarser ones, every pixel that of the nearest in the picture. `rgba`:
/// CV_8UC4, red first; where the last is 0 nothing is drawn. `title` and `description` stand in the table metadata. The
/// same input gives the same bytes. Throws DataError.
void write_mbtiles(const std::filesystem::path& path, const cv::Mat& rgba, const Crs& crs,
                   const GeoTransform& map_from_pixel, const std::string& title, const std::string& description,
                   bool overwrite);

}  // namespace pilotage
