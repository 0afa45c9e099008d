#include "pilotage/capture/color_balance.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include <Eigen/Dense>

namespace pilotage {
namespace {

/// Darker or lighter values have been cut off.
constexpr double kDarkest = 8;
constexpr double kLightest = 247;
constexpr double kGainSigma = 0.5;
constexpr double kFalloffSigma = 0.5;
constexpr double kMissWidth = 0.1;
constexpr std::size_t kMostPoints = 40'000;

/// A point in a frame: logarithm of its value, and r² there.
struct Shade {
  Eigen::Index frame;
  double log_value;
  double r2;
};

std::optional<Shade> shade_at(const cv::Mat& small, const Camera& camera, int frame, const Eigen::Vector2d& pixel,
                              int channel) {
  const Eigen::Vector2d size(camera.width_px, camera.height_px);
  const int x = std::clamp(static_cast<int>(pixel.x() * small.cols / size.x()), 1, small.cols - 2);
  const int y = std::clamp(static_cast<int>(pixel.y() * small.rows / size.y()), 1, small.rows - 2);
  double sum = 0;
  for (int row = y - 1; row <= y + 1; ++row) {
    for (int col = x - 1; col <= x + 1; ++col) sum += small.at<cv::Vec3b>(row, col)[channel];
  }
  if (sum / 9 < kDarkest || sum / 9 > kLightest) return std::nullopt;
  return Shade{frame, std::log(sum / 9), (pixel - size / 2).squaredNorm() / (size / 2).squaredNorm()};
}

using ShadePair = std::pair<Shade, Shade>;

std::vector<ShadePair> shade_pairs(const std::vector<FramePicture>& pictures, const AdjustedBlock& block, int channel) {
  std::vector<ShadePair> pairs;
  const std::size_t step = std::max<std::size_t>(1, block.points.size() / kMostPoints);
  for (std::size_t i = 0; i < block.points.size(); i += step) {
    std::optional<Shade> before;
    for (const Sighting& one : block.points[i].sightings) {
      const FramePicture& picture = pictures[static_cast<std::size_t>(one.frame)];
      const auto shade = shade_at(picture.small, block.camera, one.frame,
                                  picture.features.pixels[static_cast<std::size_t>(one.feature)], channel);
      if (shade && before) pairs.emplace_back(*before, *shade);
      if (shade) before = shade;
    }
  }
  return pairs;
}

}  // namespace

ColorBalance balance_colors(const std::vector<FramePicture>& pictures, const AdjustedBlock& block) {
  const auto frames = static_cast<Eigen::Index>(pictures.size());
  ColorBalance balance;
  balance.log_gain.resize(pictures.size());
  for (int channel = 0; channel < 3; ++channel) {
    const std::vector<ShadePair> pairs = shade_pairs(pictures, block, channel);
    Eigen::VectorXd solution = Eigen::VectorXd::Zero(frames + 2);
    for (int round = 0; round < 5; ++round) {
      Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(frames + 2, frames + 2);
      Eigen::VectorXd right = Eigen::VectorXd::Zero(frames + 2);
      normal.diagonal().head(frames).setConstant(1 / (kGainSigma * kGainSigma));
      normal.diagonal().tail(2).setConstant(1 / (kFalloffSigma * kFalloffSigma));
      for (const auto& [first, second] : pairs) {
        const std::array<std::pair<Eigen::Index, double>, 4> row{
            {{first.frame, 1},
             {second.frame, -1},
             {frames, first.r2 - second.r2},
             {frames + 1, first.r2 * first.r2 - second.r2 * second.r2}}};
        const double seen = first.log_value - second.log_value;
        double miss = -seen;
        for (const auto& [at, factor] : row) miss += factor * solution[at];
        const double weight = round == 0 ? 1 : 1 / (1 + miss * miss / (kMissWidth * kMissWidth));
        for (const auto& [at, factor] : row) {
          right[at] += weight * factor * seen;
          for (const auto& [other, other_factor] : row) normal(at, other) += weight * factor * other_factor;
        }
      }
      solution = normal.ldlt().solve(right);
    }
    const double mean = solution.head(frames).mean();
    const auto of_channel = static_cast<std::size_t>(channel);
    for (Eigen::Index i = 0; i < frames; ++i) {
      balance.log_gain[static_cast<std::size_t>(i)][of_channel] = solution[i] - mean;
    }
    balance.falloff[of_channel] = {solution[frames], solution[frames + 1]};
  }
  return balance;
}

}  // namespace pilotage
