#include "pilotage/match/search_memory.h"

#include "pilotage/match/displacement_voting.h"
#include "pilotage/match/vote_histogram.h"
#include "pilotage/match/vote_peaks.h"
#include "pilotage/vision/corner.h"
#include "pilotage/vision/feature_set.h"

namespace pilotage {
namespace {

constexpr double kGrowth = 3;  // of a vector: the old half and the new whole, of which half may be empty

}  // namespace

double bytes_to_rectify(const cv::Mat& frame) {
  constexpr double kPerResultPixel = 12;  // two maps of floats, mask, its complement, gray, valid
  // The frame is averaged down to as many pixels as it has at most.
  return static_cast<double>(frame.total() * frame.elemSize()) +
         2 * kPerResultPixel * kMaxRectifiedSidePx * kMaxRectifiedSidePx;
}

double bytes_to_describe(const FrameOnGrid& rectified, const FeatureOptions& features) {
  const auto pixels = static_cast<double>(rectified.frame.gray.total());
  const double points = pixels / 4 + 2 * kMaxRectifiedSidePx;  // every second column and row
  constexpr double kPlanes = 8;                                // bytes per pixel: eroded mask, smoothed copies
  const double descriptor = features.descriptor_bits / 8.0;
  const double point = kGrowth * (sizeof(Feature) + sizeof(Corner)) + 2 * descriptor;
  constexpr double kIndexed = sizeof(std::int32_t) + sizeof(std::size_t) + kGrowth * (3 * sizeof(float));
  return kPlanes * pixels + (point + kIndexed + descriptor) * points;
}

double bytes_to_vote(double half_width_px) {
  constexpr double kRounded = 12;          // columns: whole groups of those that are smoothed at once, and margins
  constexpr double kBinsOfCell = 16;       // vote_peaks.cc
  constexpr double kPeaksOfBin = 1 / 9.0;  // none beside another
  constexpr double kPeakBytes = 80;
  const double bins = 2 * half_width_px / kVoteBinPx + 3 + kRounded;
  constexpr double kPerBin = sizeof(std::int32_t) + (sizeof(std::int64_t) + 2 * sizeof(std::size_t)) / kBinsOfCell;
  constexpr double kRows = 2 * VoteHistogram::kRowsTogether + 6 * kVoteBlurReach + 1;
  constexpr double kPeaksOfColumn = VoteHistogram::kRowsTogether * kPeaksOfBin * kGrowth * kPeakBytes;
  return bins * bins * kPerBin + bins * (kRows * sizeof(double) + kPeaksOfColumn);
}

double bytes_of_map_feature(const FeatureOptions& features) {
  constexpr double kVoter = 4 * sizeof(double) + 2 * sizeof(std::int32_t);  // vote_histogram.h
  constexpr double kPointOfGround = 2 * kGrowth * 3 * sizeof(double);       // relief.cc, ground_heights.cc
  const double feature = sizeof(Feature) + features.descriptor_bits / 8.0 + sizeof(std::int64_t) + 2 * sizeof(float);
  constexpr double kNearestPoint = 6 * sizeof(std::int32_t) + 3 * sizeof(double);  // guided_matching.cc
  const double pair = kGrowth * sizeof(VotePair) + kVoter;
  return kGrowth * feature + kPointOfGround + kNearestPoint + kVoteNeighbours * pair;
}

}  // namespace pilotage
