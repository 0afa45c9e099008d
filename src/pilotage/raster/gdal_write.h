#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "pilotage/base/output_file.h"
#include "pilotage/base/progress.h"
#include "pilotage/geo/geo_transform.h"
#include "pilotage/raster/gdal_crs.h"
#include "pilotage/raster/raster.h"

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

/// The same into an output that is not committed yet. With `nearest` the overviews hold values of the raster itself,
/// for bands whose mean says nothing.
void write_score_raster(const OutputFile& output, const std::vector<ScoreBand>& bands, const Crs& crs,
                        const GeoTransform& map_from_pixel, bool nearest, const Progress& progress = {});

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

/// A picture that is made block by block.
struct PictureSource {
  std::int64_t width_px = 0;
  std::int64_t height_px = 0;
  Crs crs;
  GeoTransform map_from_pixel;
  /// Of the file, as GDAL names them: "TIFFTAG_DATETIME".
  std::vector<std::pair<std::string, std::string>> metadata;
  /// Calls `write` with every block of the picture once, in any order, one at a time: CV_8UC3, red first, and its mask,
  /// with the block's first column and row. Blocks of 512 px from the first pixel are written best.
  std::function<void(const std::function<void(std::int64_t col, std::int64_t row, const Raster& block)>& write)> draw;
};

/// Writes a Cloud-Optimised GeoTIFF of a picture in colour with a mask and overviews, deflated (lossless). No more of
/// it than blocks is in memory: it grows in a file beside `path` first. The same blocks give the same bytes. Throws
/// what `draw` throws, DataError when it cannot be written, Interrupted.
void write_picture_cog(const OutputFile& output, const PictureSource& picture, const Progress& progress = {});

/// Writes MBTiles of a picture, for web maps and programs in the field: PNG tiles in EPSG:3857 on the zoom level next
/// to the picture's own resolution and up to four coarser ones, every pixel that of the nearest in the picture. `rgba`:
/// CV_8UC4, red first; where the last is 0 nothing is drawn. `title` and `description` stand in the table metadata. The
/// same input gives the same bytes. Throws DataError.
void write_mbtiles(const std::filesystem::path& path, const cv::Mat& rgba, const Crs& crs,
                   const GeoTransform& map_from_pixel, const std::string& title, const std::string& description,
                   bool overwrite);

}  // namespace pilotage
