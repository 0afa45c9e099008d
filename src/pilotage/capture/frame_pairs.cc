#include "pilotage/capture/frame_pairs.h"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <numbers>
#include <optional>
#include <set>

#include <Eigen/Dense>
#include <opencv2/calib3d.hpp>
#include <opencv2/core/eigen.hpp>

#include "pilotage/base/parallel.h"
#include "pilotage/capture/match_folder.h"

namespace pilotage {
namespace {

constexpr int kSectors = 8;
constexpr std::size_t kNeighboursOfSector = 2;
constexpr int kCoarsest = 2000;
constexpr double kRatio = 0.8;  // Lowe's
constexpr int kFewestOnHomography = 15;
constexpr std::size_t kFewestMatches = 20;
/// Ground that is not flat leaves the homography: by this share of the picture's side it may.
constexpr double kReliefShare = 0.03;
/// Pictures of one flight, seen from heights that differ by less than a factor of two.
constexpr double kLargestScale = 2.5;

using Descriptors = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

Descriptors unit_rows(const cv::Mat& bytes, int count) {
  Descriptors rows(count, bytes.cols);
  for (int row = 0; row < count; ++row) {
    const auto* from = bytes.ptr<std::uint8_t>(row);
    for (int col = 0; col < bytes.cols; ++col) rows(row, col) = static_cast<float>(from[col]);
  }
  return rows.rowwise().normalized();
}

/// |a − b|² of unit vectors.
double distance_squared(double cosine) {
  return std::max(0.0, 2 - 2 * cosine);
}

/// The best of a row and whether it stands out.
struct Best {
  int index = -1;
  double cosine = -1;
  double second_cosine = -1;

  void look_at(int candidate, double value) {
    if (value > cosine) {
      second_cosine = cosine;
      cosine = value;
      index = candidate;
    } else if (value > second_cosine) {
      second_cosine = value;
    }
  }
  bool stands_out() const {
    return index >= 0 && distance_squared(cosine) < kRatio * kRatio * distance_squared(second_cosine);
  }
};

FeatureMatches match_coarsest(const FrameFeatures& first, const FrameFeatures& second) {
  const int rows = std::min(kCoarsest, first.descriptors.rows);
  const int cols = std::min(kCoarsest, second.descriptors.rows);
  const Descriptors cosines = unit_rows(first.descriptors, rows) * unit_rows(second.descriptors, cols).transpose();
  std::vector<Best> of_second(static_cast<std::size_t>(cols));
  std::vector<Best> of_first(static_cast<std::size_t>(rows));
  for (int row = 0; row < rows; ++row) {
    for (int col = 0; col < cols; ++col) {
      const double cosine = static_cast<double>(cosines(row, col));
      of_first[static_cast<std::size_t>(row)].look_at(col, cosine);
      of_second[static_cast<std::size_t>(col)].look_at(row, cosine);
    }
  }
  FeatureMatches matches;
  for (int row = 0; row < rows; ++row) {
    const Best& best = of_first[static_cast<std::size_t>(row)];
    if (best.stands_out() && of_second[static_cast<std::size_t>(best.index)].index == row) {
      matches.push_back({row, best.index});
    }
  }
  return matches;
}

std::vector<cv::Point2d> points_of(const FeatureMatches& matches, const FrameFeatures& features, std::size_t side) {
  std::vector<cv::Point2d> points;
  points.reserve(matches.size());
  for (const auto& match : matches) {
    const Eigen::Vector2d& pixel = features.pixels[static_cast<std::size_t>(match[side])];
    points.emplace_back(pixel.x(), pixel.y());
  }
  return points;
}

/// Longest side that the features cover: what distances in the picture are measured by.
double extent_px(const FrameFeatures& features) {
  double extent = 0;
  for (const Eigen::Vector2d& pixel : features.pixels) extent = std::max(extent, pixel.maxCoeff());
  return extent;
}

Eigen::Vector2d mapped(const Eigen::Matrix3d& homography, const Eigen::Vector2d& pixel) {
  return (homography * pixel.homogeneous()).hnormalized();
}

/// Not mirrored, not bent over, and of about the same scale in the middle of what matched.
bool is_view_of_ground(const Eigen::Matrix3d& homography, const Eigen::Vector2d& middle) {
  const double w = (homography.row(2) * middle.homogeneous())(0);
  if (!homography.allFinite() || std::abs(w) < 1e-12) return false;
  const double area = homography.determinant() / (w * w * w);
  return area > 1 / (kLargestScale * kLargestScale) && area < kLargestScale * kLargestScale;
}

std::optional<Eigen::Matrix3d> find_homography(const FeatureMatches& matches, const FrameFeatures& first,
                                               const FrameFeatures& second) {
  if (matches.size() < kFewestOnHomography) return std::nullopt;
  const double tolerance_px = 0.25 * kReliefShare * extent_px(second);
  const std::vector<cv::Point2d> from = points_of(matches, first, 0);
  cv::Mat inliers;
  const cv::Mat found =
      cv::findHomography(from, points_of(matches, second, 1), cv::USAC_MAGSAC, tolerance_px, inliers, 5000, 0.999);
  if (found.empty() || cv::countNonZero(inliers) < kFewestOnHomography) return std::nullopt;
  Eigen::Matrix3d homography;
  cv::cv2eigen(found, homography);
  Eigen::Vector2d middle(0, 0);
  for (const cv::Point2d& point : from) middle += Eigen::Vector2d(point.x, point.y) / static_cast<double>(from.size());
  if (!is_view_of_ground(homography, middle)) return std::nullopt;
  return homography;
}

/// Features of a frame by the square they lie in.
class FeatureSquares {
 public:
  FeatureSquares(const FrameFeatures& features, double side_px)
      : side_px_(side_px), columns_(1 + static_cast<int>(extent_px(features) / side_px)) {
    squares_.resize(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(columns_));
    for (std::size_t i = 0; i < features.pixels.size(); ++i) {
      squares_[square(column_of(features.pixels[i].x()), column_of(features.pixels[i].y()))].push_back(
          static_cast<int>(i));
    }
  }

  template <class Use>
  void around(const Eigen::Vector2d& pixel, const Use& use) const {
    const int column = column_of(pixel.x());
    const int row = column_of(pixel.y());
    for (int y = std::max(0, row - 1); y <= std::min(columns_ - 1, row + 1); ++y) {
      for (int x = std::max(0, column - 1); x <= std::min(columns_ - 1, column + 1); ++x) {
        for (const int index : squares_[square(x, y)]) use(index);
      }
    }
  }

 private:
  int column_of(double coordinate_px) const {
    return static_cast<int>(std::floor(std::clamp(coordinate_px / side_px_, -2.0, columns_ + 2.0)));
  }
  std::size_t square(int column, int row) const {
    return static_cast<std::size_t>(std::clamp(row, 0, columns_ - 1)) * static_cast<std::size_t>(columns_) +
           static_cast<std::size_t>(std::clamp(column, 0, columns_ - 1));
  }

  double side_px_;
  int columns_;
  std::vector<std::vector<int>> squares_;
};

FeatureMatches match_guided(const FrameFeatures& first, const FrameFeatures& second,
                            const Eigen::Matrix3d& second_from_first) {
  const double radius_px = kReliefShare * extent_px(second);
  const FeatureSquares squares(second, radius_px);
  const Descriptors of_first = unit_rows(first.descriptors, first.descriptors.rows);
  const Descriptors of_second = unit_rows(second.descriptors, second.descriptors.rows);
  std::vector<Best> takers(second.pixels.size());
  std::vector<Best> best(first.pixels.size());
  for (std::size_t i = 0; i < first.pixels.size(); ++i) {
    const Eigen::Vector2d expected = mapped(second_from_first, first.pixels[i]);
    if (!expected.allFinite()) continue;
    squares.around(expected, [&](int j) {
      const auto index = static_cast<std::size_t>(j);
      if ((second.pixels[index] - expected).squaredNorm() > radius_px * radius_px) return;
      // SIFT finds some corners several times, with different orientations: they are no rivals of each other.
      const double cosine = static_cast<double>(of_first.row(static_cast<Eigen::Index>(i)).dot(of_second.row(j)));
      if (best[i].index >= 0 &&
          (second.pixels[static_cast<std::size_t>(best[i].index)] - second.pixels[index]).squaredNorm() < 1) {
        if (cosine > best[i].cosine) {
          best[i].cosine = cosine;
          best[i].index = j;
        }
      } else {
        best[i].look_at(j, cosine);
      }
      takers[index].look_at(static_cast<int>(i), cosine);
    });
  }
  FeatureMatches matches;
  for (std::size_t i = 0; i < best.size(); ++i) {
    if (!best[i].stands_out()) continue;
    if (takers[static_cast<std::size_t>(best[i].index)].index != static_cast<int>(i)) continue;
    matches.push_back({static_cast<int>(i), best[i].index});
  }
  return matches;
}

/// Those of `matches` that one epipolar geometry explains.
FeatureMatches of_one_geometry(const FeatureMatches& matches, const FrameFeatures& first, const FrameFeatures& second) {
  if (matches.size() < kFewestMatches) return {};
  const double tolerance_px = 3 * std::max(first.pixel_sigma_px, second.pixel_sigma_px);
  cv::Mat inliers;
  const cv::Mat found = cv::findFundamentalMat(points_of(matches, first, 0), points_of(matches, second, 1),
                                               cv::USAC_MAGSAC, tolerance_px, 0.999, 5000, inliers);
  if (found.empty()) return {};
  FeatureMatches kept;
  for (std::size_t i = 0; i < matches.size(); ++i) {
    if (inliers.at<std::uint8_t>(static_cast<int>(i)) != 0) kept.push_back(matches[i]);
  }
  return kept;
}

FeatureMatches kept_matches(const FrameFeatures& first, const FrameFeatures& second, MatchFolder& folder) {
  if (std::optional<FeatureMatches> kept = folder.find_matches(first, second)) return *std::move(kept);
  FeatureMatches matches = match_frames(first, second);
  folder.keep_matches(first, second, matches);
  return matches;
}

}  // namespace

std::vector<std::array<int, 2>> neighbouring_frames(const std::vector<Eigen::Vector2d>& nadirs_en_m) {
  std::set<std::array<int, 2>> pairs;
  const auto add = [&](std::size_t i, std::size_t j) {
    pairs.insert({static_cast<int>(std::min(i, j)), static_cast<int>(std::max(i, j))});
  };
  for (std::size_t i = 0; i < nadirs_en_m.size(); ++i) {
    std::array<std::vector<std::pair<double, std::size_t>>, kSectors> others;
    for (std::size_t j = 0; j < nadirs_en_m.size(); ++j) {
      if (j == i) continue;
      const Eigen::Vector2d apart_m = nadirs_en_m[j] - nadirs_en_m[i];
      const double turn = (std::atan2(apart_m.y(), apart_m.x()) + std::numbers::pi) / (2 * std::numbers::pi);
      const int sector = std::clamp(static_cast<int>(turn * kSectors), 0, kSectors - 1);
      others[static_cast<std::size_t>(sector)].emplace_back(apart_m.squaredNorm(), j);
    }
    for (auto& of_sector : others) {
      const std::size_t count = std::min(kNeighboursOfSector, of_sector.size());
      std::partial_sort(of_sector.begin(), of_sector.begin() + static_cast<std::ptrdiff_t>(count), of_sector.end());
      for (std::size_t k = 0; k < count; ++k) add(i, of_sector[k].second);
    }
    if (i > 0) add(i - 1, i);
  }
  return {pairs.begin(), pairs.end()};
}

FeatureMatches match_frames(const FrameFeatures& first, const FrameFeatures& second) {
  if (first.pixels.size() < kFewestMatches || second.pixels.size() < kFewestMatches) return {};
  const auto homography = find_homography(match_coarsest(first, second), first, second);
  if (!homography) return {};
  FeatureMatches matches = of_one_geometry(match_guided(first, second, *homography), first, second);
  if (matches.size() < kFewestMatches) matches.clear();
  return matches;
}

std::vector<FramePair> match_pairs(const std::vector<std::array<int, 2>>& pairs,
                                   const std::vector<FramePicture>& pictures, MatchFolder* folder, int threads,
                                   const Progress& progress) {
  std::vector<FeatureMatches> found(pairs.size());
  std::mutex reporting;
  std::int64_t done = 0;
  parallel_for(pairs.size(), threads, [&](std::size_t i, int) {
    const FrameFeatures& first = pictures[static_cast<std::size_t>(pairs[i][0])].features;
    const FrameFeatures& second = pictures[static_cast<std::size_t>(pairs[i][1])].features;
    found[i] = folder != nullptr ? kept_matches(first, second, *folder) : match_frames(first, second);
    const std::lock_guard lock(reporting);
    report_progress(progress, "matching pairs of frames", ++done, static_cast<std::int64_t>(pairs.size()));
  });
  std::vector<FramePair> in_common;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    if (!found[i].empty()) in_common.push_back({pairs[i][0], pairs[i][1], std::move(found[i])});
  }
  return in_common;
}

}  // namespace pilotage
