#include "pilotage/gis/degree_overlay.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>

#include <opencv2/imgproc.hpp>

#include "pilotage/base/error.h"
#include "pilotage/base/markup.h"
#include "pilotage/base/text.h"
#include "pilotage/base/wording.h"
#include "pilotage/ground/score_raster.h"
#include "pilotage/raster/gdal_degrees.h"
#include "pilotage/report/display_plane.h"
#include "pilotage/verdict/tile_class.h"

namespace pilotage {
namespace {

constexpr int kBlockCells = 256;
constexpr int kPixelsPerCell = 8;
constexpr const char* kLegend = "files/legend.png";

std::string ground_overlay(const std::string& name, const std::string& file, const DegreePicture& picture) {
  // The colour's first byte is the opacity: the ground stays visible below.
  return "<GroundOverlay><name>" + name + "</name><visibility>0</visibility><color>b0ffffff</color><Icon><href>" +
         file + "</href></Icon><LatLonBox><north>" + format_fixed(picture.north_deg, 9) + "</north><south>" +
         format_fixed(picture.south_deg, 9) + "</south><east>" + format_fixed(picture.east_deg, 9) + "</east><west>" +
         format_fixed(picture.west_deg, 9) + "</west></LatLonBox></GroundOverlay>\n";
}

cv::Scalar opaque(Rgb color) {
  return {static_cast<double>(color.red), static_cast<double>(color.green), static_cast<double>(color.blue), 255};
}

/// Writes lines from the top down. OpenCV's letters are ASCII.
class LegendPainter {
 public:
  LegendPainter(int width_px, int height_px) : rgba_(height_px, width_px, CV_8UC4, cv::Scalar(255, 255, 255, 235)) {}

  void heading(const std::string& text) {
    y_ += 6;
    write(kLeft, y_ + 14, text);
    y_ += kLine;
  }
  void box(Rgb color, const std::string& text) {
    cv::rectangle(rgba_, {kLeft, y_ + 4, kKey, 12}, opaque(color), cv::FILLED);
    entry(text);
  }
  void outline(Rgb color, const std::string& text) {
    cv::rectangle(rgba_, {kLeft, y_ + 4, kKey, 12}, opaque(color), 2);
    entry(text);
  }
  void line(Rgb color, int width_px, const std::string& text) {
    cv::line(rgba_, {kLeft, y_ + 10}, {kLeft + kKey, y_ + 10}, opaque(color), width_px);
    entry(text);
  }
  /// The colours of a scale with five numbers below them.
  void scale(const MeasureScale& scale) {
    constexpr int kWidth = 200;
    const auto colors = color_table(scale.measure.heat.colors);
    for (int x = 0; x < kWidth; ++x) {
      const Rgb color = colors[static_cast<std::size_t>(x * 255 / (kWidth - 1))];
      cv::line(rgba_, {kLeft + x, y_ + 2}, {kLeft + x, y_ + 14}, opaque(color));
    }
    for (int tick = 0; tick <= 4; ++tick) {
      const double value = scale.low + (scale.high - scale.low) * tick / 4;
      const bool below = tick == 0 && scale.least < scale.low;  // values lie beyond the ends
      const bool above = tick == 4 && scale.most > scale.high;
      const std::string sign = below ? "<" : above ? ">" : "";
      write(kLeft + (kWidth - 24) * tick / 4, y_ + 30, sign + number_text(value, scale.measure.heat.decimals));
    }
    y_ += 2 * kLine;
  }
  cv::Mat picture() const { return rgba_.rowRange(0, std::min(rgba_.rows, y_ + 8)).clone(); }

 private:
  static constexpr int kLeft = 8;
  static constexpr int kKey = 26;
  static constexpr int kLine = 19;
  void write(int x, int y, const std::string& text) {
    cv::putText(rgba_, text, {x, y}, cv::FONT_HERSHEY_SIMPLEX, 0.42, cv::Scalar(20, 20, 20, 255), 1, cv::LINE_AA);
  }
  void entry(const std::string& text) {
    write(kLeft + kKey + 8, y_ + 14, text);
    y_ += kLine;
  }

  cv::Mat rgba_;
  int y_ = 0;
};

/// What every colour in the KMZ means. `shown`: the measure of the heat map, null where there is none.
cv::Mat legend(const MeasureScale* shown, bool flown) {
  constexpr std::array<std::pair<QualityStatus, const char*>, 3> kStatuses{
      {{QualityStatus::kGood, "good"}, {QualityStatus::kMarginal, "marginal"}, {QualityStatus::kBad, "bad"}}};
  LegendPainter painter(360, 480);
  painter.heading("Decision: can a fix be counted on there?");
  for (const RasterClass& known : tile_classes()) {
    painter.box({known.rgb[0], known.rgb[1], known.rgb[2]}, known.name);
  }
  if (flown) {
    painter.outline(status_color(QualityStatus::kGood), "matching area: its tiles are stored");
    painter.heading("Legs (thin lines): within the limit?");
    for (const auto& [status, name] : kStatuses) painter.line(status_color(status), 4, name);
    painter.heading("Stretches without a fix (wide lines)");
    for (const auto& [status, name] : kStatuses) painter.line(status_color(status), 10, name);
  }
  if (shown != nullptr) {
    const std::string unit = shown->measure.heat.unit == "1" ? "" : " [" + shown->measure.heat.unit + "]";
    painter.heading("Heat map (to be switched on): " + shown->measure.heat.title + unit);
    painter.scale(*shown);
  }
  return painter.picture();
}

std::string legend_overlay() {
  return std::string("<ScreenOverlay><name>Legend</name><Icon><href>") + kLegend +
         "</href></Icon><overlayXY x=\"0\" y=\"1\" xunits=\"fraction\" yunits=\"fraction\"/>"
         "<screenXY x=\"0.01\" y=\"0.98\" xunits=\"fraction\" yunits=\"fraction\"/>"
         "<size x=\"0\" y=\"0\" xunits=\"pixels\" yunits=\"pixels\"/></ScreenOverlay>\n";
}

}  // namespace

cv::Mat heat_picture(const cv::Mat& values, const MeasureScale& scale) {
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

DegreeOverlay heat_overlay(const ScoreTable& table, const MeasureScale& shown, bool flown) {
  DegreeOverlay overlay;
  const bool measured = !std::isnan(shown.least);
  overlay.kml = legend_overlay();
  overlay.pictures.emplace_back(kLegend, encode_png(legend(measured ? &shown : nullptr, flown)));
  if (!measured) return overlay;
  const Crs crs = table.ground.crs;
  const std::string name = html_escape(shown.measure.heat.title);
  for (const GridLevel& level : table.ground.levels) {
    const ScoreRaster raster = score_raster(table, level.matrix.level);
    const auto band = std::find_if(raster.bands.begin(), raster.bands.end(),
                                   [&](const ScoreBand& entry) { return entry.name == shown.measure.name; });
    if (band == raster.bands.end()) continue;
    const cv::Mat rgba = heat_picture(band->values, shown);
    const std::string number = std::to_string(level.matrix.level);
    overlay.kml += "<Folder><name>Heat map: " + name + ", level " + number + "</name><visibility>0</visibility>\n";
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
        overlay.pictures.emplace_back(file, encode_png(picture.rgba));
        overlay.kml += ground_overlay(name, file, picture);
      }
    }
    overlay.kml += "</Folder>\n";
  }
  return overlay;
}

}  // namespace pilotage
