#include "pilotage/correlation/correlation_peaks.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "pilotage/base/error.h"
#include "pilotage/base/nan.h"
#include "pilotage/correlation/correlation_kernels.h"

namespace pilotage {
namespace {

constexpr float kRivalShare = 0.8F;
constexpr double kLargestAssumedPeak = 0.9;
constexpr float kNoThreshold = std::numeric_limits<float>::infinity();
/// A lattice is fine enough where the surface falls by no more than this over half a step in columns and rows.
constexpr float kSteepestFall = 0.5F;
/// How far a maximum can rise above the parabolas through a lattice, in units of fall · height.
constexpr float kLargestRise = 0.5F;
/// Local maxima from which the surface is climbed at most, and how far.
constexpr int kMostClimbs = 256;
constexpr int kMostMoves = 4;

struct Lobe {
  int reach = 0;  ///< Farthest column or row of the region from the true position.
  int area = 0;   ///< Pixels of the region.
};

/// The 4-connected region above half of the peak, looked for within `limit` columns and rows.
Lobe main_lobe(const cv::Mat& surface, const cv::Point& truth, float half, int limit) {
  const cv::Rect inside = cv::Rect(truth.x - limit, truth.y - limit, 2 * limit + 1, 2 * limit + 1) &
                          cv::Rect(0, 0, surface.cols, surface.rows);
  cv::Mat seen = cv::Mat::zeros(inside.size(), CV_8U);
  std::vector<cv::Point> open{truth};
  seen.at<std::uint8_t>(truth - inside.tl()) = 1;
  Lobe lobe;
  while (!open.empty()) {
    const cv::Point point = open.back();
    open.pop_back();
    ++lobe.area;
    lobe.reach = std::max({lobe.reach, std::abs(point.x - truth.x), std::abs(point.y - truth.y)});
    for (const cv::Point step : {cv::Point(1, 0), cv::Point(-1, 0), cv::Point(0, 1), cv::Point(0, -1)}) {
      const cv::Point next = point + step;
      if (!inside.contains(next) || !(surface.at<float>(next) > half)) continue;
      std::uint8_t& mark = seen.at<std::uint8_t>(next - inside.tl());
      if (mark == 0) open.push_back(next);
      mark = 1;
    }
  }
  return lobe;
}

struct Outside {
  std::int64_t count = 0;
  double sum = 0;
  double squares = 0;
  float highest = -std::numeric_limits<float>::infinity();
  cv::Point where;
  std::int64_t rivals = 0;
};

bool is_local_maximum(const cv::Mat& surface, int col, int row) {
  const float here = surface.at<float>(row, col);
  for (int dy = -1; dy <= 1; ++dy) {
    for (int dx = -1; dx <= 1; ++dx) {
      if ((dx == 0 && dy == 0) || row + dy < 0 || row + dy >= surface.rows || col + dx < 0 ||
          col + dx >= surface.cols) {
        continue;
      }
      const float there = surface.at<float>(row + dy, col + dx);
      const bool before = dy < 0 || (dy == 0 && dx < 0);
      if (before ? there >= here : there > here) return false;
    }
  }
  return true;
}

/// Columns [from, to) of one row.
void add_span(const cv::Mat& surface, int row, int from, int to, float threshold, Outside& outside) {
  const float* values = surface.ptr<float>(row);
  const SpanSums sums = sum_span(values + from, static_cast<std::size_t>(to - from));
  outside.count += static_cast<std::int64_t>(sums.count);
  outside.sum += sums.sum;
  outside.squares += sums.squares;
  const float highest = sums.highest;
  if (highest > outside.highest) {
    outside.highest = highest;
    outside.where = {static_cast<int>(std::find(values + from, values + to, highest) - values), row};
  }
  if (!(highest >= threshold)) return;
  for (int c = from; c < to; ++c) {
    if (values[c] >= threshold && is_local_maximum(surface, c, row)) ++outside.rivals;
  }
}

/// trace(C⁻¹)/2 of the matrix C of second differences of −R, px² per unit of correlation; NaN without a maximum.
double mean_inverse_curvature(const cv::Mat& surface, const cv::Point& truth) {
  if (truth.x < 1 || truth.y < 1 || truth.x + 1 >= surface.cols || truth.y + 1 >= surface.rows) return kNaN;
  const auto at = [&](int dx, int dy) { return static_cast<double>(surface.at<float>(truth.y + dy, truth.x + dx)); };
  const double xx = 2 * at(0, 0) - at(-1, 0) - at(1, 0);
  const double yy = 2 * at(0, 0) - at(0, -1) - at(0, 1);
  const double xy = -(at(1, 1) - at(1, -1) - at(-1, 1) + at(-1, -1)) / 4;
  const double determinant = xx * yy - xy * xy;
  if (!(xx > 0 && yy > 0 && determinant > 0)) return kNaN;
  return (xx + yy) / determinant / 2;
}

/// What holds of the true position alone, the other numbers NaN, and half the side of the square that is hidden as main
/// lobe.
struct MainPeak {
  CorrelationPeaks peaks{kNaN, kNaN, kNaN, kNaN, kNaN, kNaN, kNaN, kNaN, kNaN, kNaN};
  int hidden = 0;
};

int lobe_limit_px(int tile_size_px) {
  return std::max(2, tile_size_px / 16);
}

MainPeak main_peak(const cv::Mat& surface, const cv::Point& truth, int tile_size_px) {
  if (surface.type() != CV_32FC1) throw UsageError("correlation_peaks needs a CV_32F surface");
  if (!cv::Rect(0, 0, surface.cols, surface.rows).contains(truth)) {
    throw UsageError("correlation_peaks: true position (" + std::to_string(truth.x) + ", " + std::to_string(truth.y) +
                     ") lies outside the surface");
  }
  MainPeak result;
  const float peak = surface.at<float>(truth);
  if (std::isnan(peak)) return result;
  result.peaks.peak = static_cast<double>(peak);
  const int limit = lobe_limit_px(tile_size_px);
  Lobe lobe{0, 1};
  if (peak > 0) {
    lobe = main_lobe(surface, truth, peak / 2, limit);
    result.peaks.half_width_px = std::sqrt(lobe.area / std::numbers::pi);
    const double rho = std::min(result.peaks.peak, kLargestAssumedPeak);
    const double samples = std::max(1.0, static_cast<double>(tile_size_px) * tile_size_px / lobe.area);
    result.peaks.expected_error_px =
        std::sqrt((1 - rho * rho) / (rho * samples) * mean_inverse_curvature(surface, truth));
  }
  result.hidden = std::clamp(2 * lobe.reach, 2, limit);
  return result;
}

float rival_threshold(const CorrelationPeaks& peaks) {
  return peaks.peak > 0 ? kRivalShare * static_cast<float>(peaks.peak) : std::numeric_limits<float>::infinity();
}

/// Everything more than `hidden` columns or rows away from `truth`.
Outside outside_square(const cv::Mat& surface, const cv::Point& truth, int hidden, float threshold) {
  Outside outside;
  for (int row = 0; row < surface.rows; ++row) {
    if (std::abs(row - truth.y) > hidden) {
      add_span(surface, row, 0, surface.cols, threshold, outside);
    } else {
      add_span(surface, row, 0, std::max(0, truth.x - hidden), threshold, outside);
      add_span(surface, row, std::min(surface.cols, truth.x + hidden + 1), surface.cols, threshold, outside);
    }
  }
  return outside;
}

struct Moments {
  double mean = 0;
  double variance = 0;
};

Moments moments(double count, double sum, double squares) {
  const double mean = sum / count;
  return {mean, squares / count - mean * mean};
}

/// Adds the highest value outside the main lobe, its place relative to the true position, and what follows.
void set_rival(double rival, const cv::Point& lag_px, const Moments& of_all, double rivals, CorrelationPeaks& peaks) {
  peaks.rival = rival;
  peaks.margin = peaks.peak - rival;
  peaks.rival_dx_px = lag_px.x;
  peaks.rival_dy_px = lag_px.y;
  if (of_all.variance > 1e-12) peaks.psr = (peaks.peak - of_all.mean) / std::sqrt(of_all.variance);
  if (peaks.peak > 0) {
    peaks.rival_ratio = rival / peaks.peak;
    peaks.rivals = rivals;
  }
}

/// A local maximum of a lattice, and where and how high the surface peaks near it.
struct Candidate {
  cv::Point where;
  cv::Point2f vertex;  ///< From `where`, in steps of the lattice.
  float height = 0;
};

/// The vertex of the parabolas through a local maximum and its neighbours, in columns and in rows.
Candidate make_candidate(const cv::Mat& lattice, const cv::Point& where) {
  const cv::Rect inside(0, 0, lattice.cols, lattice.rows);
  const float here = lattice.at<float>(where);
  Candidate candidate{where, {0, 0}, here};
  const auto vertex = [&](const cv::Point& step) {
    if (!inside.contains(where - step) || !inside.contains(where + step)) return 0.0F;
    const float before = lattice.at<float>(where - step);
    const float after = lattice.at<float>(where + step);
    const float curvature = 2 * here - before - after;
    if (!(curvature > 0)) return 0.0F;
    candidate.height += (after - before) * (after - before) / (8 * curvature);
    return (after - before) / (2 * curvature);
  };
  candidate.vertex = {vertex({1, 0}), vertex({0, 1})};
  return candidate;
}

/// Local maxima of at least `floor` more than `hidden` positions away from `truth`, highest first.
std::vector<Candidate> find_candidates(const cv::Mat& lattice, const cv::Point& truth, int hidden, float floor) {
  std::vector<Candidate> candidates;
  for (int row = 0; row < lattice.rows; ++row) {
    const float* values = lattice.ptr<float>(row);
    if (!(sum_span(values, static_cast<std::size_t>(lattice.cols)).highest >= floor)) continue;
    for (int col = 0; col < lattice.cols; ++col) {
      if (!(values[col] >= floor)) continue;
      if (std::abs(col - truth.x) <= hidden && std::abs(row - truth.y) <= hidden) continue;
      if (is_local_maximum(lattice, col, row)) candidates.push_back(make_candidate(lattice, {col, row}));
    }
  }
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const Candidate& a, const Candidate& b) { return a.height > b.height; });
  return candidates;
}

/// How far the main peak has fallen `distance` columns and rows away, relative to its height; the steepest of four.
float diagonal_fall(const cv::Mat& near, const cv::Point& truth, int distance) {
  const float peak = near.at<float>(truth);
  float lowest = peak;
  for (const cv::Point step : {cv::Point(1, 1), cv::Point(-1, 1), cv::Point(1, -1), cv::Point(-1, -1)}) {
    const cv::Point next = truth + distance * step;
    if (cv::Rect(0, 0, near.cols, near.rows).contains(next)) lowest = std::min(lowest, near.at<float>(next));
  }
  return 1 - lowest / peak;
}

/// The highest value found by going from neighbour to neighbour, in a few steps, never nearer than `least_px` columns
/// and rows to lag 0.
SurfaceValue climb(const cv::Point& from, int least_px, const ValuesAround& values_around) {
  SurfaceValue best{from, -std::numeric_limits<float>::infinity()};
  for (int moves = 0; moves < kMostMoves; ++moves) {
    const cv::Point start = best.lag;
    for (const SurfaceValue& value : values_around(start)) {
      const bool far = std::max(std::abs(value.lag.x), std::abs(value.lag.y)) >= least_px;
      if (far && value.value > best.value) best = value;
    }
    if (best.lag == start) break;
  }
  return best;
}

}  // namespace

CorrelationPeaks correlation_peaks(const cv::Mat& surface, const cv::Point& truth, int tile_size_px) {
  auto [peaks, hidden] = main_peak(surface, truth, tile_size_px);
  if (std::isnan(peaks.peak)) return peaks;
  const Outside outside = outside_square(surface, truth, hidden, rival_threshold(peaks));
  if (outside.count == 0) return peaks;
  set_rival(static_cast<double>(outside.highest), outside.where - truth,
            moments(static_cast<double>(outside.count), outside.sum, outside.squares),
            static_cast<double>(outside.rivals), peaks);
  return peaks;
}

int near_radius_px(int tile_size_px) {
  return (lobe_limit_px(tile_size_px) + 1) | 1;
}

std::optional<CorrelationPeaks> sparse_correlation_peaks(const SparseSurface& surface, int tile_size_px,
                                                         const ValuesAround& values_around) {
  auto [peaks, hidden] = main_peak(surface.near, surface.near_truth, tile_size_px);
  const float fall = diagonal_fall(surface.near, surface.near_truth, surface.step / 2);
  if (!(peaks.peak > 0) || !(fall <= kSteepestFall)) return std::nullopt;

  const int near_px = near_radius_px(tile_size_px);
  const int near_positions = near_px / surface.step;
  const Outside near = outside_square(surface.near, surface.near_truth, hidden, kNoThreshold);
  const Outside far = outside_square(surface.lattice, surface.lattice_truth, near_positions, kNoThreshold);
  if (near.count + far.count == 0) return peaks;
  const double weight = static_cast<double>(surface.step) * surface.step;
  const Moments of_all = moments(static_cast<double>(near.count) + weight * static_cast<double>(far.count),
                                 near.sum + weight * far.sum, near.squares + weight * far.squares);

  SurfaceValue best{near.where - surface.near_truth, near.highest};
  if (far.highest > best.value) best = {surface.step * (far.where - surface.lattice_truth), far.highest};
  const auto sigma = static_cast<float>(std::sqrt(std::max(0.0, of_all.variance)));
  const auto rise = [&](float value) { return kLargestRise * fall * std::max(value, sigma); };
  const float threshold = rival_threshold(peaks);
  const float floor = std::min(best.value - 3 * rise(best.value), threshold - 3 * rise(threshold));
  double rivals = 0;
  int climbed = 0;
  for (const Candidate& candidate :
       find_candidates(surface.lattice, surface.lattice_truth, hidden / surface.step, floor)) {
    float height = candidate.height;
    const cv::Point at = candidate.where - surface.lattice_truth;
    const bool is_near = std::max(std::abs(at.x), std::abs(at.y)) <= near_positions;
    if (!is_near && height + rise(height) > best.value && climbed < kMostClimbs) {
      ++climbed;
      const cv::Point2f vertex = static_cast<float>(surface.step) * candidate.vertex;
      const SurfaceValue top =
          climb(surface.step * at + cv::Point(cvRound(vertex.x), cvRound(vertex.y)), near_px + 1, values_around);
      height = std::max(height, top.value);
      if (top.value > best.value) best = top;
    }
    if (height >= threshold) ++rivals;
  }
  set_rival(static_cast<double>(best.value), best.lag, of_all, rivals, peaks);
  return peaks;
}

}  // namespace pilotage
