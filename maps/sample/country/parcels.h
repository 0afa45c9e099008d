#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include <Eigen/Core>

namespace pilotage::scene_detail {

/// What runs along an edge between parcels.
enum class EdgeKind : std::uint8_t { kOuter, kMainRoad, kRoad, kStreet, kTrack, kHedge, kStrip };

/// Half the width of what runs along an edge.
double edge_half_width_m(EdgeKind kind);

enum class LandUse : std::uint8_t {
  kArable,
  kMeadow,
  kOrchard,
  kForest,
  kConifers,  ///< A plantation in rows.
  kPit,       ///< Gravel pit, bare ground.
  kDwellings,
  kWorks,  ///< Halls, yards and car parks.
  kGreen,  ///< A park or sports ground in town.
};

/// One side of a convex parcel: the points with normal·q >= offset_m lie on the parcel's side.
struct ParcelEdge {
  Eigen::Vector2d normal;
  double offset_m = 0;
  Eigen::Vector2d from;  ///< Its end points, counter-clockwise around the parcel.
  Eigen::Vector2d to;
  EdgeKind kind = EdgeKind::kStrip;
  double half_width_m = 0;

  double distance_m(const Eigen::Vector2d& q) const { return normal.dot(q) - offset_m; }
  Eigen::Vector2d direction() const { return {normal.y(), -normal.x()}; }
};

struct Parcel {
  int first_edge = 0;
  int edge_count = 0;
  Eigen::Vector2d center_m;
  double area_m2 = 0;
  Eigen::Vector2d rows;  ///< Unit vector along its longest side: the direction of work.
  LandUse use = LandUse::kArable;
  int crop = 0;
  Eigen::Vector2d yard_m{0, 0};  ///< Middle of a farm's yard, bent coordinates.
  double yard_radius_m = 0;      ///< 0 without a farm.
  std::uint64_t seed = 0;
};

/// A plane cut into convex parcels by straight lines, each line splitting one older parcel in two. Early lines become
/// roads, later ones tracks, hedges and mere strips of grass, so roads join in junctions and never stop in a field.
struct Parcels {
  struct Node {
    Eigen::Vector2d normal;
    double offset_m = 0;
    int above = -1;  ///< Node where normal·q >= offset_m; −1 in a leaf.
    int below = -1;  ///< The other node; in a leaf the parcel's index.
  };
  std::vector<Node> nodes;
  std::vector<Parcel> parcels;
  std::vector<ParcelEdge> edges;

  /// The parcel that holds `q` (bent coordinates).
  int locate(const Eigen::Vector2d& q) const {
    int node = 0;
    while (nodes[static_cast<std::size_t>(node)].above >= 0) {
      const Node& n = nodes[static_cast<std::size_t>(node)];
      node = n.normal.dot(q) >= n.offset_m ? n.above : n.below;
    }
    return nodes[static_cast<std::size_t>(node)].below;
  }
  const ParcelEdge* edges_of(const Parcel& parcel) const { return edges.data() + parcel.first_edge; }
};

struct ParcelPlan {
  double width_m = 0;
  double height_m = 0;
  double margin_m = 0;
  /// Whether a point lies in a settlement: parcels there become blocks between streets.
  std::function<bool(const Eigen::Vector2d&)> in_town;
  /// Whether a point is covered by standing water: lines that cross it are avoided.
  std::function<bool(const Eigen::Vector2d&)> in_lake;
};

Parcels make_parcels(std::uint64_t seed, const ParcelPlan& plan);

}  // namespace pilotage::scene_detail
