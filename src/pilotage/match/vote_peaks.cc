#include "pilotage/match/vote_peaks.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <cstdlib>
#include <tuple>
#include <utility>

#include "pilotage/match/vote_histogram.h"

namespace pilotage {
namespace {

constexpr int kCellBins = 4;  // side of the squares that are bounded as one
constexpr int kMargin = 2 * kVoteBlurReach;
constexpr int kPatchBins = kCellBins + 2 * kMargin;  // what the peaks of a square depend on
constexpr int kBlockBins = 4;                        // as few as five bins in a row never lie in three blocks
constexpr int kPatchBlocks = kPatchBins / kBlockBins;
constexpr std::size_t kHypothesesTogether = 3;    // turns, and scales, of a group
constexpr double kLower = 0.7;                    // than what was asked for, when that leaves too few
constexpr std::size_t kCellsBetweenBounds = 128;  // looked at before the best so far are sorted again
constexpr double kShareForAll = 0.12;             // of promising squares: from here on it is less work to smooth all
constexpr double kShareWhenFull = 0.2;            // from here on it is less work not to look for the promising ones

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
  BestPeaks(std::size_t count, double least, bool rises)
      : count_(count), first_least_(least), least_(least), rises_(rises) {}

  double least() const { return least_; }
  bool rose() const { return least_ > first_least_; }
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
  double first_least_;
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

/// The histograms of a group of turns and scales, smoothed in some squares or as a whole.
class GroupSearch {
 public:
  GroupSearch(const std::vector<VotePair>& pairs, const VoteSearch& search)
      : pairs_(pairs),
        search_(search),
        bins_(static_cast<int>(2 * search.half_side_px / kVoteBinPx) + 3),
        cells_((bins_ + kCellBins - 1) / kCellBins),
        corner_px_(search.center_px - Eigen::Vector2d::Constant(search.half_side_px + kVoteBinPx / 2)),
        histogram_(bins_, corner_px_, pairs) {}

  void look(const HypothesisGroup& group, BestPeaks& best, const Checkpoint& checkpoint) {
    group_ = group;
    std::vector<std::size_t> promising;
    bool all = is_full_;
    if (!all) {
      promising = promising_cells(best.least());
      pass(checkpoint);
      const double share = static_cast<double>(promising.size()) / static_cast<double>(bound_.size());
      all = share > kShareForAll;
      is_full_ = best.rose() && share > kShareWhenFull;
      if (promising.empty()) return;
    }
    for (std::size_t y = group_.first_yaw; y < group_.end_yaw; ++y) {
      for (std::size_t s = group_.first_scale; s < group_.end_scale; ++s) {
        const std::complex<double> turn = similarity(search_.yaws_rad[y], search_.scales[s]);
        histogram_.fill(turn.real(), turn.imag());
        if (all) {
          look_at_all({y, s}, best, checkpoint);
        } else {
          look_at_cells({y, s}, promising, best, checkpoint);
        }
        pass(checkpoint);
      }
    }
  }

 private:
  /// What a bin has at most that is felt by this weight. What is added is for rounding.
  static double most_votes_of(std::int64_t weight) {
    return kVoteGaussian[kVoteBlurReach] * kVoteGaussian[kVoteBlurReach] * (1 + 1e-9) * static_cast<double>(weight) /
           kVoteUnit;
  }

  /// Likewise any bin of the cell, under any turn and scale of the group.
  double most_votes(std::size_t cell) const { return most_votes_of(bound_[cell]); }

  /// Cells that bins from `low` to `high` may lie in or, by the Gaussian, be felt in; within the square.
  std::pair<int, int> cells_between(double low, double high) const {
    const auto cell = [&](double bin) {
      return std::clamp(static_cast<int>(std::floor(bin / kCellBins)), 0, cells_ - 1);
    };
    return {cell(std::floor(low) - kVoteBlurReach), cell(std::floor(high) + kVoteBlurReach)};
  }

  /// Squares that may hold a peak with so many votes, the most promising first.
  std::vector<std::size_t> promising_cells(double least) {
    bound_cells();
    const auto is_promising = [&](std::int64_t bound) { return most_votes_of(bound) >= least; };
    std::vector<std::size_t> promising;
    promising.reserve(static_cast<std::size_t>(std::count_if(bound_.begin(), bound_.end(), is_promising)));
    for (std::size_t cell = 0; cell < bound_.size(); ++cell) {
      if (is_promising(bound_[cell])) promising.push_back(cell);
    }
    std::stable_sort(promising.begin(), promising.end(),
                     [&](std::size_t a, std::size_t b) { return bound_[a] > bound_[b]; });
    return promising;
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
    for (const VotePair& pair : pairs_) {
      const Eigen::Vector2d bin = bin_of(pair, middle.real(), middle.imag());
      const double reach = pair.from_pivot_px.norm() * off / kVoteBinPx + 1e-6;
      if ((bin.array() + reach).minCoeff() < 0 || (bin.array() - reach).maxCoeff() >= bins_) continue;
      const auto [first_col, last_col] = cells_between(bin.x() - reach, bin.x() + reach);
      const auto [first_row, last_row] = cells_between(bin.y() - reach, bin.y() + reach);
      for (int y = first_row; y <= last_row; ++y) {
        for (int x = first_col; x <= last_col; ++x) bound_[index_of(x, y)] += pair.weight;
      }
    }
  }

  /// Where a pair votes under a turn and scale, of which c is the cosine's part and s the sine's.
  Eigen::Vector2d bin_of(const VotePair& pair, double c, double s) const {
    const Eigen::Vector2d& from_pivot_px = pair.from_pivot_px;
    return {(pair.map_px.x() - corner_px_.x() - (c * from_pivot_px.x() - s * from_pivot_px.y())) / kVoteBinPx,
            (pair.map_px.y() - corner_px_.y() - (s * from_pivot_px.x() + c * from_pivot_px.y())) / kVoteBinPx};
  }

  /// A turn and a scale, by their numbers.
  struct Hypothesis {
    std::size_t yaw = 0;
    std::size_t scale = 0;
  };

  void look_at_all(const Hypothesis& hypothesis, BestPeaks& best, const Checkpoint& checkpoint) {
    for (int first_row = 0; first_row < bins_; first_row += VoteHistogram::kRowsTogether) {
      histogram_.smooth_from(first_row);
      for (int row = first_row; row < std::min(first_row + VoteHistogram::kRowsTogether, bins_); ++row) {
        for (int col = 0; col < bins_; ++col) {
          const double* const votes = histogram_.votes_at(col, row);
          if (*votes < best.least() || !is_vote_peak(votes, histogram_.stride())) continue;
          best.add(peak_at(hypothesis, col, row, *votes));
        }
      }
      best.settle();
      pass(checkpoint);
    }
  }

  void look_at_cells(const Hypothesis& hypothesis, const std::vector<std::size_t>& promising, BestPeaks& best,
                     const Checkpoint& checkpoint) {
    std::size_t looked_at = 0;
    for (const std::size_t cell : promising) {
      if (most_votes(cell) < best.least()) break;
      look_at_cell(hypothesis, static_cast<int>(cell) % cells_ * kCellBins, static_cast<int>(cell) / cells_ * kCellBins,
                   best);
      if (++looked_at % kCellsBetweenBounds != 0) continue;
      best.settle();
      pass(checkpoint);
    }
    best.settle();
  }

  std::size_t index_of(int cell_col, int cell_row) const {
    return static_cast<std::size_t>(cell_row) * static_cast<std::size_t>(cells_) + static_cast<std::size_t>(cell_col);
  }

  void look_at_cell(const Hypothesis& hypothesis, int first_col, int first_row, BestPeaks& best) {
    if (take_patch(first_col - kMargin, first_row - kMargin) < best.least()) return;
    smooth_patch(first_col - kMargin, first_row - kMargin);
    for (int y = kMargin; y < kMargin + kCellBins; ++y) {
      for (int x = kMargin; x < kMargin + kCellBins; ++x) {
        const double* const votes = &votes_[static_cast<std::size_t>(y * kPatchBins + x)];
        if (*votes < best.least() || !is_vote_peak(votes, kPatchBins)) continue;
        best.add(peak_at(hypothesis, first_col + x - kMargin, first_row + y - kMargin, *votes));
      }
    }
  }

  /// Copies the patch's bins from the histogram; no peak in it has more votes than what is returned.
  double take_patch(int first_col, int first_row) {
    std::array<std::int32_t, static_cast<std::size_t>(kPatchBlocks) * kPatchBlocks> blocks{};
    const bool all_inside = is_in_square(first_col, first_row, kPatchBins);
    for (int y = 0; y < kPatchBins; ++y) {
      std::int32_t* const row = &patch_[static_cast<std::size_t>(y * kPatchBins)];
      std::int32_t* const blocks_of_row = &blocks[static_cast<std::size_t>(y / kBlockBins * kPatchBlocks)];
      if (all_inside) {
        std::copy_n(histogram_.weights_at(first_col, first_row + y), kPatchBins, row);
      } else {
        for (int x = 0; x < kPatchBins; ++x) {
          const bool inside = is_in_square(first_col + x, first_row + y, 1);
          row[x] = inside ? *histogram_.weights_at(first_col + x, first_row + y) : 0;
        }
      }
      for (int x = 0; x < kPatchBins; ++x) blocks_of_row[x / kBlockBins] += row[x];
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

  /// Whether so many rows and columns of bins from this one on are.
  bool is_in_square(int col, int row, int count) const {
    return col >= 0 && row >= 0 && col + count <= bins_ && row + count <= bins_;
  }

  /// Votes of the bins that are at least kVoteBlurReach within the patch.
  void smooth_patch(int first_col, int first_row) {
    constexpr std::size_t kSide = kPatchBins;
    constexpr std::size_t kReach = kVoteBlurReach;
    constexpr std::size_t kWithin = kSide - 2 * kReach;
    static_assert(kWithin % kVotesTogether == 0);
    std::array<double, kSide * kSide> bins;
    std::array<double, kSide * kSide> along_rows;
    for (std::size_t i = 0; i < bins.size(); ++i) bins[i] = patch_[i] / kVoteUnit;
    for (std::size_t y = 0; y < kSide; ++y) {
      smooth_votes(&bins[y * kSide], 1, kWithin, &along_rows[y * kSide + kReach]);
    }
    for (std::size_t y = kReach; y < kSide - kReach; ++y) {
      smooth_votes(&along_rows[(y - kReach) * kSide + kReach], kSide, kWithin, &votes_[y * kSide + kReach]);
    }
    if (is_in_square(first_col, first_row, kPatchBins)) return;
    for (int y = 0; y < kPatchBins; ++y) {  // beyond the square there is no bin
      for (int x = 0; x < kPatchBins; ++x) {
        if (!is_in_square(x + first_col, y + first_row, 1)) votes_[static_cast<std::size_t>(y * kPatchBins + x)] = 0;
      }
    }
  }

  Peak peak_at(const Hypothesis& hypothesis, int col, int row, double votes) const {
    Peak peak;
    peak.candidate.placement.yaw_rad = search_.yaws_rad[hypothesis.yaw];
    peak.candidate.placement.scale = search_.scales[hypothesis.scale];
    peak.candidate.placement.center_px =
        search_.center_px - Eigen::Vector2d::Constant(search_.half_side_px) + kVoteBinPx * Eigen::Vector2d(col, row);
    peak.candidate.votes = votes;
    peak.hypothesis = hypothesis.yaw * search_.scales.size() + hypothesis.scale;
    peak.row = row;
    peak.col = col;
    return peak;
  }

  const std::vector<VotePair>& pairs_;
  const VoteSearch& search_;
  int bins_;                   // along a side of the square
  int cells_;                  // likewise
  Eigen::Vector2d corner_px_;  // the outer one of the first bin
  VoteHistogram histogram_;
  HypothesisGroup group_;
  bool is_full_ = false;             // of votes: what is left is looked at as a whole, unbounded
  std::vector<std::int64_t> bound_;  // of each cell: weights that can reach it
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
