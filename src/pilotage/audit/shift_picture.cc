#include "pilotage/audit/shift_picture.h"

#include <algorithm>
#include <cmath>

#include <opencv2/imgproc.hpp>

#include "pilotage/base/options.h"
#include "pilotage/base/svg.h"
#include "pilotage/base/text.h"
#include "pilotage/base/wording.h"
#include "pilotage/raster/gdal_gray.h"
#include "pilotage/report/display_plane.h"
#include "pilotage/report/page_text.h"

namespace pilotage {
namespace {

constexpr double kLongSide_px = 900;
constexpr double kFoot_px = 112;
constexpr double kLegend_px = 560;
/// Longest line of the scale.
constexpr double kScale_px = 200;
constexpr double kArrows = 30;  // along the longer side
constexpr std::size_t kMostBytes = 400'000;

/// Of the arrows, so that the longest takes at most the room between two of them.
double exaggeration(double largest_m, double metres_between) {
  return largest_m > 0 && metres_between > largest_m ? round_below(metres_between / largest_m) : 1;
}

bool is_compared(const MapAudit& audit, double x_m, double y_m) {
  const auto col = static_cast<std::size_t>((x_m - audit.area_m.min_x_m) / audit.cell_m);
  const auto row = static_cast<std::size_t>((audit.area_m.max_y_m - y_m) / audit.cell_m);
  const auto columns = static_cast<std::size_t>(audit.cell_columns);
  return col < columns && row * columns + col < audit.compared_cells.size() &&
         audit.compared_cells[row * columns + col] != 0;
}

/// In gray and pale, so that arrows are seen.
std::string imagery_svg(const MapAudit& audit, const std::string& map, const AuditOptions& options,
                        const SvgWriter& svg, double width_px, double height_px) {
  const GeoTransform place =
      GeoTransform::north_up(audit.area_m.min_x_m, audit.area_m.max_y_m, audit.area_m.width_m() / std::ceil(width_px));
  const Raster picture = read_rgb8_on_grid({map}, audit.crs, place, static_cast<int>(std::ceil(width_px)),
                                           static_cast<int>(std::ceil(height_px)), options.imagery);
  cv::Mat gray;
  cv::cvtColor(picture.pixels, gray, cv::COLOR_RGB2GRAY);
  gray.convertTo(gray, CV_8U, 0.6, 95);
  gray.setTo(cv::Scalar(255), picture.valid == 0);
  cv::Mat rgb;
  cv::cvtColor(gray, rgb, cv::COLOR_GRAY2RGB);
  return "<image width=\"" + svg.number(width_px) + "\" height=\"" + svg.number(height_px) +
         "\" preserveAspectRatio=\"none\" href=\"data:image/jpeg;base64," + base64(encode_jpeg(rgb, kMostBytes)) +
         "\"/>\n";
}

}  // namespace

std::string shift_picture_svg(const MapAudit& audit, const std::string& map, const AuditOptions& options) {
  const SvgWriter svg;
  const double longer_m = std::max(audit.area_m.width_m(), audit.area_m.height_m());
  const double px_per_m = kLongSide_px / longer_m;
  const double width_px = std::max(kLegend_px, audit.area_m.width_m() * px_per_m);
  const double height_px = audit.area_m.height_m() * px_per_m;
  const double between_m = longer_m / kArrows;
  const double factor = exaggeration(audit.shift_m.largest, between_m);
  std::string text = "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 " + svg.number(width_px) + " " +
                     svg.number(height_px + kFoot_px) + "\" width=\"" + svg.number(width_px) + "\" height=\"" +
                     svg.number(height_px + kFoot_px) +
                     "\" role=\"img\" aria-label=\"Shifts of the map against the other one\">\n<style>"
                     "text{font:14px system-ui,sans-serif;fill:#1a1a1a}line{stroke-width:1.8}"
                     ".within{stroke:#0b5fa5}.beyond{stroke:#c2410c}.scale{stroke:#1a1a1a}"
                     ".foot{fill:#fff}</style>\n"
                     "<defs><marker id=\"head\" viewBox=\"0 0 6 6\" refX=\"5\" refY=\"3\" markerWidth=\"5\" "
                     "markerHeight=\"5\" orient=\"auto-start-reverse\"><path d=\"M0 0L6 3L0 6z\" "
                     "fill=\"context-stroke\"/></marker></defs>\n" +
                     svg.rect("foot", 0, 0, width_px, height_px + kFoot_px);
  text += imagery_svg(audit, map, options, svg, audit.area_m.width_m() * px_per_m, height_px);
  text += "<g marker-end=\"url(#head)\">\n";
  const WarpField& field = audit.registration.fit.field;
  for (double y_m = audit.area_m.max_y_m - between_m / 2; y_m > audit.area_m.min_y_m; y_m -= between_m) {
    for (double x_m = audit.area_m.min_x_m + between_m / 2; x_m < audit.area_m.max_x_m; x_m += between_m) {
      const Eigen::Vector2d shift_m = -field.displacement_m(x_m, y_m);
      if (shift_m.hasNaN() || !is_compared(audit, x_m, y_m)) continue;
      const double x_px = (x_m - audit.area_m.min_x_m) * px_per_m;
      const double y_px = (audit.area_m.max_y_m - y_m) * px_per_m;
      text += svg.line(shift_m.norm() <= options.max_shift_m ? "within" : "beyond",
                       x_px - factor * shift_m.x() * px_per_m, y_px + factor * shift_m.y() * px_per_m, x_px, y_px);
    }
  }
  text += "</g>\n";
  const double scale_m = round_below(kScale_px / (factor * px_per_m));
  text += svg.line("scale", 10, height_px + 22, 10 + factor * scale_m * px_per_m, height_px + 22);
  text += svg.text("", 10, height_px + 46,
                   "The line is " + format_number(scale_m) + " m; arrows are drawn " + format_number(factor) +
                       " times as long as they are,");
  text += svg.text("", 10, height_px + 68, "from where the other map has the ground to where this one has it.");
  text += svg.text("", 10, height_px + 90,
                   "Orange: beyond " + format_number(options.max_shift_m) + " m. None where nothing was compared: " +
                       percent_text(1 - audit.compared) + " of the common ground.");
  return text + "</svg>\n";
}

}  // namespace pilotage
