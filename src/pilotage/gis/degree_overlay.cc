#include "pilotage/gis/degree_overlay.h"

#include <algorithm>
#include <cmath>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "pilotage/base/error.h"
#include "pilotage/base/markup.h"
#include "pilotage/base/text.h"
#include "pilotage/gis/report_layers.h"
#include "pilotage/ground/score_raster.h"
#include "pilotage/raster/gdal_degrees.h"
#include "pilotage/report/wording.h"

namespace pilotage {
namespace {

constexpr int kBlockCells = 256;
constexpr int kPixelsPerCell = 8;
constexpr const char* kLegend = "files/legend.png";

std::string png(const cv::Mat& rgba) {
  cv::Mat bgra;
  cv::cvtColor(rgba, bgra, cv::COLOR_RGBA2BGRA);
  std::vector<std::uint8_t> bytes;
  if (!cv::imencode(".png", bgra, bytes)) throw DataError("a picture cannot be written as PNG");
  return {bytes.begin(), bytes.end()};
}

cv::Mat colored(const cv::Mat& values, const MeasureScale& scale) {
  const auto colors = color_table(scale.measure.heat.colors);
  cv::Mat rgba(values.size(), CV_8UC4, cv::Scalar::all(0));
  for (int row = 0; row < values.rows; ++row) {
    for (int col = 0; col < values.cols; ++col) {
      const int index = shade(scale, values.at<double>(row, col));
      if (index < 0) continue;
      const Rgb color = colors[static_cast<std::size_t>(index)];
      rgba.at<cv::Vec4b>(row, col) = {color.red, color.green, color.blue, 255};
    }
  }
  return rgba;
}

std::string ground_overlay(const std::string& name, const std::string& file, const DegreePicture& picture) {
  // The colour's first byte is the opacity: the ground stays visible below.
  return "<GroundOverlay><name>" + name + "</name><color>b0ffffff</color><Icon><href>" + file +
         "</href></Icon><LatLonBox><north>" + format_fixed(picture.north_deg, 9) + "</north><south>" +
         format_fixed(picture.south_deg, 9) + "</south><east>" + format_fixed(picture.east_deg, 9) + "</east><west>" +
         format_fixed(picture.west_deg, 9) + "</west></LatLonBox></GroundOverlay>\n";
}

/// The colours with five numbers beside them. OpenCV's letters are ASCII.
cv::Mat legend(const MeasureScale& scale) {
  constexpr int kBarTop = 34;
  constexpr int kBarHeight = 160;
  const auto colors = color_table(scale.measure.heat.colors);
  cv::Mat rgba(kBarTop + kBarHeight + 16, 230, CV_8UC4, cv::Scalar(255, 255, 255, 225));
  const cv::Scalar ink(20, 20, 20, 255);
  const std::string unit = scale.measure.heat.unit == "1" ? "" : " [" + scale.measure.heat.unit + "]";
  cv::putText(rgba, scale.measure.heat.title + unit, {8, 20}, cv::FONT_HERSHEY_SIMPLEX, 0.45, ink, 1, cv::LINE_AA);
  for (int y = 0; y < kBarHeight; ++y) {
    const Rgb color = colors[static_cast<std::size_t>((kBarHeight - 1 - y) * 255 / (kBarHeight - 1))];
    cv::line(rgba, {8, kBarTop + y}, {32, kBarTop + y}, cv::Scalar(color.red, color.green, color.blue, 255));
  }
  for (int tick = 0; tick <= 4; ++tick) {
    const int y = kBarTop + (kBarHeight - 1) * (4 - tick) / 4;
    cv::line(rgba, {32, y}, {38, y}, ink);
    cv::putText(rgba, number_text(scale.low + (scale.high - scale.low) * tick / 4, scale.measure.heat.decimals),
                {44, y + 5}, cv::FONT_HERSHEY_SIMPLEX, 0.45, ink, 1, cv::LINE_AA);
  }
  return rgba;
}

std::string legend_overlay() {
  return std::string("<ScreenOverlay><name>Legend</name><Icon><href>") + kLegend +
         "</href></Icon><overlayXY x=\"0\" y=\"1\" xunits=\"fraction\" yunits=\"fraction\"/>"
         "<screenXY x=\"0.01\" y=\"0.98\" xunits=\"fraction\" yunits=\"fraction\"/>"
         "<size x=\"0\" y=\"0\" xunits=\"pixels\" yunits=\"pixels\"/></ScreenOverlay>\n";
}

}  // namespace

DegreeOverlay heat_overlay(const ReportInput& input, const Report& report) {
  DegreeOverlay overlay;
  const MeasureScale& shown = shown_scale(report);
  if (std::isnan(shown.least)) return overlay;
  const Crs crs = input.mission.ground.crs;
  const ScoreTable table(input.mission.ground, input.scores);
  const std::string name = html_escape(shown.measure.heat.title);
  for (const GridLevel& level : input.mission.ground.levels) {
    const ScoreRaster raster = score_raster(table, level.matrix.level);
    const auto band = std::find_if(raster.bands.begin(), raster.bands.end(),
                                   [&](const ScoreBand& entry) { return entry.name == shown.measure.name; });
    if (band == raster.bands.end()) continue;
    const cv::Mat rgba = colored(band->values, shown);
    const bool first = overlay.kml.empty();
    const std::string number = std::to_string(level.matrix.level);
    overlay.kml += "<Folder><name>Heat map: " + name + ", level " + number + "</name><visibility>" +
                   (first ? "1" : "0") + "</visibility>\n" + (first ? legend_overlay() : "");
    for (int y = 0; y < rgba.rows; y += kBlockCells) {
      for (int x = 0; x < rgba.cols; x += kBlockCells) {
        const cv::Rect block(x, y, std::min(kBlockCells, rgba.cols - x), std::min(kBlockCells, rgba.rows - y));
        cv::Mat opacity;
        cv::extractChannel(rgba(block), opacity, 3);
        if (cv::countNonZero(opacity) == 0) continue;
        const DegreePicture picture = picture_in_degrees(rgba(block).clone(), crs, raster.map_from_pixel.shifted(x, y),
                                                         kPixelsPerCell, kBlockCells * kPixelsPerCell);
        const std::string file = "files/heat_" + number + "_" + std::to_string(y / kBlockCells) + "_" +
                                 std::to_string(x / kBlockCells) + ".png";
        overlay.pictures.emplace_back(file, png(picture.rgba));
        overlay.kml += ground_overlay(name, file, picture);
      }
    }
    overlay.kml += "</Folder>\n";
  }
  if (!overlay.kml.empty()) overlay.pictures.emplace_back(kLegend, png(legend(shown)));
  return overlay;
}

}  // namespace pilotage
