#include <cmath>

#include "country/noise.h"
#include "country/surface.h"

namespace pilotage::scene_detail {
namespace {

using Eigen::Vector2d;

constexpr Rgb kAsphalt{124, 122, 120};
constexpr Rgb kFootway{158, 152, 144};

Rgb asphalt_colour(const GroundPoint& at) {
  const double x = at.p.x();
  const double y = at.p.y();
  // Resurfaced stretches, patches, worn wheel tracks and grain.
  const float stretch = gradient_noise(at.seed + 71, at.q.x() / 150, at.q.y() / 150);
  const float stains = detail_noise(at.seed + 72, x, y, 6, at.footprint_m);
  const float grain = detail_noise(at.seed + 73, x, y, 0.9, at.footprint_m);
  return kAsphalt * (1 + 0.13F * stretch + 0.035F * stains + 0.03F * grain);
}

Surface paved_road(const GroundPoint& at, double from_edge_m) {
  const double fp = at.footprint_m;
  const double along = at.edge->direction().dot(at.q);
  Rgb colour = asphalt_colour(at);
  const double half_lane = at.edge->half_width_m / 2;
  colour = colour * (1 - 0.05F * line_coverage(std::abs(at.edge_m - half_lane) - 0.8, 0.35, fp));
  constexpr Rgb kPaint{214, 214, 206};
  if (at.edge->kind != EdgeKind::kStreet) {
    const bool dash = along - 12 * std::floor(along / 12) < 5;
    if (dash) colour = blend(colour, kPaint, 0.8F * line_coverage(at.edge_m, 0.08, fp));
  }
  if (at.edge->kind == EdgeKind::kMainRoad)
    colour = blend(colour, kPaint, 0.7F * line_coverage(from_edge_m + 0.3, 0.08, fp));
  return {colour, LandCover::kRoad, 1, 0};
}

Surface sandy_track(const GroundPoint& at) {
  const double fp = at.footprint_m;
  const float wander = 0.35F * gradient_noise(at.seed + 74, at.q.x() / 22, at.q.y() / 22);
  const double wheel = std::abs(at.edge_m + wander * (at.edge->normal.x() > 0 ? 1 : -1)) - 0.85;
  const float worn = smooth_step(0.75F, 0.25F, static_cast<float>(std::abs(wheel)));
  const float grassy = 0.5F + 0.5F * gradient_noise(at.seed + 75, at.q.x() / 60, at.q.y() / 60);
  const float grain = detail_noise(at.seed + 76, at.p.x(), at.p.y(), 1.6, fp) +
                      0.6F * detail_noise(at.fresh_seed + 76, at.p.x(), at.p.y(), 0.8, fp);
  const Rgb sand = Rgb{188, 170, 138} * (1 + 0.06F * grain + 0.05F * at.node.soil);
  const Rgb grass = grass_colour(at, {116, 120, 76}, 0.8F);
  return {blend(grass, sand, clamp01(0.25F + 0.75F * worn + 0.35F * (0.5F - grassy))), LandCover::kTrack, 1, 0};
}

}  // namespace

Surface road_surface(const GroundPoint& at) {
  const double from_edge_m = at.edge_m - at.edge->half_width_m;
  if (at.edge->kind == EdgeKind::kTrack) return sandy_track(at);
  if (from_edge_m <= 0) return paved_road(at, from_edge_m);
  // Footways along streets, grass verges along roads.
  if (at.edge->kind == EdgeKind::kStreet) {
    const double along = at.edge->direction().dot(at.q);
    const float slab =
        hash_signed(lattice_hash(at.seed + 77, floor_to_int(along / 7), floor_to_int(at.edge->offset_m)), 0);
    const float kerb = line_coverage(from_edge_m, 0.12, at.footprint_m);
    return {kFootway * (1 + 0.04F * slab + 0.12F * kerb +
                        0.03F * detail_noise(at.seed + 78, at.p.x(), at.p.y(), 1.2, at.footprint_m)),
            LandCover::kPavement, 1, 0};
  }
  const Rgb verge = at.epoch == SceneEpoch::kSecond ? Rgb{122, 120, 80} : Rgb{110, 120, 74};
  return {grass_colour(at, verge, 1.0F), LandCover::kGrass, 1, 0};
}

Surface garden_surface(const GroundPoint& at) {
  const double fp = at.footprint_m;
  const double along = at.edge->direction().dot(at.q);
  // Lots of 18 m along the street, each with its own ground; beds and terraces within.
  const double lot_place = along / 18;
  const std::int64_t lot = floor_to_int(lot_place);
  const auto depth = static_cast<float>(at.edge_m - at.edge->half_width_m);
  const std::uint64_t own = lattice_hash(at.parcel->seed, lot, floor_to_int(at.edge->offset_m));
  const Rgb lawn{94 + 22 * hash_part(own, 0), 112 + 14 * hash_part(own, 1), 64 + 12 * hash_part(own, 2)};
  Surface surface{grass_colour(at, lawn, 0.7F), LandCover::kGrass, 1, 0};
  const double in_lot = (lot_place - static_cast<double>(lot)) * 18;
  // A drive from the street, a terrace behind the house, a vegetable bed in some gardens.
  const double drive_m = 2.5 + 10 * hash_part(own, 3);
  if (depth < 14 && std::abs(in_lot - drive_m) < 1.6 + 1.2 * hash_part(own, 1)) {
    surface.colour = Rgb{152, 144, 134} * (0.85F + 0.3F * hash_part(own, 2) +
                                           0.04F * detail_noise(at.seed + 79, at.p.x(), at.p.y(), 1.1, fp));
    surface.cover = LandCover::kPavement;
  } else if (depth > 20 && depth < 27 && in_lot > 4 && in_lot < 12 && hash_part(own, 0) < 0.4F) {
    const float rows = surviving_detail(1.2, fp) * static_cast<float>(std::cos(along * 5.2));
    const Rgb bed = at.epoch == SceneEpoch::kFirst ? Rgb{106, 104, 66} : Rgb{116, 98, 76};
    surface.colour = bed * (1 + 0.12F * rows + 0.1F * detail_noise(at.fresh_seed + 79, at.p.x(), at.p.y(), 1.5, fp));
  }
  const float fence = line_coverage(std::fmin(in_lot, 18 - in_lot), 0.35, fp);
  if (depth > 1) surface.colour = blend(surface.colour, {62, 74, 46}, (0.35F + 0.5F * hash_part(own, 1)) * fence);
  return surface;
}

Surface works_surface(const GroundPoint& at) {
  const double fp = at.footprint_m;
  const auto depth = static_cast<float>(at.edge_m - at.edge->half_width_m);
  if (depth < 4.5F) return {grass_colour(at, {104, 116, 72}, 0.8F), LandCover::kGrass, 1, 0};
  // Concrete laid in fields, with joints and stains.
  const Vector2d rows = at.parcel->rows;
  const double u = rows.dot(at.q) / 9;
  const double v = Vector2d(-rows.y(), rows.x()).dot(at.q) / 9;
  const float slab = hash_signed(lattice_hash(at.parcel->seed, floor_to_int(u), floor_to_int(v)), 0);
  const float stains = detail_noise(at.seed + 80, at.p.x(), at.p.y(), 12, fp) +
                       0.5F * detail_noise(at.seed + 81, at.p.x(), at.p.y(), 3.5, fp);
  const double joint = 9 * std::fmin(std::abs(u - std::round(u)), std::abs(v - std::round(v)));
  const Rgb tone = hash_part(at.parcel->seed, 0) < 0.5F ? Rgb{164, 160, 152} : Rgb{132, 130, 126};
  return {tone * (1 + 0.05F * slab + 0.08F * stains + 0.03F * detail_noise(at.seed + 82, at.p.x(), at.p.y(), 0.9, fp) -
                  0.14F * line_coverage(joint, 0.1, fp)),
          LandCover::kPavement, 1, 0};
}

}  // namespace pilotage::scene_detail
