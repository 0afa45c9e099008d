#include "pilotage/capture/quality_page.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <nlohmann/json.hpp>
#include <opencv2/imgproc.hpp>

#include "pilotage/audit/shift_picture.h"
#include "pilotage/base/markup.h"
#include "pilotage/base/statistics.h"
#include "pilotage/base/svg.h"
#include "pilotage/base/text.h"
#include "pilotage/base/utf8.h"
#include "pilotage/base/wording.h"
#include "pilotage/capture/capture_assets.h"
#include "pilotage/capture/capture_quality.h"
#include "pilotage/ground/measure_scale.h"
#include "pilotage/raster/gdal_gray.h"
#include "pilotage/report/display_plane.h"
#include "pilotage/report/page_assets.h"
#include "pilotage/report/page_parts.h"
#include "pilotage/report/page_text.h"

namespace pilotage {
namespace {

constexpr double kPictureSide_px = 900;
constexpr std::size_t kMostBytes = 400'000;
constexpr std::size_t kMostRows = 400;
constexpr std::size_t kMostLines = 100;
/// Colours of the error span at least this share of it: less makes no difference.
constexpr double kLeastSpan = 0.1;
constexpr Rgb kNothing{255, 255, 255};
/// Of how many frames see a place: one, two, … five and more. Colours that differ in lightness, too.
constexpr std::array<Rgb, 5> kSeenColors{{{168, 0, 92}, {230, 159, 0}, {147, 200, 230}, {61, 142, 196}, {0, 74, 122}}};

/// The map's ground as a picture that is as large as a page shows it.
struct PictureGrid {
  Crs crs;
  GeoTransform map_from_pixel;
  int width_px = 0;
  int height_px = 0;
};

PictureGrid picture_grid(const std::string& map) {
  const GraySource source = open_gray(map);
  const auto width = static_cast<double>(source.width_px);
  const auto height = static_cast<double>(source.height_px);
  const double step = std::max(width, height) / kPictureSide_px;  // of the map's pixels
  PictureGrid grid;
  grid.crs = source.crs;
  grid.width_px = std::max(1, static_cast<int>(std::ceil(width / step)));
  grid.height_px = std::max(1, static_cast<int>(std::ceil(height / step)));
  const Eigen::Vector2d corner_m = source.map_from_pixel.map_from_pixel({0, 0});
  grid.map_from_pixel = GeoTransform::north_up(corner_m.x(), corner_m.y(), step * source.map_from_pixel.x_per_col);
  return grid;
}

std::string svg_open(const PictureGrid& grid, const std::string& style) {
  const std::string width = std::to_string(grid.width_px);
  const std::string height = std::to_string(grid.height_px);
  return "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 " + width + " " + height + "\" width=\"" + width +
         "\" height=\"" + height + "\">\n<style>" + style + "</style>\n";
}

/// As a picture, so that its style stays inside.
std::string picture_html(const std::string& type, const std::string& bytes, const std::string& name,
                         const std::string& caption) {
  return "<figure><img src=\"data:image/" + type + ";base64," + base64(bytes) + "\" alt=\"" + html_escape(name) +
         "\"><figcaption><strong>" + html_escape(name) + "</strong> " + caption + "</figcaption></figure>\n";
}

std::string key_html(Rgb color, const std::string& text) {
  return "<li><span class=\"swatch\" style=\"background:" + hex_color(color) + "\"></span> " + html_escape(text) +
         "</li>";
}

/// The map, pale, with every frame where the pictures put it and a line to where it was measured, without what all miss
/// alike.
std::string frames_picture(const CaptureResult& done, const std::string& map, const PictureGrid& grid) {
  const SvgWriter svg;
  const Raster picture = read_rgb8_on_grid({map}, grid.crs, grid.map_from_pixel, grid.width_px, grid.height_px);
  cv::Mat pale;
  picture.pixels.convertTo(pale, CV_8U, 0.6, 95);
  pale.setTo(cv::Scalar(255, 255, 255), picture.valid == 0);
  std::string text = svg_open(grid, "line{stroke:#c2410c;stroke-width:2.5}.dot{fill:#0b3f70}");
  text += "<image width=\"" + std::to_string(grid.width_px) + "\" height=\"" + std::to_string(grid.height_px) +
          "\" href=\"data:image/jpeg;base64," + base64(encode_jpeg(pale, kMostBytes)) + "\"/>\n";
  std::vector<double> lengths_m;
  for (const CapturedFrame& frame : done.frames) {
    lengths_m.push_back(std::hypot(frame.residual_east_m, frame.residual_north_m));
  }
  const double px_per_m = 1 / grid.map_from_pixel.x_per_col;
  const double usual_m = std::max(1e-3, quantile(lengths_m, 0.9));
  const double factor = std::max(1.0, round_below(std::max(1.0, kPictureSide_px / 20 / (usual_m * px_per_m))));
  const CrsTransform transform(grid.crs);
  for (const CapturedFrame& frame : done.frames) {
    const auto map_m = transform.map_from_geodetic(frame.adjusted);
    if (!map_m) continue;
    const Eigen::Vector2d at = grid.map_from_pixel.pixel_from_map(*map_m);
    text += svg.line("", at.x(), at.y(), at.x() + factor * frame.residual_east_m * px_per_m,
                     at.y() - factor * frame.residual_north_m * px_per_m);
    text += svg.rect("dot", at.x() - 3, at.y() - 3, 6, 6);
  }
  return picture_html("svg+xml", text + "</svg>\n", "Frames",
                      "where the pictures put them, with lines towards where they were measured, " +
                          format_number(factor) + " times as long as they are; without what all miss alike. " +
                          kind_mark(NumberKind::kMeasured));
}

/// A band of what stands beside the map.
Raster read_layer(const QualityPageInput& input, double band, const PictureGrid& grid) {
  ImageryOptions options;
  options.bands = {band};
  options.resampling = Resampling::kNearest;
  return open_gray_on_grid({input.map_sigma}, grid.crs, grid.map_from_pixel, grid.width_px, grid.height_px, options)
      .read({0, 0, grid.width_px, grid.height_px});
}

/// A layer in colours, PNG.
template <class ColorOf>
std::string layer_png(const Raster& layer, const ColorOf& color_of) {
  cv::Mat values;
  layer.pixels.convertTo(values, CV_64F);
  cv::Mat rgb(values.size(), CV_8UC3);
  for (int y = 0; y < values.rows; ++y) {
    for (int x = 0; x < values.cols; ++x) {
      const Rgb color = layer.valid.at<std::uint8_t>(y, x) != 0 ? color_of(values.at<double>(y, x)) : kNothing;
      rgb.at<cv::Vec3b>(y, x) = {color.red, color.green, color.blue};
    }
  }
  return encode_png(rgb);
}

std::string overlap_picture(const QualityPageInput& input, const PictureGrid& grid) {
  constexpr auto kMost = static_cast<double>(kSeenColors.size());
  const std::string png = layer_png(read_layer(input, 3, grid), [&](double seen) {
    return kSeenColors[static_cast<std::size_t>(std::clamp(std::round(seen), 1.0, kMost)) - 1];
  });
  std::string keys = "<ul>";
  for (std::size_t i = 0; i < kSeenColors.size(); ++i) {
    keys += key_html(kSeenColors[i], std::to_string(i + 1) + (i + 1 == kSeenColors.size() ? " and more" : ""));
  }
  return picture_html("png", png, "Overlap", "by how many frames the ground is seen. " + keys + "</ul>");
}

std::string error_picture(const CaptureResult& done, const QualityPageInput& input, const PictureGrid& grid) {
  const Raster layer = read_layer(input, 1, grid);
  double low_m = 0;
  double high_m = 0;
  cv::minMaxLoc(layer.pixels, &low_m, &high_m, nullptr, nullptr, layer.valid);
  if (!std::isfinite(low_m)) return "";
  if (!std::isfinite(high_m) || high_m > done.map_sigma_p95_m) high_m = std::max(low_m, done.map_sigma_p95_m);
  if (!std::isfinite(high_m)) high_m = 2 * low_m;
  const double span_m = std::max(high_m - low_m, kLeastSpan * high_m);
  const std::array<Rgb, 256> colors = color_table(ColorMap::kCividis);
  const std::string png = layer_png(layer, [&](double sigma_m) {
    if (!std::isfinite(sigma_m)) return colors.back();
    return colors[static_cast<std::size_t>(std::lround(255 * std::clamp((sigma_m - low_m) / span_m, 0.0, 1.0)))];
  });
  std::string keys = "<ul>";
  for (const double share : {0.0, 0.5, 1.0}) {
    keys += key_html(colors[static_cast<std::size_t>(255 * share)],
                     number_text(low_m + share * span_m, 2) + " m" + (share == 1 ? " and more" : ""));
  }
  return picture_html("png", png, "The map's own error",
                      "standard deviation, each axis. " + kind_mark(NumberKind::kModelled) + keys + "</ul>");
}

std::string shifts_html(const CaptureResult& done, const QualityPageInput& input) {
  if (!done.alignment) return "";
  const MapAlignment& alignment = *done.alignment;
  const auto row = [](const std::string& name, const MapAudit& audit) {
    const auto metres = [](double value_m) { return number_text(value_m, 2) + " m"; };
    return "<tr>" + heading_html(name) + cell_html("East", metres(audit.median_shift_en_m.x())) +
           cell_html("North", metres(audit.median_shift_en_m.y())) +
           cell_html("Length, median", metres(audit.shift_m.median)) +
           cell_html("95 %", metres(audit.shift_m.quantile_95)) +
           cell_html("About the median", metres(audit.about_median_m.median)) +
           cell_html("Compared", percent_text(audit.compared)) + "</tr>\n";
  };
  AuditOptions options;
  options.max_shift_m = 3 * std::max(alignment.reference_sigma_m, 0.01);
  const auto picture = [&](const std::string& name, const MapAudit& audit) {
    if (audit.compared_m2 == 0) return std::string();
    return picture_html("svg+xml", shift_picture_svg(audit, input.map, options), name,
                        "over the map that was written. " + kind_mark(NumberKind::kMeasured));
  };
  return "<section aria-labelledby=\"alignment-heading\">\n  <h2 id=\"alignment-heading\">Against " +
         html_escape(alignment.reference) + "</h2>\n  <p>" + std::to_string(alignment.ties) + " ties, which miss by " +
         number_text(alignment.tie_rms_m, 2) +
         " m, each axis; shifts are the map's place less "
         "that map's.</p>\n  <div class=\"scroll\" tabindex=\"0\" role=\"region\" aria-label=\"Table of "
         "shifts\"><table "
         "class=\"wide cards\"><thead><tr><th scope=\"col\"></th><th scope=\"col\">East (median)</th><th "
         "scope=\"col\">North (median)</th><th scope=\"col\">Length, median</th><th scope=\"col\">95 %</th><th "
         "scope=\"col\">About the median</th><th scope=\"col\">Compared</th></tr></thead><tbody>\n" +
         row("Before", alignment.before) + row("After", alignment.after) +
         "</tbody></table></div>\n  <div class=\"pictures\">\n" + picture("Shifts before", alignment.before) +
         picture("Shifts after", alignment.after) + "</div>\n</section>\n";
}

std::string checks_html(const CaptureResult& done) {
  if (done.check_points.empty()) return "";
  std::string html =
      "<section aria-labelledby=\"checks-heading\">\n  <h2 id=\"checks-heading\">Check points " +
      kind_mark(NumberKind::kMeasured) +
      "</h2>\n  <div class=\"scroll\" tabindex=\"0\" role=\"region\" aria-label=\"Table of check points\"><table "
      "class=\"wide cards\"><thead><tr><th scope=\"col\">Point</th><th scope=\"col\">East</th><th "
      "scope=\"col\">North</th><th scope=\"col\">The map says, each axis</th><th "
      "scope=\"col\">Frame</th></tr></thead><tbody>\n";
  for (const CheckedPoint& one : done.check_points) {
    html += "<tr>" + heading_html(one.name) + cell_html("East", number_text(one.miss_east_m, 2) + " m") +
            cell_html("North", number_text(one.miss_north_m, 2) + " m") +
            cell_html("The map says", number_text(one.map_sigma_m, 2) + " m") +
            cell_html("Frame", one.file + (one.is_shown ? "" : " (the map shows another one there)")) + "</tr>\n";
  }
  return html + "</tbody></table></div>\n</section>\n";
}

std::string camera_html(const CaptureResult& done) {
  const auto row = [](const std::string& label, const std::string& text) {
    return "<tr>" + heading_html(label) + cell_html(text) + "</tr>\n";
  };
  std::string html = row("Focal length", number_text(done.camera.fx_px, 1) + " px; " + done.camera_source + ": " +
                                             number_text(done.given_focal_length_px, 1) + " px") +
                     row("Distortion k1, k2",
                         number_text(done.camera.distortion[0], 5) + ", " + number_text(done.camera.distortion[1], 5)) +
                     row("Turn against the stated attitudes, about its x, y, z",
                         number_text(done.boresight_x_deg, 2) + "°, " + number_text(done.boresight_y_deg, 2) + "°, " +
                             number_text(done.boresight_z_deg, 2) + "°") +
                     row("Clock behind the receiver's",
                         number_text(std::abs(done.clock_offset_s) < 0.005 ? 0 : done.clock_offset_s, 2) + " s");
  if (done.control_points > 0) {
    html += row("Control points",
                std::to_string(done.control_points) + ", " + number_text(done.control_rms_m, 3) + " m RMS") +
            row("Positions' common error",
                number_text(done.bias_east_m, 2) + " m east, " + number_text(done.bias_north_m, 2) + " m north");
  }
  return html;
}

std::string frames_html(const CaptureResult& done) {
  std::string html;
  std::int64_t drawn_px = 0;
  for (const CapturedFrame& frame : done.frames) drawn_px += frame.drawn_px;
  for (std::size_t i = 0; i < std::min(kMostRows, done.frames.size()); ++i) {
    const CapturedFrame& frame = done.frames[i];
    const auto metres = [](double value_m) { return number_text(value_m, 2) + " m"; };
    html += "<tr>" + heading_html(frame.file) + cell_html("Shared points", std::to_string(frame.sightings)) +
            cell_html("Reprojection error", number_text(frame.rms_px, 2) + " px") +
            cell_html("Position, east", metres(frame.residual_east_m)) +
            cell_html("Position, north", metres(frame.residual_north_m)) +
            cell_html("Height", metres(frame.residual_up_m)) +
            cell_html("Above ground", number_text(frame.agl_m, 1) + " m") +
            cell_html("Of the map", number_text(100.0 * static_cast<double>(frame.drawn_px) /
                                                    static_cast<double>(std::max<std::int64_t>(1, drawn_px)),
                                                1) +
                                        " %") +
            "</tr>\n";
  }
  return html;
}

std::vector<std::string> first_ones(const std::vector<std::string>& all) {
  if (all.size() <= kMostLines) return all;
  std::vector<std::string> first(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(kMostLines));
  first.push_back("… and " + std::to_string(all.size() - kMostLines) + " more; --json has all.");
  return first;
}

/// With two digits or three.
std::string sigma_text(double sigma_m) {
  return number_text(sigma_m, sigma_m < 0.1 ? 3 : sigma_m < 1 ? 2 : sigma_m < 10 ? 1 : 0) + " m";
}

/// What was measured, where that is worse than what the map says of itself.
bool checks_contradict(const CaptureResult& done) {
  return !done.check_points.empty() && !(done.check_ratio <= CaptureThresholds::kCheckRatioGood);
}

std::string headline(const CaptureResult& done) {
  return "± " + sigma_text(checks_contradict(done) ? done.check_rms_m : done.map_sigma_median_m);
}

std::string answer_text(const CaptureResult& done) {
  const std::string own =
      "The map's own error, one standard deviation, each axis: " + sigma_text(done.map_sigma_median_m) +
      " in the middle, at most " + sigma_text(done.map_sigma_p95_m) + " on 95 % of the map, modelled";
  if (done.check_points.empty()) return own + " and not checked. Errors of twice that are to be expected.";
  const std::string measured = std::to_string(done.check_points.size()) + " check points miss by " +
                               sigma_text(done.check_rms_m) + " (RMS, each axis), measured";
  if (checks_contradict(done))
    return "In front is what was measured: " + measured + ". " + own + ", which is too good.";
  return own + "; " + measured + ". Errors of twice that are to be expected.";
}

std::string frames_note(const CaptureResult& done) {
  std::string note =
      "Positions and heights: as measured less where the pictures put them, without what all miss alike.";
  if (done.frames.size() > kMostRows) {
    note += " The first " + std::to_string(kMostRows) + " of " + std::to_string(done.frames.size()) +
            "; --log and --json have all.";
  }
  return note;
}

}  // namespace

std::string quality_page_html(const CaptureResult& done, const QualityPageInput& input,
                              const nlohmann::ordered_json& parameters, const std::string& software_version) {
  const PictureGrid grid = picture_grid(input.map);
  const std::vector<QualityRow> rows = capture_quality(done);
  const auto count = [&](QualityStatus status) {
    return std::to_string(
        std::count_if(rows.begin(), rows.end(), [&](const auto& row) { return row.status == status; }));
  };
  std::vector<std::string> assumptions = done.assumptions;
  for (std::string& phrase : assumptions) phrase = capitalized(phrase) + ".";
  const std::vector<std::pair<std::string, std::string>> title_block{
      {"Ground sample distance", number_text(done.gsd_m, 3) + " m"},
      {"Area", number_text(done.area_m2 / 1e4, 2) + " ha"},
      {"Size", std::to_string(done.width_px) + " × " + std::to_string(done.height_px) + " px"},
      {"CRS", done.crs},
      {"Frames", std::to_string(done.frames.size())},
      {"Pairs", std::to_string(done.pairs)},
      {"Points", std::to_string(done.points)}};
  return valid_utf8(fill_template(
      page_assets::quality_html(),
      {{"title", html_escape(input.title)},
       {"word", headline(done)},
       {"head", page_head_html(headline(done) + " – " + input.title, false)},
       {"appearance", std::string(page_assets::page_appearance_html())},
       {"page_js", page_script({page_assets::page_base_js()})},
       {"answer", answer_text(done)},
       {"detail", "Of " + std::to_string(rows.size()) + " rows below " + count(QualityStatus::kGood) + " are good, " +
                      count(QualityStatus::kMarginal) + " marginal, " + count(QualityStatus::kBad) + " bad."},
       {"assumptions", list_html(assumptions)},
       {"title_block", title_block_html(title_block)},
       {"quality", quality_rows_html(rows)},
       {"warnings", list_html(first_ones(done.warnings))},
       {"left_out", list_html(first_ones(done.left_out))},
       {"pictures",
        frames_picture(done, input.map, grid) + overlap_picture(input, grid) + error_picture(done, input, grid)},
       {"alignment", shifts_html(done, input)},
       {"checks", checks_html(done)},
       {"camera", camera_html(done)},
       {"frames", frames_html(done)},
       {"frames_note", html_escape(frames_note(done))},
       {"parameters", parameters_section_html(parameters)},
       {"version", html_escape(software_version)}}));
}

}  // namespace pilotage
