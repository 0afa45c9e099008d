#include "pilotage/match/displacement_voting.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include "pilotage/vision/hamming.h"

namespace pilotage {
namespace {

/// Where in the frame a map feature may appear: its place under the middle of the search space, and how far off.
struct Reach {
  Eigen::Vector2d center_px;
  double half_width_px;
};

Reach reach_in_frame(const PivotedFrame& frame, const SearchSpace& space, const Eigen::Vector2d& map_px,
                     double stretch) {
  const double turned_px = frame.radius_px * (2 * space.yaw_sigma_rad + 2 * space.scale_sigma);
  const Eigen::Vector2d on_level = frame.stretched(map_px - space.center_px, 1 / stretch);
  return {on_level + frame.pivot_px, space.half_width_px / stretch + turned_px};
}

/// Features of the map that vote: every stride-th from the first on, at most `count`.
struct Voters {
  std::size_t first;
  std::size_t stride;
  std::size_t count;

  std::size_t of_map(std::size_t voter) const { return first + voter * stride; }
};

/// Of how many features of the map one votes.
std::size_t vote_stride(const PivotedFrame& frame, std::size_t map_features) {
  const auto points = static_cast<double>(frame.grid.points.size());
  const double wanted = std::ceil(static_cast<double>(map_features) * points / kVotingComparisons);
  return static_cast<std::size_t>(std::max(1.0, std::min(wanted, std::floor(points / kVotingPoints))));
}

FeatureSet features_of(const FeatureSet& features, const Voters& voters) {
  FeatureSet some;
  some.pattern = features.pattern;
  some.descriptor_bytes = features.descriptor_bytes;
  for (std::size_t i = voters.first; i < features.size() && some.size() < voters.count; i += voters.stride) {
    some.features.push_back(features.features[i]);
    const std::uint8_t* const descriptor = features.descriptor(i);
    some.descriptors.insert(some.descriptors.end(), descriptor, descriptor + features.descriptor_bytes);
  }
  return some;
}

/// Of the nearest descriptors of the frame to each voter.
void append_similar_pairs(const HammingIndex& index, const PivotedFrame& frame, const LocalMap& map,
                          const Voters& voters, const SearchSpace& space, std::vector<VotePair>& pairs) {
  const FeatureSet features = features_of(map.features, voters);
  std::vector<HammingWindow> windows;
  windows.reserve(features.size());
  for (std::size_t i = 0; i < features.size(); ++i) {
    const Feature& feature = features.features[i];
    const Reach reach =
        reach_in_frame(frame, space, {static_cast<double>(feature.x_px), static_cast<double>(feature.y_px)},
                       map.stretch_of(voters.of_map(i)));
    windows.push_back({reach.center_px.x() - reach.half_width_px, reach.center_px.y() - reach.half_width_px,
                       reach.center_px.x() + reach.half_width_px, reach.center_px.y() + reach.half_width_px});
  }
  const double limit_bits = descriptor_of(features).vote_distance * 8 * features.descriptor_bytes;
  const HammingMatches nearest = index.find_nearest(features, windows, kVoteNeighbours, best_hamming_path(),
                                                    static_cast<std::uint32_t>(std::ceil(limit_bits)) - 1);
  for (std::size_t i = 0; i < features.size(); ++i) {
    const Feature& of_map = features.features[i];
    for (const HammingMatch& match : nearest.of_query(i)) {
      if (!match.found()) break;
      const Feature& of_frame = frame.grid.points.features[match.index];
      const double nearness = 1 - match.distance / limit_bits;
      const Eigen::Vector2d from_pivot =
          Eigen::Vector2d(static_cast<double>(of_frame.x_px), static_cast<double>(of_frame.y_px)) - frame.pivot_px;
      pairs.push_back({frame.stretched(from_pivot, map.stretch_of(voters.of_map(i))),
                       {static_cast<double>(of_map.x_px), static_cast<double>(of_map.y_px)},
                       static_cast<std::int32_t>(std::lround(nearness * nearness * kVoteUnit))});
    }
  }
}

/// How many pairs vote at most: of a large frame the nearest ones say it all.
std::size_t most_vote_pairs(const SearchSpace& space) {
  const double side_px = 2 * space.half_width_px;
  return static_cast<std::size_t>(std::max(kLeastVotePairs, kVotePairsPerPx2 * side_px * side_px));
}

/// Drops the pairs of least weight until no more than `most` are left, and all that weigh as much as the first dropped.
void keep_heaviest(std::vector<VotePair>& pairs, std::size_t most) {
  if (pairs.size() <= most) return;
  std::vector<std::int32_t> weights;
  weights.reserve(pairs.size());
  for (const VotePair& pair : pairs) weights.push_back(pair.weight);
  std::nth_element(weights.begin(), weights.begin() + static_cast<std::ptrdiff_t>(most), weights.end(),
                   std::greater<>());
  const std::int32_t first_dropped = weights[most];
  std::erase_if(pairs, [&](const VotePair& pair) { return pair.weight <= first_dropped; });
}

/// Evenly spaced values over ± 2 sigma about `middle`, at most `step` apart.
std::vector<double> hypotheses(double middle, double sigma, double step) {
  const int count = static_cast<int>(std::ceil(2 * sigma / step));
  std::vector<double> values;
  for (int i = -count; i <= count; ++i) values.push_back(middle + i * (count == 0 ? 0 : 2 * sigma / count));
  return values;
}

}  // namespace

double vote_comparisons(const PivotedFrame& frame, std::size_t map_features) {
  return static_cast<double>(map_features) * static_cast<double>(frame.grid.points.size()) /
         static_cast<double>(vote_stride(frame, map_features));
}

double search_bins(const PivotedFrame& frame, const SearchSpace& space) {
  const double step = kVoteStepPx / std::max(frame.radius_px, 1.0);
  const double side = 2 * space.half_width_px / kVoteBinPx + 3;
  const double turns = 2 * std::ceil(2 * space.yaw_sigma_rad / step) + 1;
  return side * side * turns * (2 * std::ceil(2 * space.scale_sigma / step) + 1);
}

std::vector<VotePair> vote_pairs(const PivotedFrame& frame, const LocalMap& map, const SearchSpace& space,
                                 const Checkpoint& checkpoint, std::size_t stride) {
  constexpr std::size_t kComparisonsBetweenChecks = 8'000'000;  // some milliseconds
  const std::size_t points = frame.grid.points.size();
  stride = std::max(stride, vote_stride(frame, map.features.size()));
  const std::size_t together = std::max<std::size_t>(1, kComparisonsBetweenChecks / std::max<std::size_t>(1, points));
  const HammingIndex index(frame.grid.points);
  std::vector<VotePair> pairs;
  for (std::size_t first = 0; first < map.features.size(); first += stride * together) {
    append_similar_pairs(index, frame, map, {first, stride, together}, space, pairs);
    pass(checkpoint);
  }
  keep_heaviest(pairs, most_vote_pairs(space));
  return pairs;
}

std::vector<Candidate> vote_for_displacements(const PivotedFrame& frame, const LocalMap& map, const SearchSpace& space,
                                              std::size_t count, const Checkpoint& checkpoint) {
  const double step = kVoteStepPx / std::max(frame.radius_px, 1.0);
  VoteSearch search;
  search.center_px = space.center_px;
  search.half_side_px = space.half_width_px;
  search.yaws_rad = hypotheses(0, space.yaw_sigma_rad, step);
  search.scales = hypotheses(1, space.scale_sigma, step);
  return vote_peaks(vote_pairs(frame, map, space, checkpoint), search, count, checkpoint);
}

}  // namespace pilotage
