#include "pilotage/gis/score_files.h"

#include "pilotage/base/markup.h"
#include "pilotage/base/output_file.h"
#include "pilotage/gis/qgis_style.h"
#include "pilotage/report/tile_class.h"

namespace pilotage {
namespace {

std::string category_names(const std::vector<RasterClass>& classes) {
  std::string text = "<PAMDataset>\n  <PAMRasterBand band=\"1\">\n    <CategoryNames>\n";
  for (const RasterClass& next : classes) text += "      <Category>" + html_escape(next.name) + "</Category>\n";
  return text + "    </CategoryNames>\n  </PAMRasterBand>\n</PAMDataset>\n";
}

}  // namespace

std::filesystem::path style_path(std::filesystem::path raster_path) {
  return raster_path.replace_extension(".qml");
}

std::optional<ShownMeasure> shown_measure(const ScoreRaster& raster, const std::vector<TileScores>& scores) {
  for (const Measure* measure : heat_maps()) {
    for (std::size_t i = 0; i < raster.bands.size(); ++i) {
      if (raster.bands[i].name == measure->name) return {{measure_scale(*measure, scores), static_cast<int>(i) + 1}};
    }
  }
  return std::nullopt;
}

cv::Mat class_values(const ScoreTable& table, int level) {
  return class_raster(table, level, [](const TileScores& scores) {
    const auto found = tile_class(scores);
    return found ? static_cast<std::uint8_t>(*found) : kNoClass;
  });
}

std::string write_heat_style(const std::filesystem::path& raster_path, const ShownMeasure& shown, bool overwrite) {
  const std::filesystem::path path = style_path(raster_path);
  write_file(path, qgis_heat_style(shown.scale, shown.band), overwrite);
  return path.filename().string();
}

void write_classes(const std::filesystem::path& path, const cv::Mat& values, const Crs& crs,
                   const GeoTransform& map_from_pixel, bool overwrite) {
  const std::filesystem::path style = style_path(path);
  const std::filesystem::path names = path.string() + ".aux.xml";
  write_class_raster(path, "class", values, tile_classes(), crs, map_from_pixel, overwrite);
  write_file(style, qgis_class_style(tile_classes()), overwrite);
  write_file(names, category_names(tile_classes()), overwrite);
}

}  // namespace pilotage
