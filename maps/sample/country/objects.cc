#include "country/objects.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "country/epoch.h"

namespace pilotage::scene_detail {
namespace {

using Eigen::Vector2d;

struct Extent {
  Vector2d min;
  Vector2d max;
};

/// A disc of radius `radius_m` and its shadows at both dates.
Extent extent_with_shadows(const Vector2d& center, double radius_m, double height_m) {
  Extent extent{center.array() - radius_m, center.array() + radius_m};
  for (const SceneEpoch epoch : {SceneEpoch::kFirst, SceneEpoch::kSecond}) {
    const EpochLook& look = epoch_look(epoch);
    const Vector2d tip = center - look.to_sun * (height_m / look.tan_elevation);
    extent.min = extent.min.cwiseMin(tip.array().matrix() - Vector2d(radius_m, radius_m));
    extent.max = extent.max.cwiseMax(tip + Vector2d(radius_m, radius_m));
  }
  return extent;
}

struct CellLists {
  std::vector<std::uint32_t> starts;
  std::vector<std::uint32_t> ids;
};

CellLists list_cells(const std::vector<Extent>& extents, const Vector2d& origin, int columns, int rows) {
  std::vector<std::vector<std::uint32_t>> cells(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows));
  const auto clamped = [](double value, int count) {
    return std::clamp(static_cast<int>(std::floor(value)), 0, count - 1);
  };
  for (std::size_t i = 0; i < extents.size(); ++i) {
    const Vector2d low = (extents[i].min - origin) / ObjectIndex::kCell_m;
    const Vector2d high = (extents[i].max - origin) / ObjectIndex::kCell_m;
    if (high.x() < 0 || high.y() < 0 || low.x() >= columns || low.y() >= rows) continue;
    for (int row = clamped(low.y(), rows); row <= clamped(high.y(), rows); ++row) {
      for (int column = clamped(low.x(), columns); column <= clamped(high.x(), columns); ++column) {
        cells[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) + static_cast<std::size_t>(column)]
            .push_back(static_cast<std::uint32_t>(i));
      }
    }
  }
  CellLists lists;
  lists.starts.push_back(0);
  for (const auto& cell : cells) {
    lists.ids.insert(lists.ids.end(), cell.begin(), cell.end());
    lists.starts.push_back(static_cast<std::uint32_t>(lists.ids.size()));
  }
  return lists;
}

}  // namespace

int ObjectIndex::cell_of(const Vector2d& p) const {
  const double x = (p.x() - origin_m.x()) / kCell_m;
  const double y = (p.y() - origin_m.y()) / kCell_m;
  if (!(x >= 0 && y >= 0 && x < columns && y < rows)) return -1;
  return static_cast<int>(y) * columns + static_cast<int>(x);
}

ObjectIndex index_objects(std::vector<Box> boxes, std::vector<Tree> trees, const Vector2d& min, const Vector2d& max) {
  ObjectIndex index;
  index.origin_m = min;
  index.columns = static_cast<int>(std::ceil((max.x() - min.x()) / ObjectIndex::kCell_m));
  index.rows = static_cast<int>(std::ceil((max.y() - min.y()) / ObjectIndex::kCell_m));
  std::vector<Extent> box_extents;
  for (const Box& box : boxes) {
    box_extents.push_back(
        extent_with_shadows(box.center_m, std::hypot(box.half_length_m, box.half_width_m), box.height_m + box.rise_m));
  }
  std::vector<Extent> tree_extents;
  for (const Tree& tree : trees)
    tree_extents.push_back(extent_with_shadows(tree.center_m, tree.radius_m, tree.height_m));
  CellLists box_lists = list_cells(box_extents, min, index.columns, index.rows);
  CellLists tree_lists = list_cells(tree_extents, min, index.columns, index.rows);
  index.box_starts = std::move(box_lists.starts);
  index.box_ids = std::move(box_lists.ids);
  index.tree_starts = std::move(tree_lists.starts);
  index.tree_ids = std::move(tree_lists.ids);
  index.boxes = std::move(boxes);
  index.trees = std::move(trees);
  return index;
}

}  // namespace pilotage::scene_detail
