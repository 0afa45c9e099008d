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
const cv::Scalar kYellow(66, 228, 240);
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

// Two pixels of the picture: thousands of them leave the ground to be seen.
void dot(cv::Mat& picture, cv::Point2d at) {
  const cv::Rect pixels(static_cast<int>(std::floor(at.x)), static_cast<int>(std::floor(at.y)), 2, 2);
  picture(pixels & cv::Rect({0, 0}, picture.size())).setTo(kYellow);
}

void place(const FeaturedImage& image, const Panel& panel, cv::Mat& picture) {
  cv::Mat scaled;
  const cv::Size size = scaled_size(image.gray, panel.scale);
  cv::resize(image.gray, scaled, size, 0, 0, panel.scale < 1 ? cv::INTER_AREA : cv::INTER_LINEAR);
  cv::cvtColor(scaled, scaled, cv::COLOR_GRAY2BGR);
  scaled.copyTo(picture(cv::Rect(panel.corner, size)));
  for (const Eigen::Vector2d& feature : image.features_px) dot(picture, panel.at(feature));
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

void write_legend(cv::Mat& picture, const std::string& title, double tolerance_m, std::size_t frame_features,
                  std::size_t reference_features) {
  cv::putText(picture, title, {8, 22}, cv::FONT_HERSHEY_SIMPLEX, 0.6, kBlack, 1, cv::LINE_AA);
  const double y = 44;
  draw_line(picture, {8, y}, {68, y}, true);
  cv::putText(picture, "within " + format_number(tolerance_m) + " m of the truth", {78, 49}, cv::FONT_HERSHEY_SIMPLEX,
              0.45, kBlack, 1, cv::LINE_AA);
  draw_line(picture, {308, y}, {368, y}, false);
  cv::putText(picture, "not", {378, 49}, cv::FONT_HERSHEY_SIMPLEX, 0.45, kBlack, 1, cv::LINE_AA);
  cv::rectangle(picture, cv::Rect(426, 40, 8, 8), kBlack, 1);
  cv::rectangle(picture, cv::Rect(427, 41, 6, 6), kYellow, cv::FILLED);
  cv::putText(picture, "features: " + std::to_string(frame_features) + " and " + std::to_string(reference_features),
              {442, 49}, cv::FONT_HERSHEY_SIMPLEX, 0.45, kBlack, 1, cv::LINE_AA);
}

}  // namespace

cv::Mat draw_matches(std::string_view title, const FeaturedImage& frame, const FeaturedImage& reference,
                     const std::vector<JudgedMatch>& matches, double tolerance_m) {
  if (frame.gray.type() != CV_8UC1 || reference.gray.type() != CV_8UC1 || frame.gray.empty() ||
      reference.gray.empty()) {
    throw UsageError("a picture of matches needs two gray images of 8 bits");
  }
  const double half_width = (kMaxWidthPx - kGapPx) / 2.0;
  const auto fitting = [&](const cv::Mat& image) {
    return std::min({2.0, half_width / image.cols, static_cast<double>(kMaxHeightPx) / image.rows});
  };
  const Panel left{fitting(frame.gray), {0, kTitlePx}};
  const cv::Size left_size = scaled_size(frame.gray, left.scale);
  const Panel right{fitting(reference.gray), {left_size.width + kGapPx, kTitlePx}};
  const cv::Size right_size = scaled_size(reference.gray, right.scale);
  const int width = std::max(right.corner.x + right_size.width, 680);
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
               tolerance_m, frame.features_px.size(), reference.features_px.size());
  return picture;
}

std::string png_bytes(const cv::Mat& bgr) {
  std::vector<std::uint8_t> bytes;
  if (!cv::imencode(".png", bgr, bytes)) throw DataError("a picture of matches could not be encoded as PNG");
  return {bytes.begin(), bytes.end()};
}

}  // namespace pilotage
