#include "bench/direction_search.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

namespace pilotage {
namespace {

constexpr std::size_t kDirections = 8;
constexpr int kPartsAlong = 3;
constexpr double kGradientSigmaPx = 0.6;
constexpr double kCellSigmaPx = 0.7;
constexpr double kSurroundingsSigmaPx = 6;
constexpr double kFaintGradient = 1;  // gray values per pixel: of so much a vector has half its length
constexpr std::array<double, 2> kContrastSigmasPx{1.5, 4};
constexpr double kContrastWeight = 0.35;  // beside directions
constexpr double kFaintContrastVariance = 4;
constexpr double kMostDeviation = 3;
/// What is not compared beside what is not valid: to there smoothing and slopes carry it.
constexpr int kBesideInvalidPx = 3;
constexpr double kLeastOverlap = 0.5;
constexpr double kLeastOfPart = 0.3;  // of its pixels
constexpr int kLeastPartPixels = 16;
/// Of the mean energy of the chips under a part: with less it is divided by this.
constexpr double kLeastEnergy = 0.1;
/// A part may lie beside its place: by one pixel, by two, at so many standard deviations.
constexpr std::array<double, 2> kMoveCosts{0.25, 0.7};
constexpr double kLeastHalfWidthPx = 29;
constexpr double kMostOffPx = 1e6;

cv::Mat as_weight(const cv::Mat& valid) {
  cv::Mat weight;
  cv::Mat(valid != 0).convertTo(weight, CV_32F, 1.0 / 255);
  return weight;
}

cv::Mat smoothed(const cv::Mat& pixels, double sigma_px) {
  cv::Mat result;
  cv::GaussianBlur(pixels, result, {}, sigma_px, sigma_px);
  return result;
}

/// Shares of each pixel's gradient in the directions that it lies between.
std::vector<cv::Mat> gradient_directions(const cv::Mat& gray) {
  const cv::Mat values = smoothed(gray, kGradientSigmaPx);
  cv::Mat right;
  cv::Mat down;
  cv::Sobel(values, right, CV_32F, 1, 0, 3, 1.0 / 8);
  cv::Sobel(values, down, CV_32F, 0, 1, 3, 1.0 / 8);
  cv::Mat size;
  cv::Mat angle_rad;
  cv::cartToPolar(right, down, size, angle_rad);
  std::vector<cv::Mat> directions;
  for (std::size_t i = 0; i < kDirections; ++i) directions.push_back(cv::Mat::zeros(gray.size(), CV_32F));
  for (int y = 0; y < gray.rows; ++y) {
    std::array<float*, kDirections> rows{};
    for (std::size_t i = 0; i < kDirections; ++i) rows[i] = directions[i].ptr<float>(y);
    const auto* const sizes = size.ptr<float>(y);
    const auto* const angles = angle_rad.ptr<float>(y);
    for (int x = 0; x < gray.cols; ++x) {
      const float step = angles[x] * static_cast<float>(kDirections / (2 * std::numbers::pi));
      const auto lower = static_cast<std::size_t>(step);
      const float share = step - static_cast<float>(lower);
      rows[lower % kDirections][x] += sizes[x] * (1 - share);
      rows[(lower + 1) % kDirections][x] += sizes[x] * share;
    }
  }
  return directions;
}

cv::Mat contrast(const cv::Mat& gray, double sigma_px) {
  const cv::Mat off = gray - smoothed(gray, sigma_px);
  cv::Mat spread = smoothed(off.mul(off), sigma_px) + kFaintContrastVariance;
  cv::sqrt(spread, spread);
  cv::Mat result = off / spread;
  result = kContrastWeight * cv::min(cv::max(result, -kMostDeviation), kMostDeviation);
  return result;
}

struct TurnedFrame {
  cv::Mat gray;
  cv::Mat valid;
};

/// The frame turned about its nadir point, where it is not beyond its own rectangle then.
TurnedFrame turned(const RectifiedFrame& frame, double turn_deg) {
  const double turn = turn_deg * std::numbers::pi / 180;
  const double c = std::cos(turn);
  const double s = std::sin(turn);
  const Eigen::Vector2d nadir = frame.pixel_from_ground({0, 0});
  const Eigen::Vector2d off = Eigen::Vector2d(0.5, 0.5) - nadir;
  const cv::Matx23d map(c, s, nadir.x() + c * off.x() + s * off.y() - 0.5,  //
                        -s, c, nadir.y() - s * off.x() + c * off.y() - 0.5);
  constexpr int kFlags = cv::INTER_LINEAR | cv::WARP_INVERSE_MAP;
  TurnedFrame result;
  cv::warpAffine(frame.gray, result.gray, map, frame.gray.size(), kFlags, cv::BORDER_CONSTANT, 0);
  cv::warpAffine(frame.valid, result.valid, map, frame.gray.size(), kFlags, cv::BORDER_CONSTANT, 0);
  result.valid = result.valid == 255;
  return result;
}

/// A rectangle of a picture that may reach beyond it, where all is 0.
cv::Mat cut(const cv::Mat& picture, const cv::Rect& rect) {
  cv::Mat part = cv::Mat::zeros(rect.size(), CV_32F);
  const cv::Rect inside = rect & cv::Rect({0, 0}, picture.size());
  if (!inside.empty()) picture(inside).copyTo(part(inside - rect.tl()));
  return part;
}

/// Transforms of one size, for positions at which a template lies in a region.
class Transforms {
 public:
  Transforms(const cv::Size& region, const cv::Size& positions)
      : size_(cv::getOptimalDFTSize(region.width), cv::getOptimalDFTSize(region.height)), positions_(positions) {}

  cv::Mat spectrum(const cv::Mat& pixels) const {
    cv::Mat padded = cv::Mat::zeros(size_, CV_32F);
    pixels.copyTo(padded(cv::Rect({0, 0}, pixels.size())));
    cv::dft(padded, padded, 0, pixels.rows);
    return padded;
  }
  /// Sums of products of regions and templates, over all pairs.
  cv::Mat correlate(const std::vector<cv::Mat>& regions, const std::vector<cv::Mat>& templates) const {
    cv::Mat sum;
    cv::Mat product;
    for (std::size_t i = 0; i < regions.size(); ++i) {
      cv::mulSpectrums(regions[i], templates[i], product, 0, true);
      sum = sum.empty() ? product.clone() : cv::Mat(sum + product);
    }
    cv::dft(sum, product, cv::DFT_INVERSE | cv::DFT_SCALE | cv::DFT_REAL_OUTPUT, positions_.height);
    return product(cv::Rect({0, 0}, positions_)).clone();
  }

 private:
  cv::Size size_;
  cv::Size positions_;
};

/// The most that a part has within each distance, less what that costs.
void allow_moves(cv::Mat& surface, double spread) {
  const cv::Mat still = surface.clone();
  for (std::size_t i = 0; i < kMoveCosts.size(); ++i) {
    const int side = 2 * static_cast<int>(i) + 3;
    cv::Mat moved;
    cv::dilate(still, moved, cv::getStructuringElement(cv::MORPH_RECT, {side, side}));
    cv::max(surface, moved - kMoveCosts[i] * spread, surface);
  }
}

double spread_of(const cv::Mat& surface, double& mean) {
  cv::Scalar means;
  cv::Scalar spreads;
  cv::meanStdDev(surface, means, spreads);
  mean = means[0];
  return spreads[0];
}

/// The chips as they are compared.
struct ComparedChips {
  std::vector<cv::Mat> field;
  cv::Mat energy;  // squared length
  cv::Mat weight;
};

ComparedChips compared_chips(const ChipMosaic& mosaic) {
  ComparedChips chips{direction_field(mosaic.gray, mosaic.valid), cv::Mat::zeros(mosaic.gray.size(), CV_32F),
                      as_weight(mosaic.valid)};
  for (const cv::Mat& plane : chips.field) chips.energy += plane.mul(plane);
  return chips;
}

/// A part of the frame's rectangle, and the chips under it at all positions.
class Part {
 public:
  /// `valid` is the frame's as it stands.
  Part(const cv::Rect& rect, const cv::Mat& valid, const ComparedChips& chips, const cv::Point& first,
       const cv::Size& positions)
      : rect_(rect),
        pixels_(cv::countNonZero(valid(rect))),
        transforms_({positions.width - 1 + rect.width, positions.height - 1 + rect.height}, positions) {
    const cv::Rect region(first.x + rect.x, first.y + rect.y, positions.width - 1 + rect.width,
                          positions.height - 1 + rect.height);
    for (const cv::Mat& plane : chips.field) spectra_.push_back(transforms_.spectrum(cut(plane, region)));
    const std::vector<cv::Mat> weight{transforms_.spectrum(as_weight(valid(rect)))};
    shared_px_ = transforms_.correlate({transforms_.spectrum(cut(chips.weight, region))}, weight);
    cv::Mat energy = transforms_.correlate({transforms_.spectrum(cut(chips.energy, region))}, weight);
    energy = cv::max(energy, std::max(1e-6, kLeastEnergy * cv::mean(energy)[0]));
    cv::sqrt(energy, length_);
  }

  int pixels() const { return pixels_; }
  /// That the part shares with the chips, at each position.
  const cv::Mat& shared_px() const { return shared_px_; }

  /// In its own spread; empty where it agrees with all places alike.
  cv::Mat search(const std::vector<cv::Mat>& field, const cv::Mat& valid) const {
    const cv::Mat weight = as_weight(valid(rect_));
    std::vector<cv::Mat> templates;
    for (const cv::Mat& plane : field) {
      templates.push_back(transforms_.spectrum((plane(rect_) - cv::mean(plane(rect_), valid(rect_))).mul(weight)));
    }
    cv::Mat surface = transforms_.correlate(spectra_, templates) / length_;
    double mean = 0;
    allow_moves(surface, spread_of(surface, mean));
    const double spread = spread_of(surface, mean);
    return spread > 1e-6 ? cv::Mat((surface - mean) / spread) : cv::Mat();
  }

 private:
  cv::Rect rect_;
  int pixels_;
  Transforms transforms_;
  std::vector<cv::Mat> spectra_;
  cv::Mat shared_px_;
  cv::Mat length_;  // of what the chips have under it
};

std::vector<cv::Rect> parts_of(const cv::Mat& valid) {
  const cv::Rect used = cv::boundingRect(valid);
  std::vector<cv::Rect> parts;
  for (int row = 0; row < kPartsAlong; ++row) {
    for (int column = 0; column < kPartsAlong; ++column) {
      const cv::Point from(used.x + used.width * column / kPartsAlong, used.y + used.height * row / kPartsAlong);
      const cv::Point to(used.x + used.width * (column + 1) / kPartsAlong,
                         used.y + used.height * (row + 1) / kPartsAlong);
      const cv::Rect part(from, to);
      if (part.empty()) continue;
      const int pixels = cv::countNonZero(valid(part));
      if (pixels >= std::max<double>(kLeastPartPixels, kLeastOfPart * part.area())) parts.push_back(part);
    }
  }
  return parts;
}

/// The agreement of the turned frame at every position.
cv::Mat agreement_of(const TurnedFrame& frame, const std::vector<Part>& parts, const Checkpoint& checkpoint) {
  const std::vector<cv::Mat> field = direction_field(frame.gray, frame.valid);
  cv::Mat total;
  int count = 0;
  for (const Part& part : parts) {
    pass(checkpoint);
    const cv::Mat found = part.search(field, frame.valid);
    if (found.empty()) continue;
    total = total.empty() ? found : cv::Mat(total + found);
    ++count;
  }
  return count < kPartsAlong ? cv::Mat() : cv::Mat(total / std::sqrt(count));
}

/// Of what was compared; nothing when nothing was.
std::optional<float> median_of(const cv::Mat& agreement) {
  std::vector<float> values;
  for (int row = 0; row < agreement.rows; ++row) {
    const auto* const numbers = agreement.ptr<float>(row);
    std::copy_if(numbers, numbers + agreement.cols, std::back_inserter(values),
                 [](float value) { return value > DirectionSurface::kNotCompared; });
  }
  if (values.empty()) return std::nullopt;
  const auto middle = values.begin() + std::ssize(values) / 2;
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

bool is_usable(const RectifiedFrame& frame) {
  return frame.status == RectifyStatus::kOk && frame.gray.type() == CV_8UC1 && !frame.gray.empty() &&
         frame.valid.type() == CV_8UC1 && frame.valid.size() == frame.gray.size() && frame.gsd_m > 0 &&
         std::max(frame.gray.cols, frame.gray.rows) <= kMaxMosaicSidePx &&
         frame.pixel_from_ground({0, 0}).cwiseAbs().maxCoeff() < kMostOffPx;
}

bool is_usable(const ChipMosaic& mosaic) {
  return mosaic.gray.type() == CV_8UC1 && !mosaic.gray.empty() && mosaic.valid.type() == CV_8UC1 &&
         mosaic.valid.size() == mosaic.gray.size() && mosaic.factor >= 1;
}

}  // namespace

std::vector<cv::Mat> direction_field(const cv::Mat& gray, const cv::Mat& valid) {
  cv::Mat values;
  gray.convertTo(values, CV_32F);
  values.setTo(cv::mean(gray, valid), valid == 0);
  std::vector<cv::Mat> field = gradient_directions(values);
  cv::Mat mean = cv::Mat::zeros(gray.size(), CV_32F);
  for (cv::Mat& plane : field) {
    plane = smoothed(plane, kCellSigmaPx);
    mean += plane / static_cast<double>(kDirections);
  }
  cv::Mat length = cv::Mat::zeros(gray.size(), CV_32F);
  for (cv::Mat& plane : field) {
    plane -= mean;
    length += plane.mul(plane);
  }
  cv::sqrt(length, length);
  length += kFaintGradient;
  for (cv::Mat& plane : field) plane /= length;
  for (const double sigma_px : kContrastSigmasPx) field.push_back(contrast(values, sigma_px));
  cv::Mat inside;
  const int side = 2 * kBesideInvalidPx + 1;
  cv::erode(valid, inside, cv::getStructuringElement(cv::MORPH_RECT, {side, side}));
  for (cv::Mat& plane : field) {
    plane -= smoothed(plane, kSurroundingsSigmaPx);
    plane.setTo(0, inside == 0);
  }
  return field;
}

std::optional<DirectionSurface> search_directions(const RectifiedFrame& frame, const ChipMosaic& mosaic,
                                                  const Eigen::Vector2d& center_px, double half_width_px,
                                                  const std::vector<double>& turns_deg, const Checkpoint& checkpoint) {
  if (!is_usable(frame) || !is_usable(mosaic) || !center_px.allFinite() || !(half_width_px >= 0)) return std::nullopt;
  const Eigen::Vector2d center = mosaic.mosaic_from_level(center_px);
  const double own = std::ceil(half_width_px / mosaic.factor);
  const double half = std::max(own, kLeastHalfWidthPx);
  if (!(center.cwiseAbs().maxCoeff() < kMostOffPx) || half > kMaxMosaicSidePx) return std::nullopt;
  DirectionSurface surface;
  surface.first = {static_cast<int>(std::floor(center.x() - half)), static_cast<int>(std::floor(center.y() - half))};
  const int side = 2 * static_cast<int>(half) + 1;
  const cv::Size positions(side, side);
  surface.agreement = cv::Mat(positions, CV_32F, cv::Scalar(DirectionSurface::kNotCompared));
  const Eigen::Vector2d nadir_px = frame.pixel_from_ground({0, 0});
  const cv::Point nadir(static_cast<int>(std::lround(nadir_px.x())), static_cast<int>(std::lround(nadir_px.y())));
  const ComparedChips chips = compared_chips(mosaic);
  std::vector<Part> parts;
  cv::Mat shared_px = cv::Mat::zeros(positions, CV_32F);
  double pixels = 0;
  for (const cv::Rect& rect : parts_of(frame.valid)) {
    pass(checkpoint);
    parts.emplace_back(rect, frame.valid, chips, surface.first - nadir, positions);
    shared_px += parts.back().shared_px();
    pixels += parts.back().pixels();
  }
  if (std::ssize(parts) < kPartsAlong) return std::nullopt;
  const cv::Mat compared = shared_px >= kLeastOverlap * pixels;
  for (const double turn_deg : turns_deg) {
    const cv::Mat here = agreement_of(turned(frame, turn_deg), parts, checkpoint);
    if (!here.empty()) cv::Mat(cv::max(surface.agreement, here)).copyTo(surface.agreement, compared);
  }
  const auto median = median_of(surface.agreement);
  if (!median) return std::nullopt;
  cv::subtract(surface.agreement, *median, surface.agreement, surface.agreement > DirectionSurface::kNotCompared);
  // What was looked at for the spread alone is no place.
  const int beside = static_cast<int>(half - own);
  const cv::Rect window(beside, beside, side - 2 * beside, side - 2 * beside);
  surface.agreement = surface.agreement(window).clone();
  surface.first += window.tl();
  return surface;
}

double DirectionSurface::at(const Eigen::Vector2d& nadir_px) const {
  if (!(nadir_px.cwiseAbs().maxCoeff() < kMostOffPx)) return 0;
  const cv::Point middle(static_cast<int>(std::lround(nadir_px.x())) - first.x,
                         static_cast<int>(std::lround(nadir_px.y())) - first.y);
  const cv::Rect around = cv::Rect(middle.x - 1, middle.y - 1, 3, 3) & cv::Rect({0, 0}, agreement.size());
  if (around.empty()) return 0;
  double most = 0;
  cv::minMaxLoc(agreement(around), nullptr, &most);
  return std::max(0.0, most);
}

std::vector<Eigen::Vector2d> direction_places(const DirectionSurface& surface, std::size_t count, double exclusion_px) {
  cv::Mat left = surface.agreement.clone();
  const int reach = static_cast<int>(std::floor(std::clamp(exclusion_px, 0.0, kMostOffPx)));
  std::vector<Eigen::Vector2d> places;
  while (places.size() < count) {
    double most = 0;
    cv::Point at;
    cv::minMaxLoc(left, nullptr, &most, nullptr, &at);
    if (most <= 0) break;
    places.emplace_back(surface.first.x + at.x, surface.first.y + at.y);
    const cv::Rect around(at.x - reach, at.y - reach, 2 * reach + 1, 2 * reach + 1);
    left(around & cv::Rect({0, 0}, left.size())).setTo(DirectionSurface::kNotCompared);
  }
  return places;
}

}  // namespace pilotage
