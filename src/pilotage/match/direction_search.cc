#include "pilotage/match/direction_search.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <iterator>

#include <Eigen/Geometry>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "pilotage/base/angle.h"
#include "pilotage/match/chip_search.h"
#include "pilotage/match/highest_places.h"
#include "pilotage/match/local_contrast.h"
#include "pilotage/match/reduced_picture.h"
#include "pilotage/vision/mask_weight.h"
#include "pilotage/vision/picture_spectra.h"

namespace pilotage {
namespace {

constexpr double kGradientSigmaPx = 0.6;
constexpr double kCellSigmaPx = 0.7;
constexpr int kSurroundingsBoxPx = 15;  // twice: as wide as a Gaussian of 6 px
/// Of the terms of a direction's series, as eight bins have them that share linearly what lies between them.
constexpr std::array<float, 3> kTermWeights{0.950F, 0.811F, 0.614F};
constexpr double kFaintGradient = 1;  // gray values per pixel: of so much a vector has half its length
constexpr std::array<double, 2> kContrastSigmasPx{1.5, 4};
constexpr double kContrastWeight = 0.35;  // beside directions
/// What is not compared beside what is not valid: to there smoothing and slopes carry it.
constexpr int kBesideInvalidPx = 3;
constexpr int kPartsAlong = 3;
constexpr double kLeastOverlap = 0.5;
constexpr double kLeastOfPart = 0.3;  // of its pixels
constexpr int kLeastPartPixels = 16;
/// Of the mean energy of the chips under a part: with less it is divided by this.
constexpr double kLeastEnergy = 0.1;
/// A part may lie beside its place: by one pixel, by two, at so many standard deviations.
constexpr std::array<double, 2> kMoveCosts{0.25, 0.7};
constexpr double kLeastHalfWidthPx = 29;
/// Of positions at which a part lies on chips: fewer do not say what its spread is.
constexpr int kLeastPositions = 400;
/// Farther no turn may take a part: a frame that is seen from far aside is not turned about its nadir point in parts.
constexpr int kMostMovePx = 32;
/// What smoothing sees of the chips beside what is compared.
constexpr int kSeenBesidePx = 48;
constexpr double kMostOffPx = 1e6;

cv::Mat smoothed(const cv::Mat& pixels, double sigma_px) {
  cv::Mat result;
  cv::GaussianBlur(pixels, result, {}, sigma_px, sigma_px);
  return result;
}

/// Each pixel's gradient as cosine and sine of once, twice and three times its direction, times its size.
std::vector<cv::Mat> gradient_terms(const cv::Mat& gray) {
  const cv::Mat values = smoothed(gray, kGradientSigmaPx);
  cv::Mat right;
  cv::Mat down;
  cv::Sobel(values, right, CV_32F, 1, 0, 3, 1.0 / 8);
  cv::Sobel(values, down, CV_32F, 0, 1, 3, 1.0 / 8);
  std::vector<cv::Mat> terms;
  for (std::size_t i = 0; i < 2 * kTermWeights.size(); ++i) terms.emplace_back(gray.size(), CV_32F);
  for (int y = 0; y < gray.rows; ++y) {
    for (int x = 0; x < gray.cols; ++x) {
      const float gx = right.at<float>(y, x);
      const float gy = down.at<float>(y, x);
      const float size = std::sqrt(gx * gx + gy * gy);
      const float c = size > 0 ? gx / size : 0;
      const float s = size > 0 ? gy / size : 0;
      float cosine = gx;
      float sine = gy;
      for (std::size_t i = 0; i < kTermWeights.size(); ++i) {
        terms[2 * i].at<float>(y, x) = kTermWeights[i] * cosine;
        terms[2 * i + 1].at<float>(y, x) = kTermWeights[i] * sine;
        const float next = cosine * c - sine * s;
        sine = cosine * s + sine * c;
        cosine = next;
      }
    }
  }
  return terms;
}

cv::Mat contrast(const cv::Mat& gray, double sigma_px) {
  const cv::Mat off = gray - smoothed(gray, sigma_px);
  cv::Mat spread = smoothed(off.mul(off), sigma_px) + kFaintVariance;
  cv::sqrt(spread, spread);
  cv::Mat result = off / spread;
  result = kContrastWeight * cv::min(cv::max(result, -kMostContrast), kMostContrast);
  return result;
}

/// The mean over each pixel's surroundings.
cv::Mat surroundings(const cv::Mat& pixels) {
  const cv::Size box(kSurroundingsBoxPx, kSurroundingsBoxPx);
  cv::Mat result;
  cv::blur(pixels, result, box);
  cv::blur(result, result, box);
  return result;
}

/// A rectangle of a picture that may reach beyond it, where all is 0.
cv::Mat cut(const cv::Mat& picture, const cv::Rect& rect) {
  cv::Mat part = cv::Mat::zeros(rect.size(), CV_32F);
  const cv::Rect inside = rect & cv::Rect({0, 0}, picture.size());
  if (!inside.empty()) picture(inside).copyTo(part(inside - rect.tl()));
  return part;
}

/// Sums over the rectangle of this size at every position at which it lies inside.
cv::Mat box_sums(const cv::Mat& pixels, const cv::Size& size) {
  cv::Mat sums;
  cv::boxFilter(pixels, sums, CV_32F, size, {0, 0}, false, cv::BORDER_CONSTANT);
  return sums(cv::Rect(0, 0, pixels.cols - size.width + 1, pixels.rows - size.height + 1));
}

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

double spread_of(const cv::Mat& surface, const cv::Mat& compared, double& mean) {
  cv::Scalar means;
  cv::Scalar spreads;
  cv::meanStdDev(surface, means, spreads, compared);
  mean = means[0];
  return spreads[0];
}

/// Frame or chips at the resolution at which they are compared.
struct Picture {
  cv::Mat gray;
  cv::Mat valid;
};

Picture reduced(const cv::Mat& gray, const cv::Mat& valid, int reduction) {
  if (reduction == 1) return {gray, valid};
  return {reduced_picture(gray, reduction), reduced_mask(valid, reduction)};
}

/// How much coarser than the chips a frame is compared.
int reduction_for(double frame_side_px, double half_width_px) {
  int reduction = 1;
  while (frame_side_px > kMostDirectionSide * reduction || half_width_px > kMostDirectionReach * reduction) {
    reduction *= 2;
  }
  return reduction;
}

int smallest_side(const cv::Mat& picture) {
  return std::min(picture.cols, picture.rows);
}

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

/// How far each part lies from where it is drawn when the frame is turned about its nadir point; nothing where that is
/// farther than kMostMovePx.
std::optional<std::vector<cv::Point>> moves_of(const std::vector<cv::Rect>& parts, const Eigen::Vector2d& nadir_px,
                                               double turn_deg) {
  const Eigen::Matrix2d turn = Eigen::Rotation2Dd(turn_deg * kRadPerDeg).toRotationMatrix();
  std::vector<cv::Point> moves;
  for (const cv::Rect& part : parts) {
    const Eigen::Vector2d arm = Eigen::Vector2d(part.x + part.width / 2.0, part.y + part.height / 2.0) - nadir_px;
    const Eigen::Vector2d move = turn * arm - arm;
    if (!(move.cwiseAbs().maxCoeff() < kMostMovePx)) return std::nullopt;
    moves.emplace_back(static_cast<int>(std::lround(move.x())), static_cast<int>(std::lround(move.y())));
  }
  return moves;
}

/// The turns that take no part too far, and where each takes the parts.
struct Turns {
  std::vector<double> turns_deg;
  std::vector<std::vector<cv::Point>> moves;
  int farthest_px = 0;  // of all moves, along an axis
};

Turns turns_of(const std::vector<cv::Rect>& parts, const Eigen::Vector2d& nadir_px,
               const std::vector<double>& turns_deg) {
  Turns turns;
  for (const double turn_deg : turns_deg) {
    const auto moves = moves_of(parts, nadir_px, turn_deg);
    if (!moves) continue;
    turns.turns_deg.push_back(turn_deg);
    turns.moves.push_back(*moves);
    for (const cv::Point& move : *moves)
      turns.farthest_px = std::max({turns.farthest_px, std::abs(move.x), std::abs(move.y)});
  }
  return turns;
}

/// Frame or chips as they are compared.
struct Compared {
  std::vector<cv::Mat> field;
  cv::Mat energy;  // squared length
  cv::Mat valid;
  cv::Mat weight;  // 0 or 1
};

Compared compared(const Picture& picture) {
  Compared result{direction_field(picture.gray, picture.valid), cv::Mat::zeros(picture.gray.size(), CV_32F),
                  picture.valid, mask_weight(picture.valid)};
  for (const cv::Mat& plane : result.field) result.energy += plane.mul(plane);
  return result;
}

/// One part of the frame held against the chips at all positions.
struct PartSurface {
  cv::Mat agreement;  // in its own spread, 0 where it is not compared; empty where it agrees with all alike
  cv::Mat shared_px;  // with the chips
};

/// `first`: of the chips under the part's first pixel at the first position.
PartSurface search_part(const Compared& frame, const cv::Rect& part, const Compared& chips, const cv::Point& first,
                        const cv::Size& positions) {
  const cv::Rect region(first, cv::Size(positions.width - 1 + part.width, positions.height - 1 + part.height));
  const PictureSpectra spectra(region.size());
  const cv::Mat valid = frame.valid(part);
  cv::Mat sum;
  for (std::size_t i = 0; i < frame.field.size(); ++i) {
    const cv::Mat plane = frame.field[i](part);
    const cv::Mat centred = (plane - cv::mean(plane, valid)).mul(frame.weight(part));
    const cv::Mat product =
        PictureSpectra::product(spectra.spectrum(cut(chips.field[i], region)), spectra.spectrum(centred));
    sum = sum.empty() ? product : cv::Mat(sum + product);
  }
  PartSurface surface;
  const double known_px = cv::countNonZero(valid);
  surface.shared_px = box_sums(cut(chips.weight, region), part.size()) * (known_px / part.area());
  // Where there are no chips all is 0, which says nothing of what it is elsewhere.
  const cv::Mat compared = surface.shared_px >= kLeastOverlap * known_px;
  if (cv::countNonZero(compared) < kLeastPositions) return surface;
  cv::Mat length = box_sums(cut(chips.energy, region), part.size());
  length = cv::max(length, std::max(1e-6, kLeastEnergy * cv::mean(length, compared)[0]));
  cv::sqrt(length, length);
  cv::Mat agreement = PictureSpectra::pixels(sum, cv::Rect({0, 0}, positions)) / length;
  double mean = 0;
  allow_moves(agreement, spread_of(agreement, compared, mean));
  const double spread = spread_of(agreement, compared, mean);
  if (spread <= 1e-6) return surface;
  surface.agreement = (agreement - mean) / spread;
  surface.agreement.setTo(0, ~compared);
  return surface;
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

bool are_usable(const std::vector<double>& turns_deg) {
  return !turns_deg.empty() && turns_deg.size() <= 255 &&
         std::all_of(turns_deg.begin(), turns_deg.end(), [](double turn_deg) { return std::isfinite(turn_deg); });
}

/// For each turn the agreement of all parts that say something, the best of them and which it was. The parts' surfaces
/// reach beyond the positions by the farthest move.
void best_of_turns(const std::vector<cv::Mat>& parts, const Turns& turns, DirectionSurface& surface) {
  const auto count = std::count_if(parts.begin(), parts.end(), [](const cv::Mat& part) { return !part.empty(); });
  const double root = std::sqrt(static_cast<double>(count));
  for (std::size_t turn = 0; turn < turns.moves.size(); ++turn) {
    cv::Mat total = cv::Mat::zeros(surface.agreement.size(), CV_32F);
    for (std::size_t i = 0; i < parts.size(); ++i) {
      const cv::Rect here(turns.moves[turn][i] + cv::Point(turns.farthest_px, turns.farthest_px), total.size());
      if (!parts[i].empty()) total += parts[i](here);
    }
    total /= root;
    const cv::Mat better = total > surface.agreement;
    total.copyTo(surface.agreement, better);
    surface.turn.setTo(static_cast<double>(turn), better);
  }
}

}  // namespace

std::vector<cv::Mat> direction_field(const cv::Mat& gray, const cv::Mat& valid) {
  cv::Mat values;
  gray.convertTo(values, CV_32F);
  values.setTo(cv::mean(gray, valid), valid == 0);
  std::vector<cv::Mat> field = gradient_terms(values);
  cv::Mat length = cv::Mat::zeros(gray.size(), CV_32F);
  for (cv::Mat& plane : field) {
    plane = smoothed(plane, kCellSigmaPx);
    length += plane.mul(plane);
  }
  cv::sqrt(length, length);
  length += kFaintGradient;
  for (cv::Mat& plane : field) plane /= length;
  for (const double sigma_px : kContrastSigmasPx) field.push_back(contrast(values, sigma_px));
  cv::Mat inside;
  const int side = 2 * kBesideInvalidPx + 1;
  cv::erode(valid, inside, cv::getStructuringElement(cv::MORPH_RECT, {side, side}));
  const cv::Mat outside = inside == 0;
  for (cv::Mat& plane : field) {
    plane -= surroundings(plane);
    plane.setTo(0, outside);
  }
  return field;
}

std::optional<DirectionSurface> search_directions(const RectifiedFrame& frame, const ChipMosaic& mosaic,
                                                  const Eigen::Vector2d& center_px, double half_width_px,
                                                  const std::vector<double>& turns_deg, const Checkpoint& checkpoint) {
  if (!can_be_compared(frame) || !can_be_compared(mosaic) || !are_usable(turns_deg)) return std::nullopt;
  if (!center_px.allFinite() || !(half_width_px >= 0 && half_width_px < kMostOffPx)) return std::nullopt;
  const int reduction = reduction_for(std::max(frame.gray.cols, frame.gray.rows), half_width_px / mosaic.factor);
  if (std::min(smallest_side(frame.gray), smallest_side(mosaic.gray)) < reduction) return std::nullopt;
  const Eigen::Vector2d center = mosaic.mosaic_from_level(center_px) / reduction;
  const double own = std::ceil(half_width_px / (mosaic.factor * reduction));
  const double half = std::max(own, kLeastHalfWidthPx);
  if (!(center.cwiseAbs().maxCoeff() < kMostOffPx)) return std::nullopt;
  if (!(frame.pixel_from_ground({0, 0}).cwiseAbs().maxCoeff() < kMostOffPx)) return std::nullopt;
  const Picture picture = reduced(frame.gray, frame.valid, reduction);
  const Eigen::Vector2d nadir_px = frame.pixel_from_ground({0, 0}) / reduction;
  const std::vector<cv::Rect> parts = parts_of(picture.valid);
  if (std::ssize(parts) < kPartsAlong || cv::countNonZero(picture.valid) < kLeastDirectionPixels) return std::nullopt;
  const Turns turns = turns_of(parts, nadir_px, turns_deg);
  if (turns.moves.empty()) return std::nullopt;
  const int margin = turns.farthest_px;
  const cv::Point first(static_cast<int>(std::lround(center.x() - half)),
                        static_cast<int>(std::lround(center.y() - half)));
  const int side = 2 * static_cast<int>(half) + 1;
  const cv::Size positions(side, side);
  const cv::Size grown(side + 2 * margin, side + 2 * margin);
  const cv::Point nadir(static_cast<int>(std::lround(nadir_px.x())), static_cast<int>(std::lround(nadir_px.y())));
  // Of the chips what the parts can lie on: memory does not grow with the mosaic.
  const cv::Rect used = cv::boundingRect(picture.valid);
  const int beside_px = margin + kSeenBesidePx;
  const cv::Rect on_chips =
      cv::Rect(first - nadir + used.tl() - cv::Point(beside_px, beside_px),
               cv::Size(side - 1 + used.width + 2 * beside_px, side - 1 + used.height + 2 * beside_px)) &
      cv::Rect(0, 0, mosaic.gray.cols / reduction, mosaic.gray.rows / reduction);
  if (on_chips.empty()) return std::nullopt;
  const cv::Rect on_mosaic(on_chips.tl() * reduction, on_chips.size() * reduction);
  pass(checkpoint);
  const Compared chips = compared(reduced(mosaic.gray(on_mosaic), mosaic.valid(on_mosaic), reduction));
  pass(checkpoint);
  const Compared seen = compared(picture);
  std::vector<cv::Mat> surfaces;
  cv::Mat shared_px = cv::Mat::zeros(positions, CV_32F);
  for (const cv::Rect& part : parts) {
    pass(checkpoint);
    const PartSurface found =
        search_part(seen, part, chips, first - nadir + part.tl() - cv::Point(margin, margin) - on_chips.tl(), grown);
    surfaces.push_back(found.agreement);
    shared_px += found.shared_px(cv::Rect(cv::Point(margin, margin), positions));
  }
  if (std::count_if(surfaces.begin(), surfaces.end(), [](const cv::Mat& one) { return !one.empty(); }) < kPartsAlong) {
    return std::nullopt;
  }
  DirectionSurface surface;
  surface.turns_deg = turns.turns_deg;
  surface.agreement = cv::Mat(positions, CV_32F, cv::Scalar(DirectionSurface::kNotCompared));
  surface.turn = cv::Mat::zeros(positions, CV_8UC1);
  best_of_turns(surfaces, turns, surface);
  double known_px = 0;
  for (const cv::Rect& part : parts) known_px += cv::countNonZero(picture.valid(part));
  surface.agreement.setTo(DirectionSurface::kNotCompared, shared_px < kLeastOverlap * known_px);
  const auto median = median_of(surface.agreement);
  if (!median) return std::nullopt;
  cv::subtract(surface.agreement, *median, surface.agreement, surface.agreement > DirectionSurface::kNotCompared);
  // What was looked at for the spread alone is no place.
  const int beside = static_cast<int>(half - own);
  const cv::Rect window(beside, beside, side - 2 * beside, side - 2 * beside);
  surface.agreement = surface.agreement(window).clone();
  surface.turn = surface.turn(window).clone();
  const Eigen::Vector2d rounded(nadir_px.x() - nadir.x, nadir_px.y() - nadir.y);
  surface.step_px = mosaic.factor * reduction;
  surface.first_px =
      mosaic.level_from_mosaic(reduction * (Eigen::Vector2d(first.x + window.x, first.y + window.y) + rounded));
  return surface;
}

double DirectionSurface::at(const Eigen::Vector2d& nadir_px) const {
  const Eigen::Vector2d place = (nadir_px - first_px) / step_px;
  if (!place.allFinite() || !(place.cwiseAbs().maxCoeff() < kMostOffPx)) return 0;
  const cv::Point middle(static_cast<int>(std::lround(place.x())), static_cast<int>(std::lround(place.y())));
  const cv::Rect around = cv::Rect(middle.x - 1, middle.y - 1, 3, 3) & cv::Rect({0, 0}, agreement.size());
  if (around.empty()) return 0;
  double most = 0;
  cv::minMaxLoc(agreement(around), nullptr, &most);
  return std::max(0.0, most);
}

std::vector<DirectionPlace> direction_places(const DirectionSurface& surface, std::size_t count, double exclusion_px) {
  const int exclusion = static_cast<int>(std::floor(std::clamp(exclusion_px / surface.step_px, 0.0, kMostOffPx)));
  std::vector<DirectionPlace> places;
  for (const cv::Point& at : highest_places(surface.agreement, count, exclusion)) {
    places.push_back({surface.first_px + surface.step_px * Eigen::Vector2d(at.x, at.y),
                      surface.turns_deg[surface.turn.at<std::uint8_t>(at)], surface.agreement.at<float>(at)});
  }
  return places;
}

double direction_search_bytes(double frame_side_px, double half_width_px) {
  const double side_px = std::min<double>(frame_side_px, kMostDirectionSide);
  const double reach = std::clamp<double>(half_width_px + 1, kLeastHalfWidthPx, kMostDirectionReach + 1);
  const double positions = 2 * (reach + kMostMovePx) + 1;
  const double region = 1.1 * (positions + side_px + 2 * kSeenBesidePx) + 16;
  constexpr double kRegionPlanes = 24;    // of floats: field, its copies while it is made, spectra, sums
  constexpr double kPositionPlanes = 16;  // one of each part, and what is made of them
  return 4 * (kRegionPlanes * region * region + kPositionPlanes * positions * positions);
}

}  // namespace pilotage
