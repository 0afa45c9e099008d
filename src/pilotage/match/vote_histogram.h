#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "pilotage/match/vote_peaks.h"

namespace pilotage {

/// The Gaussian of one bin that votes are smoothed by reaches so far, and so do the neighbours that a peak must not be
/// below.
inline constexpr int kVoteBlurReach = 2;

/// exp(−x²/2) at −2 … 2, of sum 1.
extern const std::array<double, 2 * kVoteBlurReach + 1> kVoteGaussian;

/// Bins of a row that are smoothed at once.
inline constexpr std::size_t kVotesTogether = 8;

/// Smooths `width` bins, a multiple of kVotesTogether, in one direction: each of `sums` is that of five numbers from
/// `from` on, `step` apart, times kVoteGaussian, always added in the same order.
void smooth_votes(const double* from, std::ptrdiff_t step, std::size_t width, double* sums);

/// Whether none of the 5 × 5 votes about these exceeds them; rows lie `stride` apart.
bool is_vote_peak(const double* votes, std::ptrdiff_t stride);

/// The votes of pairs for a square of bins under one turn and scale, smoothed along rows, then along columns.
class VoteHistogram {
 public:
  /// Of `bins` × `bins`, the first of which has its outer corner at `corner_px`, without votes. Takes 4 bytes a bin,
  /// 1.6 KB a column and 40 bytes a pair.
  VoteHistogram(int bins, const Eigen::Vector2d& corner_px, const std::vector<VotePair>& pairs);

  /// The votes under this turn and scale in place of those before: `cosine` and `sine` are multiplied by the scale.
  void fill(double cosine, double sine);
  /// Weights of a bin and of those right of it.
  const std::int32_t* weights_at(int col, int row) const { return &weights_[weight_index(col, row)]; }
  /// Works out the votes of kRowsTogether rows from this one on, or of those that are left.
  void smooth_from(int first_row);
  /// Votes of a bin of these rows, as is_vote_peak() takes them with stride(): beyond the square there are none.
  const double* votes_at(int col, int row) const {
    return &votes_[static_cast<std::size_t>((row - first_row_ + kVoteBlurReach) * stride_ + col + kVoteBlurReach)];
  }
  std::ptrdiff_t stride() const { return stride_; }

  static constexpr int kRowsTogether = 96;

 private:
  std::size_t weight_index(int col, int row) const {
    return static_cast<std::size_t>(row * stride_ + col + kVoteBlurReach);
  }
  bool is_row(int row) const { return row >= 0 && row < bins_; }

  int bins_;
  std::size_t width_;  ///< Bins of a row that are worked out: a multiple of kVotesTogether.
  std::ptrdiff_t stride_;
  int first_row_ = 0;
  // Of the pairs, in groups of kVotesTogether; the last one is filled up with pairs that vote nowhere.
  std::vector<double> x_px_;  ///< On the map, from the square's corner.
  std::vector<double> y_px_;
  std::vector<double> from_pivot_x_px_;
  std::vector<double> from_pivot_y_px_;
  std::vector<std::int32_t> weight_of_pair_;
  std::vector<std::int32_t> weights_;   ///< Rows have a margin of kVoteBlurReach empty bins, as the others; one more.
  std::vector<std::uint32_t> touched_;  ///< Bins with weights: the first touched_count_.
  std::size_t touched_count_ = 0;
  std::vector<double> row_;
  std::vector<double> along_rows_;  ///< Of the rows that are worked out and of 2 · kVoteBlurReach on either side.
  std::vector<double> votes_;       ///< Likewise, of kVoteBlurReach on either side.
};

}  // namespace pilotage
