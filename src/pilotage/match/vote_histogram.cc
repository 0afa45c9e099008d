#include "pilotage/match/vote_histogram.h"

#include <algorithm>
#include <cmath>

#include "pilotage/match/vote_peaks.h"

namespace pilotage {
namespace {

std::array<double, 2 * kVoteBlurReach + 1> gaussian() {
  std::array<double, 2 * kVoteBlurReach + 1> weights{};
  double sum = 0;
  for (int i = -kVoteBlurReach; i <= kVoteBlurReach; ++i) {
    sum += weights[static_cast<std::size_t>(i + kVoteBlurReach)] = std::exp(-i * i / 2.0);
  }
  for (double& weight : weights) weight /= sum;
  return weights;
}

}  // namespace

const std::array<double, 2 * kVoteBlurReach + 1> kVoteGaussian = gaussian();

// The wider instructions add and multiply as the others do: there is no fused one among them. The choice is made while
// the program is loaded, when the thread sanitizer cannot be called yet.
#if defined(__x86_64__) && !defined(__SANITIZE_THREAD__)
__attribute__((target_clones("avx2", "default")))
#endif
void smooth_votes(const double* from, std::ptrdiff_t step, std::size_t width, double* sums) {
  const double* const gaussian = kVoteGaussian.data();
  for (std::size_t x = 0; x < width; x += kVotesTogether) {
    std::array<double, kVotesTogether> sum{};
    for (std::ptrdiff_t k = 0; k <= 2 * kVoteBlurReach; ++k) {
      const double* const next = from + static_cast<std::ptrdiff_t>(x) + k * step;
      for (std::size_t i = 0; i < kVotesTogether; ++i) sum[i] += gaussian[k] * next[i];
    }
    for (std::size_t i = 0; i < kVotesTogether; ++i) sums[x + i] = sum[i];
  }
}

bool is_vote_peak(const double* votes, std::ptrdiff_t stride) {
  for (int dy = -kVoteBlurReach; dy <= kVoteBlurReach; ++dy) {
    for (int dx = -kVoteBlurReach; dx <= kVoteBlurReach; ++dx) {
      if (votes[dy * stride + dx] > *votes) return false;
    }
  }
  return true;
}

VoteHistogram::VoteHistogram(int bins)
    : bins_(bins),
      width_((static_cast<std::size_t>(bins) + kVotesTogether - 1) / kVotesTogether * kVotesTogether),
      stride_(static_cast<std::ptrdiff_t>(width_) + 2 * kVoteBlurReach) {
  const auto stride = static_cast<std::size_t>(stride_);
  const auto rows = static_cast<std::size_t>(std::min(bins, kRowsTogether));
  weights_.resize(static_cast<std::size_t>(bins) * stride);
  row_.resize(stride);
  along_rows_.resize((rows + 4 * kVoteBlurReach) * stride);
  votes_.resize((rows + 2 * kVoteBlurReach) * stride);
}

void VoteHistogram::clear() {
  for (const std::uint32_t index : touched_) weights_[index] = 0;
  touched_.clear();
}

void VoteHistogram::smooth_from(int first_row) {
  first_row_ = first_row;
  const int end_row = std::min(first_row + kRowsTogether, bins_);
  double* sums = &along_rows_[kVoteBlurReach];
  for (int row = first_row - 2 * kVoteBlurReach; row < end_row + 2 * kVoteBlurReach; ++row, sums += stride_) {
    if (!is_row(row)) {
      std::fill_n(sums, width_, 0.0);
      continue;
    }
    const std::int32_t* const weights = &weights_[weight_index(-kVoteBlurReach, row)];
    for (std::size_t x = 0; x < row_.size(); ++x) row_[x] = weights[x] / kVoteUnit;
    smooth_votes(row_.data(), 1, width_, sums);
  }
  sums = &votes_[kVoteBlurReach];
  const double* rows = &along_rows_[kVoteBlurReach];
  for (int row = first_row - kVoteBlurReach; row < end_row + kVoteBlurReach; ++row, sums += stride_, rows += stride_) {
    const auto bins = static_cast<std::size_t>(is_row(row) ? bins_ : 0);
    if (bins > 0) smooth_votes(rows, stride_, width_, sums);
    std::fill_n(sums + bins, width_ - bins, 0.0);  // there is no bin
  }
}

}  // namespace pilotage
