#include "pilotage/match/vote_histogram.h"

#include <algorithm>
#include <cmath>

#include "pilotage/base/wide_clones.h"

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

namespace {

static_assert(kVotesTogether == kTogether);

/// Where pairs vote, in bins: those of the square, and the least and the most of the two numbers that tell whether it
/// is in the square.
struct BinsOfPairs {
  Together col;
  Together row;
  Together least;
  Together most;
};

/// kVotesTogether pairs: the first of their numbers.
struct PairsTogether {
  const double* x_px;
  const double* y_px;
  const double* from_pivot_x_px;
  const double* from_pivot_y_px;
};

PILOTAGE_WIDE_CLONES
void place_pairs(const PairsTogether& pairs, double cosine, double sine, int bins, BinsOfPairs& places) {
  const double last = bins - 1;
  BinsOfPairs found;
  for (std::size_t i = 0; i < kVotesTogether; ++i) {
    const double x = pairs.from_pivot_x_px[i];
    const double y = pairs.from_pivot_y_px[i];
    const double col = (pairs.x_px[i] - (cosine * x - sine * y)) / kVoteBinPx;
    const double row = (pairs.y_px[i] - (sine * x + cosine * y)) / kVoteBinPx;
    found.least[i] = std::min(col, row);
    found.most[i] = std::max(col, row);
    found.col[i] = std::min(std::max(col, 0.0), last);
    found.row[i] = std::min(std::max(row, 0.0), last);
  }
  places = found;
}

}  // namespace

PILOTAGE_WIDE_CLONES
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

VoteHistogram::VoteHistogram(int bins, const Eigen::Vector2d& corner_px, const std::vector<VotePair>& pairs)
    : bins_(bins),
      width_((static_cast<std::size_t>(bins) + kVotesTogether - 1) / kVotesTogether * kVotesTogether),
      stride_(static_cast<std::ptrdiff_t>(width_) + 2 * kVoteBlurReach) {
  const auto stride = static_cast<std::size_t>(stride_);
  const auto rows = static_cast<std::size_t>(std::min(bins, kRowsTogether));
  weights_.resize(static_cast<std::size_t>(bins) * stride + 1);
  row_.resize(stride);
  along_rows_.resize((rows + 4 * kVoteBlurReach) * stride);
  votes_.resize((rows + 2 * kVoteBlurReach) * stride);
  const std::size_t groups = (pairs.size() + kVotesTogether - 1) / kVotesTogether;
  for (std::vector<double>* const numbers : {&x_px_, &y_px_, &from_pivot_x_px_, &from_pivot_y_px_}) {
    numbers->resize(groups * kVotesTogether);
  }
  weight_of_pair_.resize(groups * kVotesTogether);
  touched_.resize(groups * kVotesTogether);
  for (std::size_t i = 0; i < groups * kVotesTogether; ++i) {
    const bool is_pair = i < pairs.size();
    x_px_[i] = is_pair ? pairs[i].map_px.x() - corner_px.x() : -kVoteBinPx;
    y_px_[i] = is_pair ? pairs[i].map_px.y() - corner_px.y() : -kVoteBinPx;
    from_pivot_x_px_[i] = is_pair ? pairs[i].from_pivot_px.x() : 0;
    from_pivot_y_px_[i] = is_pair ? pairs[i].from_pivot_px.y() : 0;
    weight_of_pair_[i] = is_pair ? pairs[i].weight : 0;
  }
}

void VoteHistogram::fill(double cosine, double sine) {
  for (std::size_t i = 0; i < touched_count_; ++i) weights_[touched_[i]] = 0;
  touched_count_ = 0;
  const std::size_t nowhere = weights_.size() - 1;
  BinsOfPairs bins;
  for (std::size_t first = 0; first < x_px_.size(); first += kVotesTogether) {
    place_pairs({&x_px_[first], &y_px_[first], &from_pivot_x_px_[first], &from_pivot_y_px_[first]}, cosine, sine, bins_,
                bins);
    // Without a branch: which pairs lie in the square no processor guesses.
    for (std::size_t i = 0; i < kVotesTogether; ++i) {
      const bool inside = bins.least[i] >= 0 && bins.most[i] < bins_;
      const std::size_t in_square = weight_index(static_cast<int>(bins.col[i]), static_cast<int>(bins.row[i]));
      const std::size_t index = inside ? in_square : nowhere;
      touched_[touched_count_] = static_cast<std::uint32_t>(index);
      touched_count_ += weights_[index] == 0 ? 1 : 0;
      weights_[index] += inside ? weight_of_pair_[first + i] : 0;
    }
  }
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
