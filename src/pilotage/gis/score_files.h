#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "pilotage/ground/measure_scale.h"
#include "pilotage/ground/score_raster.h"
#include "pilotage/mission/mission.h"

namespace pilotage {

/// The measure that a score raster shows when it is opened: the first of heat_maps() that is a band of it, with
/// its scale over the rows of the level. Nothing when there is none.
struct ShownMeasure {
  MeasureScale scale;
  int band = 0;  ///< From 1.
};
std::optional<ShownMeasure> shown_measure(const ScoreRaster& raster, const std::vector<TileScores>& scores);

/// Classes go, marginal, no-go (tile_class.h) of the tiles of one level on the pixels of score_raster, kNoClass where
/// there is no tile; CV_8U, empty when there is no row. Throws as score_raster.
cv::Mat class_values(const ScoreTable& table, int level);

/// Where QGIS looks for the style of a raster: the same name with .qml.
std::filesystem::path style_path(std::filesystem::path raster_path);

/// Writes the heat map's style beside `raster_path` (style_path). Returns its file name.
std::string write_heat_style(const std::filesystem::path& raster_path, const ShownMeasure& shown, bool overwrite);

/// Writes the heat map as MBTiles (write_mbtiles). Each cell has 8 × 8 pixels, fewer where that would be above 64
/// million.
void write_heat_mbtiles(const std::filesystem::path& path, const ScoreRaster& raster, const ShownMeasure& shown,
                        const Crs& crs, const std::string& title, bool overwrite);

/// Writes the class raster with its style (.qml) and the names of its classes (.aux.xml, where GDAL looks for them).
void write_classes(const std::filesystem::path& path, const cv::Mat& values, const Crs& crs,
                   const GeoTransform& map_from_pixel, bool overwrite);

}  // namespace pilotage
