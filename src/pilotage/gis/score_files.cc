#include "pilotage/gis/score_files.h"

#include <opencv2/imgproc.hpp>

#include "pilotage/base/markup.h"
#include "pilotage/base/output_file.h"
#include "pilotage/base/text.h"
#include "pilotage/gis/degree_overlay.h"
#include "pilotage/gis/qgis_style.h"
#include "pilotage/verdict/tile_class.h"

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

void write_heat_mbtiles(const std::filesystem::path& path, const ScoreRaster& raster, const ShownMeasure& shown,
                        const Crs& crs, const std::string& title, bool overwrite) {
  constexpr int kPixelsOfCell = 8;  // so that the edges of cells stay within an eighth of a cell in the map's pixels
  constexpr std::size_t kMostPixels = std::size_t{1} << 26;
  const cv::Mat cells = heat_picture(raster.bands[static_cast<std::size_t>(shown.band - 1)].values, shown.scale);
  int pixels = kPixelsOfCell;
  while (pixels > 1 &&
         cells.total() * static_cast<std::size_t>(pixels) * static_cast<std::size_t>(pixels) > kMostPixels) {
    --pixels;
  }
  cv::Mat picture;
  cv::resize(cells, picture, {}, pixels, pixels, cv::INTER_NEAREST);
  GeoTransform place = raster.map_from_pixel;
  for (double* step : {&place.x_per_col, &place.x_per_row, &place.y_per_col, &place.y_per_row}) *step /= pixels;
  const Measure& measure = shown.scale.measure;
  write_mbtiles(path, picture, crs, place, title,
                measure.heat.title + (measure.heat.unit == "1" ? "" : " [" + measure.heat.unit + "]") + ", " +
                    format_fixed(shown.scale.low, measure.heat.decimals) + " to " +
                    format_fixed(shown.scale.high, measure.heat.decimals) +
                    (measure.heat.ranks ? ", what most of this ground has" : ""),
                overwrite);
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
