#include <algorithm>
#include <cmath>
#include <limits>

#include "country/noise.h"
#include "country/overlay.h"
#include "country/world.h"

namespace pilotage::scene_detail {
namespace {

using Eigen::Vector2d;

bool is_wood(LandUse use) {
  return use == LandUse::kForest || use == LandUse::kConifers;
}

bool is_road(EdgeKind kind) {
  return kind == EdgeKind::kMainRoad || kind == EdgeKind::kRoad || kind == EdgeKind::kStreet ||
         kind == EdgeKind::kTrack;
}

/// How far beside a road its verge or footway reaches.
double verge_m(EdgeKind kind) {
  switch (kind) {
    case EdgeKind::kMainRoad:
      return 3.0;
    case EdgeKind::kRoad:
      return 1.8;
    case EdgeKind::kStreet:
      return 1.9;
    default:
      return 0;
  }
}

GroundPoint locate(const World& world, SceneEpoch epoch, const Vector2d& p, double footprint_m) {
  GroundPoint at;
  at.p = p;
  at.node = world.ground.at(p);
  at.q = p + Vector2d(at.node.bend_x_m, at.node.bend_y_m);
  at.parcel = &world.parcels.parcels[static_cast<std::size_t>(world.parcels.locate(at.q))];
  at.footprint_m = footprint_m;
  at.epoch = epoch;
  at.seed = world.seed;
  at.fresh_seed = world.seed + 1000 * (1 + static_cast<std::uint64_t>(epoch_index(epoch)));
  double nearest = std::numeric_limits<double>::infinity();
  const ParcelEdge* edges = world.parcels.edges_of(*at.parcel);
  for (int i = 0; i < at.parcel->edge_count; ++i) {
    const double axis_m = edges[i].distance_m(at.q);
    const double clearance = axis_m - edges[i].half_width_m - verge_m(edges[i].kind);
    if (clearance >= nearest) continue;
    nearest = clearance;
    at.edge = &edges[i];
    at.edge_m = axis_m;
  }
  return at;
}

Surface parcel_surface(const GroundPoint& at) {
  const Parcel& parcel = *at.parcel;
  if (parcel.yard_radius_m > 0) {
    const double uneven = parcel.yard_radius_m * (1 + 0.14 * gradient_noise(at.seed + 3, at.p.x() / 19, at.p.y() / 19));
    const double from_yard = (at.q - parcel.yard_m).norm();
    if (from_yard < 0.72 * uneven) return farmyard_surface(at);
    if (from_yard < 1.4 * uneven) return meadow_surface(at);
  }
  switch (parcel.use) {
    case LandUse::kArable:
      return field_surface(at);
    case LandUse::kMeadow:
      return meadow_surface(at);
    case LandUse::kOrchard:
      return orchard_surface(at);
    case LandUse::kForest:
    case LandUse::kConifers:
      return forest_surface(at);
    case LandUse::kPit:
      return pit_surface(at);
    case LandUse::kDwellings:
      return garden_surface(at);
    case LandUse::kWorks:
      return works_surface(at);
    case LandUse::kGreen:
      return meadow_surface(at);
  }
  return field_surface(at);
}

Surface ground_surface(const GroundPoint& at) {
  const EpochLook& look = epoch_look(at.epoch);
  const float ragged = 1.3F * detail_noise(at.seed + 1, at.p.x(), at.p.y(), 9, at.footprint_m);
  const float depth = at.node.water_m + ragged + 0.6F * look.water_level_m;
  const double clearance = at.edge_m - at.edge->half_width_m;
  const bool crosses_lake = at.node.lake_m > -9;
  const bool bridge = is_road(at.edge->kind) && at.edge->kind != EdgeKind::kTrack && !crosses_lake;
  if (clearance <= 0 && bridge) {
    Surface surface = road_surface(at);
    if (depth > 0)
      surface.colour = blend(surface.colour, {196, 192, 184}, line_coverage(clearance + 0.3, 0.3, at.footprint_m));
    return surface;
  }
  if (depth > 0) return water_surface(at, depth);
  const float shore = depth + 3.2F + 2.2F * gradient_noise(at.seed + 2, at.p.x() / 46, at.p.y() / 46);
  if (shore > 0) return bank_surface(at, depth);
  if (is_road(at.edge->kind) && clearance <= verge_m(at.edge->kind) && !crosses_lake) return road_surface(at);
  const bool wood = is_wood(at.parcel->use);
  if (clearance <= (wood ? 0.0 : 0.2 * ragged) && !is_road(at.edge->kind) && !wood) return strip_surface(at);
  return parcel_surface(at);
}

/// True where trees of a wood stand.
bool wood_stands(const World& world, const GroundPoint& at, const Vector2d& p) {
  const GroundPoint there = locate(world, at.epoch, p, at.footprint_m);
  return is_wood(there.parcel->use) && there.node.water_m < -4 && !is_clearing(there) &&
         there.edge_m > there.edge->half_width_m + verge_m(there.edge->kind);
}

/// The sunlight that woods leave on ground outside them: none where the ray towards the sun meets one below its height.
float wood_shadow(const World& world, const GroundPoint& at, const Surface& surface) {
  if (surface.cover == LandCover::kForest) return 1;
  const EpochLook& look = epoch_look(at.epoch);
  const double height = 14.5 + 3.0 * gradient_noise(at.seed + 4, at.p.x() / 7, at.p.y() / 7) - surface.height_m;
  const double reach = height / look.tan_elevation;
  if (reach <= 0) return 1;
  if (!is_wood(at.parcel->use)) {
    // Nothing to look for unless the ray leaves the parcel.
    double leaves = std::numeric_limits<double>::infinity();
    const ParcelEdge* edges = world.parcels.edges_of(*at.parcel);
    for (int i = 0; i < at.parcel->edge_count; ++i) {
      const double approach = -edges[i].normal.dot(look.to_sun);
      if (approach > 1e-9) leaves = std::min(leaves, edges[i].distance_m(at.q) / approach);
    }
    if (leaves > reach) return 1;
  }
  for (const double share : {1.0, 0.7, 0.42, 0.2}) {
    if (wood_stands(world, at, at.p + look.to_sun * (share * reach))) return 0;
  }
  return 1;
}

}  // namespace

Sight look_at(const World& world, SceneEpoch epoch, const Vector2d& p, double footprint_m) {
  const GroundPoint at = locate(world, epoch, p, footprint_m);
  Surface surface = ground_surface(at);
  const float objects = overlay_objects(world.objects, at, surface);
  const float sun = std::min(objects, wood_shadow(world, at, surface));
  const float hill = at.node.sunlight[static_cast<std::size_t>(epoch_index(epoch))];
  // Skylight, bluer than the sun, reaches into the shadow.
  const Rgb light = blend({0.45F, 0.48F, 0.55F}, {hill, hill, hill}, sun);
  return {surface.colour * light * surface.light, surface.cover};
}

}  // namespace pilotage::scene_detail
