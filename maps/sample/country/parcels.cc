#include "country/parcels.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "pilotage/base/random.h"

namespace pilotage::scene_detail {
namespace {

using Eigen::Vector2d;

struct Polygon {
  std::vector<Vector2d> corners;  ///< Counter-clockwise.
  std::vector<EdgeKind> kinds;    ///< Of the side from corner i to corner i + 1.
};

struct Line {
  Vector2d normal;
  double offset_m = 0;
};

double area_m2(const Polygon& polygon) {
  double sum = 0;
  for (std::size_t i = 0; i < polygon.corners.size(); ++i) {
    const Vector2d& a = polygon.corners[i];
    const Vector2d& b = polygon.corners[(i + 1) % polygon.corners.size()];
    sum += a.x() * b.y() - b.x() * a.y();
  }
  return sum / 2;
}

Vector2d center_of(const Polygon& polygon) {
  Vector2d sum(0, 0);
  for (const Vector2d& corner : polygon.corners) sum += corner;
  return sum / static_cast<double>(polygon.corners.size());
}

/// The part of `polygon` where normal·q >= offset; the cut becomes a side of kind `kind`.
Polygon clip(const Polygon& polygon, const Line& line, EdgeKind kind) {
  Polygon result;
  const std::size_t count = polygon.corners.size();
  for (std::size_t i = 0; i < count; ++i) {
    const Vector2d& a = polygon.corners[i];
    const Vector2d& b = polygon.corners[(i + 1) % count];
    const double da = line.normal.dot(a) - line.offset_m;
    const double db = line.normal.dot(b) - line.offset_m;
    if (da >= 0) {
      result.corners.push_back(a);
      result.kinds.push_back(polygon.kinds[i]);
    }
    if ((da >= 0) != (db >= 0)) {
      result.corners.push_back(a + (b - a) * (da / (da - db)));
      result.kinds.push_back(da >= 0 ? kind : polygon.kinds[i]);
    }
  }
  return result;
}

/// Unit vector of the direction in which the polygon is longest, among its sides.
Vector2d long_direction(const Polygon& polygon) {
  Vector2d best(1, 0);
  double longest = 0;
  for (std::size_t i = 0; i < polygon.corners.size(); ++i) {
    const Vector2d side = polygon.corners[(i + 1) % polygon.corners.size()] - polygon.corners[i];
    if (side.norm() > longest) {
      longest = side.norm();
      best = side / longest;
    }
  }
  return best;
}

class Splitter {
 public:
  Splitter(std::uint64_t seed, const ParcelPlan& plan) : plan_(plan), random_(seed) {}

  Parcels run() {
    const double m = plan_.margin_m;
    Polygon all;
    all.corners = {
        {-m, -m}, {plan_.width_m + m, -m}, {plan_.width_m + m, plan_.height_m + m}, {-m, plan_.height_m + m}};
    all.kinds.assign(4, EdgeKind::kOuter);
    split(all, 0);
    return std::move(result_);
  }

 private:
  /// A line across the polygon: of some random ones the one that divides evenly and keeps clear of the lake.
  Line choose_line(const Polygon& polygon) {
    const Vector2d along = long_direction(polygon);
    double low = 1e300;
    double high = -1e300;
    for (const Vector2d& corner : polygon.corners) {
      low = std::min(low, along.dot(corner));
      high = std::max(high, along.dot(corner));
    }
    // A thin polygon is cut across; a fat one may be cut either way.
    const Vector2d across(-along.y(), along.x());
    double low_across = 1e300;
    double high_across = -1e300;
    for (const Vector2d& corner : polygon.corners) {
      low_across = std::min(low_across, across.dot(corner));
      high_across = std::max(high_across, across.dot(corner));
    }
    Line best;
    double best_cost = 1e300;
    for (int attempt = 0; attempt < 6; ++attempt) {
      const bool lengthwise = (high - low) < 1.25 * (high_across - low_across) && random_.uniform() < 0.5;
      const double tilt = random_.uniform(-0.16, 0.16);
      const Vector2d base = lengthwise ? across : along;
      const Vector2d normal(base.x() * std::cos(tilt) - base.y() * std::sin(tilt),
                            base.x() * std::sin(tilt) + base.y() * std::cos(tilt));
      const double share = random_.uniform(0.36, 0.64);
      const Vector2d through =
          along * (low + share * (high - low)) + across * (low_across + share * (high_across - low_across));
      const Line line{normal, normal.dot(through)};
      const double cost =
          std::abs(share - 0.5) + 4 * share_of_cut(polygon, line, plan_.in_lake) + 0.2 * random_.uniform();
      if (cost < best_cost) {
        best_cost = cost;
        best = line;
      }
    }
    return best;
  }

  /// Share of the line's chord in the polygon on which `covers` holds.
  static double share_of_cut(const Polygon& polygon, const Line& line,
                             const std::function<bool(const Vector2d&)>& covers) {
    const Polygon half = clip(polygon, line, EdgeKind::kStreet);
    for (std::size_t i = 0; i < half.corners.size(); ++i) {
      const Vector2d& a = half.corners[i];
      const Vector2d& b = half.corners[(i + 1) % half.corners.size()];
      const auto off_line = [&](const Vector2d& corner) {
        return std::abs(line.normal.dot(corner) - line.offset_m) > 1e-6;
      };
      if (off_line(a) || off_line(b)) continue;
      int covered = 0;
      for (int step = 0; step < 16; ++step) covered += covers(a + (b - a) * ((step + 0.5) / 16)) ? 1 : 0;
      return covered / 16.0;
    }
    return 0;
  }

  EdgeKind choose_kind(int depth, const Polygon& polygon, const Line& line) {
    const double r = random_.uniform();
    const Vector2d center = center_of(polygon);
    const bool town = share_of_cut(polygon, line, plan_.in_town) > 0.35;
    if (plan_.in_lake(center) && depth > 3) return EdgeKind::kStrip;
    if (depth <= 1) return EdgeKind::kMainRoad;
    if (town) return EdgeKind::kStreet;
    if (depth <= 3) return r < 0.6 ? EdgeKind::kRoad : EdgeKind::kTrack;
    if (depth <= 5) return r < 0.45 ? EdgeKind::kTrack : (r < 0.7 ? EdgeKind::kHedge : EdgeKind::kStrip);
    return r < 0.12 ? EdgeKind::kTrack : (r < 0.36 ? EdgeKind::kHedge : EdgeKind::kStrip);
  }

  bool touches_town(const Polygon& polygon) const {
    return plan_.in_town(center_of(polygon)) || std::any_of(polygon.corners.begin(), polygon.corners.end(),
                                                            [&](const Vector2d& c) { return plan_.in_town(c); });
  }

  int split(const Polygon& polygon, int depth) {
    const int index = static_cast<int>(result_.nodes.size());
    result_.nodes.emplace_back();
    const double area = area_m2(polygon);
    const Vector2d center = center_of(polygon);
    const bool town = touches_town(polygon);
    const double target = town ? random_.uniform(6500, 12500) : random_.uniform(20000, 85000);
    if (area < target || depth > 24) {
      result_.nodes[static_cast<std::size_t>(index)].below = add_parcel(polygon, area, center);
      return index;
    }
    const Line line = choose_line(polygon);
    const EdgeKind kind = choose_kind(depth, polygon, line);
    const Line other{-line.normal, -line.offset_m};
    const int above = split(clip(polygon, line, kind), depth + 1);
    const int below = split(clip(polygon, other, kind), depth + 1);
    result_.nodes[static_cast<std::size_t>(index)] = {line.normal, line.offset_m, above, below};
    return index;
  }

  int add_parcel(const Polygon& polygon, double area, const Vector2d& center) {
    Parcel parcel;
    parcel.first_edge = static_cast<int>(result_.edges.size());
    parcel.area_m2 = area;
    parcel.center_m = center;
    parcel.rows = long_direction(polygon);
    parcel.seed = random_.next();
    for (std::size_t i = 0; i < polygon.corners.size(); ++i) {
      const Vector2d& a = polygon.corners[i];
      const Vector2d& b = polygon.corners[(i + 1) % polygon.corners.size()];
      if ((b - a).norm() < 1e-6) continue;
      const Vector2d direction = (b - a).normalized();
      const Vector2d inward(-direction.y(), direction.x());
      result_.edges.push_back({inward, inward.dot(a), a, b, polygon.kinds[i], edge_half_width_m(polygon.kinds[i])});
    }
    parcel.edge_count = static_cast<int>(result_.edges.size()) - parcel.first_edge;
    result_.parcels.push_back(parcel);
    return static_cast<int>(result_.parcels.size()) - 1;
  }

  const ParcelPlan& plan_;
  Random random_;
  Parcels result_;
};

}  // namespace

double edge_half_width_m(EdgeKind kind) {
  switch (kind) {
    case EdgeKind::kMainRoad:
      return 4.0;
    case EdgeKind::kRoad:
      return 2.9;
    case EdgeKind::kStreet:
      return 3.1;
    case EdgeKind::kTrack:
      return 1.8;
    case EdgeKind::kHedge:
      return 1.6;
    case EdgeKind::kStrip:
      return 0.7;
    case EdgeKind::kOuter:
      return 0;
  }
  return 0;
}

Parcels make_parcels(std::uint64_t seed, const ParcelPlan& plan) {
  return Splitter(seed, plan).run();
}

}  // namespace pilotage::scene_detail
