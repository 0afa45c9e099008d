#include "pilotage/match/vote_peaks.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <cstdlib>
#include <limits>
#include <numeric>
#include <tuple>
#include <utility>

namespace pilotage {
namespace {

constexpr int kBlurReach = 2;  // the Gaussian's, and that of the neighbours a peak is compared with
constexpr int kCellBins = 4;   // side of the squares that are bounded as one
constexpr int kMargin = 2 * kBlurReach;
constexpr int kPatchBins = kCellBins + 2 * kMargin;  // what the peaks of a square depend on
constexpr int kBlockBins = 4;                        // as few as five bins in a row never lie in three blocks
constexpr int kPatchBlocks = kPatchBins / kBlockBins;
constexpr std::size_t kHypothesesTogether = 3;    // turns, and scales, of a group
constexpr double kLower = 0.7;                    // than what was asked for, when that leaves too few
constexpr std::size_t kCellsBetweenBounds = 128;  // looked at before the best so far are sorted again

/// exp(−x²/2) at −2 … 2, of sum 1.
std::array<double, 2 * kBlurReach + 1> gaussian() {
  std::array<double, 2 * kBlurReach + 1> weights{};
  double sum = 0;
  for (int i = -kBlurReach; i <= kBlurReach; ++i) {
    sum += weights[static_cast<std::size_t>(i + kBlurReach)] = std::exp(-i * i / 2.0);
  }
  for (double& weight : weights) weight /= sum;
  return weights;
}

const std::array<double, 2 * kBlurReach + 1> kGaussian = gaussian();

/// A peak, and its place in the order of equal ones.
struct Peak {
  Candidate candidate;
  std::size_t hypothesis = 0;
  int row = 0;
  int col = 0;

  auto order() const { return std::tuple(-candidate.votes, hypothesis, row, col); }
};

/// The best `count` of sorted peaks, none nearer than kPeakSeparationPx to a better one.
std::vector<Candidate> separated(const std::vector<Peak>& sorted, std::size_t count) {
  std::vector<Candidate> kept;
  for (const Peak& peak : sorted) {
    if (kept.size() >= count) break;
    const Eigen::Vector2d& center = peak.candidate.placement.center_px;
    const bool near = std::any_of(kept.begin(), kept.end(), [&](const Candidate& better) {
      return (better.placement.center_px - center).squaredNorm() < kPeakSeparationPx * kPeakSeparationPx;
    });
    if (!near) kept.push_back(peak.candidate);
  }
  return kept;
}

/// The peaks found so far, and what another must have to matter.
class BestPeaks {
 public:
  BestPeaks(std::size_t count, double least, bool rises) : count_(count), least_(least), rises_(rises) {}

  double least() const { return least_; }
  void add(const Peak& peak) { peaks_.push_back(peak); }

  /// The best of all so far; peaks that cannot matter are forgotten.
  const std::vector<Candidate>& settle() {
    std::sort(peaks_.begin(), peaks_.end(), [](const Peak& a, const Peak& b) { return a.order() < b.order(); });
    kept_ = separated(peaks_, count_);
    if (rises_ && kept_.size() == count_) least_ = std::max(least_, kept_.back().votes);
    while (!peaks_.empty() && peaks_.back().candidate.votes < least_) peaks_.pop_back();
    return kept_;
  }

 private:
  std::size_t count_;
  double least_;
  bool rises_;
  std::vector<Peak> peaks_;
  std::vector<Candidate> kept_;
};

/// Turns [first_yaw, end_yaw) and scales [first_scale, end_scale).
struct HypothesisGroup {
  std::size_t first_yaw = 0;
  std::size_t end_yaw = 0;
  std::size_t first_scale = 0;
  std::size_t end_scale = 0;
  double off_middle = 0;  ///< From the middle of the search: that is where the best places mostly are.
};

std::vector<std::pair<std::size_t, std::size_t>> even_parts(std::size_t count) {
  const std::size_t parts = (count + kHypothesesTogether - 1) / kHypothesesTogether;
  std::vector<std::pair<std::size_t, std::size_t>> result;
  for (std::size_t i = 0; i < parts; ++i) result.emplace_back(count * i / parts, count * (i + 1) / parts);
  return result;
}

std::vector<HypothesisGroup> groups_of(const VoteSearch& search) {
  const auto off_middle = [](const auto& part, std::size_t count) {
    return std::abs(static_cast<double>(part.first + part.second) - static_cast<double>(count));
  };
  std::vector<HypothesisGroup> groups;
  for (const auto& yaws : even_parts(search.yaws_rad.size())) {
    for (const auto& scales : even_parts(search.scales.size())) {
      groups.push_back({yaws.first, yaws.second, scales.first, scales.second,
                        off_middle(yaws, search.yaws_rad.size()) + off_middle(scales, search.scales.size())});
    }
  }
  std::stable_sort(groups.begin(), groups.end(),
                   [](const auto& a, const auto& b) { return a.off_middle < b.off_middle; });
  return groups;
}

std::complex<double> similarity(double yaw_rad, double scale) {
  return std::polar(scale, yaw_rad);
}

/// Pairs with a column for each number, in the order in which they are looked at.
struct VoteColumns {
  void resize(std::size_t count) {
    for (std::vector<double>* column : {&frame_x, &frame_y, &map_x, &map_y}) column->resize(count);
    weight.resize(count);
  }

  std::vector<double> frame_x;  ///< From the pivot.
  std::vector<double> frame_y;
  std::vector<double> map_x;  ///< From the outer corner of the first bin.
  std::vector<double> map_y;
  std::vector<std::int32_t> weight;
};

/// The histograms of a group of turns and scales, square by square.
class GroupSearch {
 public:
  GroupSearch(const std::vector<VotePair>& pairs, const VoteSearch& search)
      : pairs_(pairs),
        search_(search),
        bins_(static_cast<int>(2 * search.half_side_px / kVoteBinPx) + 3),
        cells_((bins_ + kCellBins - 1) / kCellBins),
        corner_px_(search.center_px - Eigen::Vector2d::Constant(search.half_side_px + kVoteBinPx / 2)) {}

  void look(const HypothesisGroup& group, BestPeaks& best, const Checkpoint& checkpoint) {
    group_ = group;
    bound_cells();
    pass(checkpoint);
    std::vector<std::size_t> promising;
    for (std::size_t cell = 0; cell < bound_.size(); ++cell) {
      if (most_votes(cell) >= best.least()) promising.push_back(cell);
    }
    std::stable_sort(promising.begin(), promising.end(),
                     [&](std::size_t a, std::size_t b) { return bound_[a] > bound_[b]; });
    std::size_t looked_at = 0;
    for (const std::size_t cell : promising) {
      if (most_votes(cell) < best.least()) break;
      look_at_cell(static_cast<int>(cell) % cells_, static_cast<int>(cell) / cells_, best);
      if (++looked_at % kCellsBetweenBounds != 0) continue;
      best.settle();
      pass(checkpoint);
    }
    best.settle();
  }

 private:
  /// What a bin has at most that is felt by this weight. What is added is for rounding.
  static double most_votes_of(std::int64_t weight) {
    return kGaussian[kBlurReach] * kGaussian[kBlurReach] * (1 + 1e-9) * static_cast<double>(weight) / kVoteUnit;
  }

  /// Likewise any bin of the cell, under any turn and scale of the group.
  double most_votes(std::size_t cell) const { return most_votes_of(bound_[cell]); }

  /// Cells that bins from `low` to `high` may lie in or, by the Gaussian, be felt in; within the square.
  std::pair<int, int> cells_between(double low, double high) const {
    const auto cell = [&](double bin) {
      return std::clamp(static_cast<int>(std::floor(bin / kCellBins)), 0, cells_ - 1);
    };
    return {cell(std::floor(low) - kBlurReach), cell(std::floor(high) + kBlurReach)};
  }

  /// Places every pair by the group's middle turn and scale, and adds its weight to the bound of every cell that it may
  /// reach by any turn and scale of the group.
  void bound_cells() {
    const std::size_t middle_yaw = (group_.first_yaw + group_.end_yaw - 1) / 2;
    const std::size_t middle_scale = (group_.first_scale + group_.end_scale - 1) / 2;
    const std::complex<double> middle = similarity(search_.yaws_rad[middle_yaw], search_.scales[middle_scale]);
    double off = 0;
    for (std::size_t y = group_.first_yaw; y < group_.end_yaw; ++y) {
      for (std::size_t s = group_.first_scale; s < group_.end_scale; ++s) {
        off = std::max(off, std::abs(similarity(search_.yaws_rad[y], search_.scales[s]) - middle));
      }
    }
    bound_.assign(static_cast<std::size_t>(cells_) * static_cast<std::size_t>(cells_), 0);
    cell_of_.assign(pairs_.size(), -1);
    reach_bins_ = 0;
    for (std::size_t i = 0; i < pairs_.size(); ++i) {
      const VotePair& pair = pairs_[i];
      const std::complex<double> moved = middle * std::complex<double>(pair.from_pivot_px.x(), pair.from_pivot_px.y());
      const double col = (pair.map_px.x() - moved.real() - corner_px_.x()) / kVoteBinPx;
      const double row = (pair.map_px.y() - moved.imag() - corner_px_.y()) / kVoteBinPx;
      const double reach = pair.from_pivot_px.norm() * off / kVoteBinPx + 1e-6;
      if (col + reach < 0 || row + reach < 0 || col - reach >= bins_ || row - reach >= bins_) continue;
      reach_bins_ = std::max(reach_bins_, reach);
      const auto [first_col, last_col] = cells_between(col - reach, col + reach);
      const auto [first_row, last_row] = cells_between(row - reach, row + reach);
      for (int y = first_row; y <= last_row; ++y) {
        for (int x = first_col; x <= last_col; ++x) bound_[index_of(x, y)] += pair.weight;
      }
      const auto clamped = [&](double bin) {
        return std::clamp(static_cast<int>(std::floor(bin / kCellBins)), 0, cells_ - 1);
      };
      cell_of_[i] = static_cast<std::int32_t>(index_of(clamped(col), clamped(row)));
    }
    sort_pairs_by_cell();
  }

  void sort_pairs_by_cell() {
    begin_.assign(bound_.size() + 1, 0);
    for (const std::int32_t cell : cell_of_) {
      if (cell >= 0) ++begin_[static_cast<std::size_t>(cell) + 1];
    }
    std::partial_sum(begin_.begin(), begin_.end(), begin_.begin());
    sorted_.resize(begin_.back());
    std::vector<std::uint32_t> next(begin_.begin(), begin_.end() - 1);
    for (std::size_t i = 0; i < cell_of_.size(); ++i) {
      if (cell_of_[i] < 0) continue;
      const std::size_t to = next[static_cast<std::size_t>(cell_of_[i])]++;
      sorted_.frame_x[to] = pairs_[i].from_pivot_px.x();
      sorted_.frame_y[to] = pairs_[i].from_pivot_px.y();
      sorted_.map_x[to] = pairs_[i].map_px.x() - corner_px_.x();
      sorted_.map_y[to] = pairs_[i].map_px.y() - corner_px_.y();
      sorted_.weight[to] = pairs_[i].weight;
    }
  }

  std::size_t index_of(int cell_col, int cell_row) const {
    return static_cast<std::size_t>(cell_row) * static_cast<std::size_t>(cells_) + static_cast<std::size_t>(cell_col);
  }

  void look_at_cell(int cell_col, int cell_row, BestPeaks& best) {
    find_near(cell_col, cell_row);
    for (std::size_t y = group_.first_yaw; y < group_.end_yaw; ++y) {
      for (std::size_t s = group_.first_scale; s < group_.end_scale; ++s) {
        if (fill_patch(search_.yaws_rad[y], search_.scales[s], cell_col * kCellBins - kMargin,
                       cell_row * kCellBins - kMargin) < best.least()) {
          continue;
        }
        smooth_patch(cell_col * kCellBins - kMargin, cell_row * kCellBins - kMargin);
        add_peaks(y, s, cell_col * kCellBins, cell_row * kCellBins, best);
      }
    }
  }

  /// Finds the pairs that may vote in the patch about a cell.
  void find_near(int cell_col, int cell_row) {
    near_.clear();
    const int reach = static_cast<int>(std::ceil((kMargin + 1 + reach_bins_) / kCellBins));
    for (int y = std::max(cell_row - reach, 0); y <= std::min(cell_row + reach, cells_ - 1); ++y) {
      near_.emplace_back(begin_[index_of(std::max(cell_col - reach, 0), y)],
                         begin_[index_of(std::min(cell_col + reach, cells_ - 1), y) + 1]);
    }
  }

  /// The patch's bins under one turn and scale; no peak in it has more votes than what is returned.
  double fill_patch(double yaw_rad, double scale, int first_col, int first_row) {
    patch_.fill(0);
    std::array<std::int32_t, static_cast<std::size_t>(kPatchBlocks) * kPatchBlocks> blocks{};
    const double c = scale * std::cos(yaw_rad);
    const double s = scale * std::sin(yaw_rad);
    for (const auto& [first, end] : near_) {
      for (std::size_t i = first; i < end; ++i) {
        const double col = (sorted_.map_x[i] - (c * sorted_.frame_x[i] - s * sorted_.frame_y[i])) / kVoteBinPx;
        const double row = (sorted_.map_y[i] - (s * sorted_.frame_x[i] + c * sorted_.frame_y[i])) / kVoteBinPx;
        if (!(col >= 0 && row >= 0 && col < bins_ && row < bins_)) continue;
        const int x = static_cast<int>(col) - first_col;
        const int y = static_cast<int>(row) - first_row;
        if (x < 0 || y < 0 || x >= kPatchBins || y >= kPatchBins) continue;
        patch_[static_cast<std::size_t>(y * kPatchBins + x)] += sorted_.weight[i];
        blocks[static_cast<std::size_t>(y / kBlockBins * kPatchBlocks + x / kBlockBins)] += sorted_.weight[i];
      }
    }
    std::int32_t most = 0;
    for (std::size_t y = 0; y + 1 < kPatchBlocks; ++y) {
      for (std::size_t x = 0; x + 1 < kPatchBlocks; ++x) {
        const std::int32_t* const block = &blocks[y * kPatchBlocks + x];
        most = std::max(most, block[0] + block[1] + block[kPatchBlocks] + block[kPatchBlocks + 1]);
      }
    }
    return most_votes_of(most);
  }

  bool is_bin(int bin) const { return bin >= 0 && bin < bins_; }

  /// Votes of the bins that are at least kBlurReach within the patch. Every sum is added in one order, wherever the bin
  /// lies in a patch; many bins at a time, for speed.
  void smooth_patch(int first_col, int first_row) {
    constexpr std::size_t kSide = kPatchBins;
    constexpr std::size_t kReach = kBlurReach;
    std::array<double, kSide * kSide> bins;
    std::array<double, kSide * kSide> along_rows{};
    for (std::size_t i = 0; i < bins.size(); ++i) bins[i] = patch_[i] / kVoteUnit;
    for (std::size_t y = 0; y < kSide; ++y) {
      for (std::size_t k = 0; k < kGaussian.size(); ++k) {
        double* const sum = &along_rows[y * kSide + kReach];
        const double* const bin = &bins[y * kSide + k];
        for (std::size_t x = 0; x < kSide - 2 * kReach; ++x) sum[x] += kGaussian[k] * bin[x];
      }
    }
    votes_.fill(0);
    for (std::size_t y = kReach; y < kSide - kReach; ++y) {
      for (std::size_t k = 0; k < kGaussian.size(); ++k) {
        double* const sum = &votes_[y * kSide + kReach];
        const double* const row = &along_rows[(y + k - kReach) * kSide + kReach];
        for (std::size_t x = 0; x < kSide - 2 * kReach; ++x) sum[x] += kGaussian[k] * row[x];
      }
    }
    if (first_col >= 0 && first_row >= 0 && first_col + kPatchBins <= bins_ && first_row + kPatchBins <= bins_) return;
    for (int y = 0; y < kPatchBins; ++y) {  // beyond the square there is no bin
      for (int x = 0; x < kPatchBins; ++x) {
        if (!is_bin(x + first_col) || !is_bin(y + first_row)) votes_[static_cast<std::size_t>(y * kPatchBins + x)] = 0;
      }
    }
  }

  void add_peaks(std::size_t yaw, std::size_t scale, int first_col, int first_row, BestPeaks& best) const {
    for (int y = kMargin; y < kMargin + kCellBins; ++y) {
      for (int x = kMargin; x < kMargin + kCellBins; ++x) {
        const double votes = votes_[static_cast<std::size_t>(y * kPatchBins + x)];
        if (votes < best.least() || !is_highest(x, y)) continue;
        const int col = first_col + x - kMargin;
        const int row = first_row + y - kMargin;
        Peak peak;
        peak.candidate.placement.yaw_rad = search_.yaws_rad[yaw];
        peak.candidate.placement.scale = search_.scales[scale];
        peak.candidate.placement.center_px = search_.center_px - Eigen::Vector2d::Constant(search_.half_side_px) +
                                             kVoteBinPx * Eigen::Vector2d(col, row);
        peak.candidate.votes = votes;
        peak.hypothesis = yaw * search_.scales.size() + scale;
        peak.row = row;
        peak.col = col;
        best.add(peak);
      }
    }
  }

  bool is_highest(int x, int y) const {
    const double votes = votes_[static_cast<std::size_t>(y * kPatchBins + x)];
    for (int dy = -kBlurReach; dy <= kBlurReach; ++dy) {
      for (int dx = -kBlurReach; dx <= kBlurReach; ++dx) {
        if (votes_[static_cast<std::size_t>((y + dy) * kPatchBins + x + dx)] > votes) return false;
      }
    }
    return true;
  }

  const std::vector<VotePair>& pairs_;
  const VoteSearch& search_;
  int bins_;   // along a side of the square
  int cells_;  // likewise
  Eigen::Vector2d corner_px_;
  HypothesisGroup group_;
  double reach_bins_ = 0;              // from where the group's middle moves a pair
  std::vector<std::int64_t> bound_;    // of each cell: weights that can reach it
  std::vector<std::int32_t> cell_of_;  // of each pair, by the group's middle; −1 where it cannot vote
  std::vector<std::uint32_t> begin_;   // of each cell in sorted_
  VoteColumns sorted_;                 // the pairs of each cell
  std::vector<std::pair<std::size_t, std::size_t>> near_;  // in sorted_
  std::array<std::int32_t, static_cast<std::size_t>(kPatchBins) * kPatchBins> patch_{};
  std::array<double, static_cast<std::size_t>(kPatchBins) * kPatchBins> votes_{};
};

}  // namespace

std::vector<Candidate> vote_peaks(const std::vector<VotePair>& pairs, const VoteSearch& search, std::size_t count,
                                  const Checkpoint& checkpoint) {
  const std::vector<HypothesisGroup> groups = groups_of(search);
  GroupSearch group_search(pairs, search);
  double least = kMinVotes;
  for (bool rises = true;; rises = false) {
    BestPeaks best(count, least, rises);
    for (const HypothesisGroup& group : groups) group_search.look(group, best, checkpoint);
    std::vector<Candidate> kept = best.settle();
    // A peak between two others takes the place of both, and the last of the best may then have fewer votes than what
    // was asked for meanwhile: then it is all done again with what the last one has.
    const double needed = kept.size() == count ? kept.back().votes : kLower * best.least();
    if (needed >= best.least() || best.least() <= kMinVotes) return kept;
    least = std::max(kMinVotes, needed);
  }
}

}  // namespace pilotage
