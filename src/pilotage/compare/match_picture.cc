#include "pilotage/compare/match_picture.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "pilotage/base/error.h"
#include "pilotage/base/text.h"

namespace pilotage {
namespace {

constexpr int kMaxWidthPx = 1600;
constexpr int kMaxHeightPx = 900;
constexpr int kGapPx = 12;
constexpr int kTitlePx = 60;
constexpr double kDashPx = 9;
const cv::Scalar kBlue(178, 114, 0);
const cv::Scalar kOrange(0, 94, 213);
const cv::Scalar kWhite(255, 255, 255);
const cv::Scalar kBlack(0, 0, 0);

/// An image in the picture: shrunk or enlarged to `scale`, its corner at `corner`.
struct Panel {
  double scale = 1;
  cv::Point corner;

  cv::Point2d at(const Eigen::Vector2d& pixel) const {
    return {corner.x + pixel.x() * scale, corner.y + pixel.y() * scale};
  }
};

cv::Size scaled_size(const cv::Mat& image, double scale) {
  return {std::max(1, static_cast<int>(std::lround(image.cols * scale))),
          std::max(1, static_cast<int>(std::lround(image.rows * scale)))};
}

void place(const cv::Mat& gray, const Panel& panel, cv::Mat& picture) {
  cv::Mat scaled;
  const cv::Size size = scaled_size(gray, panel.scale);
  cv::resize(gray, scaled, size, 0, 0, panel.scale < 1 ? cv::INTER_AREA : cv::INTER_LINEAR);
  cv::cvtColor(scaled, scaled, cv::COLOR_GRAY2BGR);
  scaled.copyTo(picture(cv::Rect(panel.corner, size)));
}

// Each stroke has a white border, so that it shows on any ground.
void stroke(cv::Mat& picture, cv::Point2d from, cv::Point2d to, const cv::Scalar& color) {
  cv::line(picture, from, to, kWhite, 4, cv::LINE_AA);
  cv::line(picture, from, to, color, 2, cv::LINE_AA);
}

void draw_line(cv::Mat& picture, cv::Point2d from, cv::Point2d to, bool solid) {
  if (solid) return stroke(picture, from, to, kBlue);
  const double length = std::hypot(to.x - from.x, to.y - from.y);
  if (length == 0) return;
  const cv::Point2d along = (to - from) / length;
  for (double at = 0; at < length; at += 2 * kDashPx) {
    stroke(picture, from + along * at, from + along * std::min(length, at + kDashPx), kOrange);
  }
}

void draw_end(cv::Mat& picture, cv::Point2d at, bool agrees) {
  if (agrees) {
    cv::circle(picture, at, 6, kWhite, 4, cv::LINE_AA);
    cv::circle(picture, at, 6, kBlue, 2, cv::LINE_AA);
  } else {
    cv::drawMarker(picture, at, kWhite, cv::MARKER_TILTED_CROSS, 14, 5, cv::LINE_AA);
    cv::drawMarker(picture, at, kOrange, cv::MARKER_TILTED_CROSS, 12, 2, cv::LINE_AA);
  }
}

void write_legend(cv::Mat& picture, const std::string& title, double tolerance_m) {
  cv::putText(picture, title, {8, 22}, cv::FONT_HERSHEY_SIMPLEX, 0.6, kBlack, 1, cv::LINE_AA);
  const double y = 44;
  draw_line(picture, {8, y}, {68, y}, true);
  cv::putText(picture, "within " + format_number(tolerance_m) + " m of the truth", {78, 49}, cv::FONT_HERSHEY_SIMPLEX,
              0.45, kBlack, 1, cv::LINE_AA);
  draw_line(picture, {308, y}, {368, y}, false);
  cv::putText(picture, "not", {378, 49}, cv::FONT_HERSHEY_SIMPLEX, 0.45, kBlack, 1, cv::LINE_AA);
}

}  // namespace

cv::Mat draw_matches(std::string_view title, const cv::Mat& frame, const cv::Mat& reference,
                     const std::vector<JudgedMatch>& matches, double tolerance_m) {
  if (frame.type() != CV_8UC1 || reference.type() != CV_8UC1 || frame.empty() || reference.empty()) {
    throw UsageError("a picture of matches needs two gray images of 8 bits");
  }
  const double half_width = (kMaxWidthPx - kGapPx) / 2.0;
  const auto fitting = [&](const cv::Mat& image) {
    return std::min({2.0, half_width / image.cols, static_cast<double>(kMaxHeightPx) / image.rows});
  };
  const Panel left{fitting(frame), {0, kTitlePx}};
  const cv::Size left_size = scaled_size(frame, left.scale);
  const Panel right{fitting(reference), {left_size.width + kGapPx, kTitlePx}};
  const cv::Size right_size = scaled_size(reference, right.scale);
  const int width = std::max(right.corner.x + right_size.width, 480);
  cv::Mat picture(kTitlePx + std::max(left_size.height, right_size.height), width, CV_8UC3, kWhite);
  place(frame, left, picture);
  place(reference, right, picture);

  const auto agreeing = std::count_if(matches.begin(), matches.end(), [](const JudgedMatch& m) { return m.agrees; });
  for (const bool agrees : {false, true}) {
    for (const JudgedMatch& match : matches) {
      if (match.agrees != agrees) continue;
      draw_line(picture, left.at(match.frame_px), right.at(match.reference_px), agrees);
      draw_end(picture, left.at(match.frame_px), agrees);
      draw_end(picture, right.at(match.reference_px), agrees);
    }
  }
  write_legend(picture,
               std::string(title) + ": " + std::to_string(agreeing) + " of the " + std::to_string(matches.size()) +
                   " best matches agree with the truth",
               tolerance_m);
  return picture;
}

std::string png_bytes(const cv::Mat& bgr) {
  std::vector<std::uint8_t> bytes;
  if (!cv::imencode(".png", bgr, bytes)) throw DataError("a picture of matches could not be encoded as PNG");
  return {bytes.begin(), bytes.end()};
}

}  // namespace pilotage
