#include "pilotage/capture/tracks.h"

#include <algorithm>
#include <numeric>
#include <unordered_map>

namespace pilotage {
namespace {

constexpr int kCellsAside = 8;

/// Sets that are joined two by two (R. E. Tarjan, J. ACM 22, 1975; path halving, the smaller root stays).
class DisjointSets {
 public:
  explicit DisjointSets(std::size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0U); }

  std::size_t root(std::size_t node) {
    while (parent_[node] != node) {
      parent_[node] = parent_[parent_[node]];
      node = parent_[node];
    }
    return node;
  }

  void join(std::size_t a, std::size_t b) {
    a = root(a);
    b = root(b);
    if (a != b) parent_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<std::size_t> parent_;
};

bool sees_twice(const Track& track) {
  for (std::size_t i = 1; i < track.size(); ++i) {
    if (track[i].frame == track[i - 1].frame) return true;
  }
  return false;
}

/// How many tracks each part of each picture has already.
class Coverage {
 public:
  Coverage(const std::vector<FrameFeatures>& features, int per_cell) : features_(features), per_cell_(per_cell) {
    for (const FrameFeatures& frame : features) {
      Eigen::Vector2d extent(1, 1);
      for (const Eigen::Vector2d& pixel : frame.pixels) extent = extent.cwiseMax(pixel);
      extents_.push_back(extent);
      counts_.emplace_back(kCellsAside * kCellsAside, 0);
    }
  }

  bool wants(const Track& track) {
    return std::any_of(track.begin(), track.end(), [&](const Sighting& one) { return count(one) < per_cell_; });
  }
  void add(const Track& track) {
    for (const Sighting& one : track) ++count(one);
  }

 private:
  int& count(const Sighting& one) {
    const auto frame = static_cast<std::size_t>(one.frame);
    const Eigen::Vector2d& pixel = features_[frame].pixels[static_cast<std::size_t>(one.feature)];
    const Eigen::Array2i cell =
        (pixel.array() / extents_[frame].array() * kCellsAside).cast<int>().min(kCellsAside - 1).max(0);
    return counts_[frame][static_cast<std::size_t>(cell.y() * kCellsAside + cell.x())];
  }

  const std::vector<FrameFeatures>& features_;
  int per_cell_;
  std::vector<Eigen::Vector2d> extents_;
  std::vector<std::vector<int>> counts_;
};

}  // namespace

std::vector<Track> join_tracks(const std::vector<FramePair>& pairs, const std::vector<FrameFeatures>& features,
                               int per_cell) {
  std::vector<std::size_t> first_node(features.size() + 1, 0);
  for (std::size_t i = 0; i < features.size(); ++i) first_node[i + 1] = first_node[i] + features[i].pixels.size();
  DisjointSets sets(first_node.back());
  const auto node = [&](int frame, int feature) {
    return first_node[static_cast<std::size_t>(frame)] + static_cast<std::size_t>(feature);
  };
  for (const FramePair& pair : pairs) {
    for (const auto& match : pair.matches) sets.join(node(pair.first, match[0]), node(pair.second, match[1]));
  }
  std::vector<bool> matched(first_node.back(), false);
  for (const FramePair& pair : pairs) {
    for (const auto& match : pair.matches) {
      matched[node(pair.first, match[0])] = matched[node(pair.second, match[1])] = true;
    }
  }
  std::vector<Track> by_root;
  std::unordered_map<std::size_t, std::size_t> place_of_root;
  for (std::size_t frame = 0; frame < features.size(); ++frame) {
    for (std::size_t i = 0; i < features[frame].pixels.size(); ++i) {
      if (!matched[first_node[frame] + i]) continue;
      const auto [place, added] = place_of_root.emplace(sets.root(first_node[frame] + i), by_root.size());
      if (added) by_root.emplace_back();
      by_root[place->second].push_back({static_cast<int>(frame), static_cast<int>(i)});
    }
  }
  std::erase_if(by_root, [](const Track& track) { return track.size() < 2 || sees_twice(track); });
  std::stable_sort(by_root.begin(), by_root.end(), [](const Track& a, const Track& b) { return a.size() > b.size(); });
  Coverage coverage(features, per_cell);
  std::vector<Track> kept;
  for (Track& track : by_root) {
    if (!coverage.wants(track)) continue;
    coverage.add(track);
    kept.push_back(std::move(track));
  }
  return kept;
}

std::vector<std::vector<int>> tied_parts(const std::vector<FramePair>& pairs, int frames) {
  DisjointSets sets(static_cast<std::size_t>(frames));
  for (const FramePair& pair : pairs) {
    sets.join(static_cast<std::size_t>(pair.first), static_cast<std::size_t>(pair.second));
  }
  std::vector<std::vector<int>> parts(static_cast<std::size_t>(frames));
  for (int frame = 0; frame < frames; ++frame) parts[sets.root(static_cast<std::size_t>(frame))].push_back(frame);
  std::erase_if(parts, [](const auto& part) { return part.empty(); });
  std::stable_sort(parts.begin(), parts.end(), [](const auto& a, const auto& b) { return a.size() > b.size(); });
  return parts;
}

}  // namespace pilotage
