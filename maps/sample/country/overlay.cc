#include "country/overlay.h"

#include <algorithm>
#include <cmath>

#include "country/noise.h"

namespace pilotage::scene_detail {
namespace {

using Eigen::Vector2d;

/// Coordinates in a box: along and across its middle.
Vector2d in_box(const Box& box, const Vector2d& p) {
  const Vector2d d = p - box.center_m;
  return {d.dot(box.along), d.dot(left_of(box.along))};
}

/// True when the segment from `from` with direction `step` (whole length) meets the rectangle |x| <= half_x, |y| <=
/// half_y.
bool segment_meets(const Vector2d& from, const Vector2d& step, double half_x, double half_y) {
  double enter = 0;
  double leave = 1;
  for (int axis = 0; axis < 2; ++axis) {
    const double half = axis == 0 ? half_x : half_y;
    if (std::abs(step[axis]) < 1e-12) {
      if (std::abs(from[axis]) > half) return false;
      continue;
    }
    const double a = (-half - from[axis]) / step[axis];
    const double b = (half - from[axis]) / step[axis];
    enter = std::max(enter, std::min(a, b));
    leave = std::min(leave, std::max(a, b));
  }
  return enter <= leave;
}

/// Light on a roof side that falls towards `downhill` with slope `slope`, relative to level ground.
float side_light(const Vector2d& downhill, double slope, const EpochLook& look) {
  const double facing = (look.tan_elevation + slope * downhill.dot(look.to_sun)) / look.tan_elevation;
  return static_cast<float>(std::clamp(facing / std::sqrt(1 + slope * slope), 0.42, 1.32));
}

Surface pitched_roof(const GroundPoint& at, const Box& box, const Vector2d& in) {
  const EpochLook& look = epoch_look(at.epoch);
  const double fp = at.footprint_m;
  const double slope = box.rise_m / box.half_width_m;
  const double from_gable = box.half_length_m - std::abs(in.x());
  const bool hip_end = box.kind == BoxKind::kHip && from_gable < box.half_width_m - std::abs(in.y());
  const Vector2d across = left_of(box.along);
  const Vector2d downhill =
      hip_end ? Vector2d(box.along * (in.x() > 0 ? 1.0 : -1.0)) : Vector2d(across * (in.y() > 0 ? 1.0 : -1.0));
  Surface surface;
  surface.cover = LandCover::kRoof;
  surface.light = side_light(downhill, slope, look);
  surface.height_m =
      static_cast<float>(box.height_m + slope * (hip_end ? from_gable : box.half_width_m - std::abs(in.y())));
  const float courses = 0.05F * surviving_detail(1.4, fp) * static_cast<float>(std::cos(in.y() * 4.5));
  const float moss = 0.07F * detail_noise(box.seed, at.p.x(), at.p.y(), 3.2, fp) +
                     0.04F * detail_noise(box.seed + 1, at.p.x(), at.p.y(), 0.8, fp);
  surface.colour = box.colour * (1 + courses + moss);
  surface.colour = surface.colour * (1 + 0.10F * line_coverage(in.y(), 0.18, fp));
  // Roof windows, solar panels on some, a chimney.
  const bool sunny_side = (across * (in.y() > 0 ? 1.0 : -1.0)).dot(look.to_sun) > 0;
  if (hash_part(box.seed, 0) < 0.16F && sunny_side && std::abs(in.x()) < 0.62 * box.half_length_m &&
      std::abs(std::abs(in.y()) - 0.5 * box.half_width_m) < 0.28 * box.half_width_m) {
    surface.colour = {46, 52, 66};
  }
  const double chimney_x = box.half_length_m * 0.7 * hash_signed(box.seed, 1);
  const double chimney_y = 0.25 * box.half_width_m * hash_signed(box.seed, 2);
  if (std::abs(in.x() - chimney_x) < 0.45 && std::abs(in.y() - chimney_y) < 0.45) surface.colour = {138, 104, 92};
  return surface;
}

Surface flat_roof(const GroundPoint& at, const Box& box, const Vector2d& in) {
  const double fp = at.footprint_m;
  Surface surface;
  surface.cover = LandCover::kRoof;
  surface.height_m = static_cast<float>(box.height_m);
  const float dirt = 0.06F * detail_noise(box.seed, at.p.x(), at.p.y(), 9, fp) +
                     0.05F * detail_noise(box.seed + 1, at.p.x(), at.p.y(), 2.4, fp);
  surface.colour = box.colour * (1 + dirt);
  // Parapet, then lights and plant on a lattice of its own.
  const double from_edge = std::min(box.half_length_m - std::abs(in.x()), box.half_width_m - std::abs(in.y()));
  surface.colour = surface.colour * (1 + 0.14F * line_coverage(from_edge - 0.25, 0.25, fp));
  const std::int64_t column = floor_to_int(in.x() / 6.5);
  const std::int64_t row = floor_to_int(in.y() / 5.0);
  const std::uint64_t hash = lattice_hash(box.seed, column, row);
  if (from_edge > 1.5 && hash_part(hash, 0) < 0.42F && box.half_length_m > 8) {
    const double u = in.x() - 6.5 * (static_cast<double>(column) + 0.5);
    const double v = in.y() - 5.0 * (static_cast<double>(row) + 0.5);
    const double half_u = 0.5 + 1.3 * hash_part(hash, 1);
    const double half_v = 0.5 + 0.9 * hash_part(hash, 2);
    if (std::abs(u) < half_u && std::abs(v) < half_v) {
      surface.colour = hash_part(hash, 3) < 0.5F ? Rgb{208, 212, 214} : Rgb{104, 108, 112};
    } else {
      const Vector2d step =
          Vector2d(epoch_look(at.epoch).to_sun.dot(box.along), epoch_look(at.epoch).to_sun.dot(left_of(box.along))) *
          1.6;
      if (segment_meets({u, v}, step, half_u, half_v)) surface.light = 0.62F;
    }
  }
  return surface;
}

Surface vehicle(const Box& box, const Vector2d& in) {
  const double nose = in.x() / box.half_length_m;
  const bool glass = box.half_length_m < 3 && ((nose > 0.18 && nose < 0.45) || (nose > -0.75 && nose < -0.55));
  return {glass ? Rgb{52, 58, 66} : box.colour, LandCover::kVehicle, 1, static_cast<float>(box.height_m)};
}

/// Painted steel with a darker rim, dust and a walkway across.
Surface tank_surface(const GroundPoint& at, const Box& box, const Vector2d& in) {
  const double fp = at.footprint_m;
  const float dust = 0.05F * detail_noise(box.seed, at.p.x(), at.p.y(), 7, fp) +
                     0.04F * detail_noise(box.seed + at.fresh_seed, at.p.x(), at.p.y(), 2, fp);
  const double from_rim = box.half_length_m - in.norm();
  const double angle = 6.28 * hash_part(box.seed, 1);
  const double from_walkway = in.dot(Vector2d(std::cos(angle), std::sin(angle)));
  Surface surface{box.colour * (1 + dust), LandCover::kRoof, 1, static_cast<float>(box.height_m)};
  surface.colour = surface.colour * (1 - 0.35F * line_coverage(from_rim - 0.4, 0.4, fp));
  surface.colour = surface.colour * (1 - 0.12F * line_coverage(from_walkway, 0.5, fp));
  return surface;
}

/// A ring road around an island of grass.
Surface roundabout_surface(const GroundPoint& at, const Box& box, const Vector2d& in) {
  const double fp = at.footprint_m;
  const double r = in.norm() / box.half_length_m;
  const auto height = static_cast<float>(box.height_m);
  if (r < 0.45) return {grass_colour(at, {96, 116, 66}, 0.6F), LandCover::kGrass, 1, height};
  const float grain = 0.04F * detail_noise(box.seed, at.p.x(), at.p.y(), 5, fp);
  Surface surface{Rgb{122, 120, 118} * (1 + grain), LandCover::kRoad, 1, height};
  const float kerb = line_coverage((r - 0.45) * box.half_length_m - 0.3, 0.3, fp) +
                     line_coverage((1 - r) * box.half_length_m - 0.3, 0.3, fp);
  surface.colour = blend(surface.colour, {206, 204, 198}, 0.8F * std::min(kerb, 1.0F));
  return surface;
}

/// A pale ring with a pad in its middle, as of a landing place or a settling basin that is dry.
Surface ring_surface(const GroundPoint& at, const Box& box, const Vector2d& in) {
  const double r = in.norm() / box.half_length_m;
  const auto height = static_cast<float>(box.height_m);
  if (r > 0.78 || r < 0.24) {
    const float grain = 0.05F * detail_noise(box.seed, at.p.x(), at.p.y(), 3, at.footprint_m);
    return {box.colour * (1 + grain), LandCover::kPavement, 1, height};
  }
  return {grass_colour(at, {108, 116, 74}, 0.8F), LandCover::kGrass, 1, height};
}

Surface box_surface(const GroundPoint& at, const Box& box, const Vector2d& in) {
  switch (box.kind) {
    case BoxKind::kFlat:
      return flat_roof(at, box, in);
    case BoxKind::kVehicle:
      return vehicle(box, in);
    case BoxKind::kTank:
      return tank_surface(at, box, in);
    case BoxKind::kRoundabout:
      return roundabout_surface(at, box, in);
    case BoxKind::kRing:
      return ring_surface(at, box, in);
    case BoxKind::kGable:
    case BoxKind::kHip:
      break;
  }
  return pitched_roof(at, box, in);
}

Surface tree_surface(const GroundPoint& at, const Tree& tree, const Vector2d& offset, float dome_height_m) {
  const float tone = hash_signed(tree.seed, 0);
  const float turned = at.epoch == SceneEpoch::kSecond ? smooth_step(0.5F, 1.0F, hash_part(tree.seed, 1)) : 0.0F;
  const Rgb green{76 + 12 * tone, 98 + 10 * tone, 52 + 8 * tone};
  const float leaves = 0.13F * detail_noise(at.fresh_seed + 91, at.p.x(), at.p.y(), 1.3, at.footprint_m) +
                       0.08F * detail_noise(at.fresh_seed + 92, at.p.x(), at.p.y(), 0.6, at.footprint_m);
  return {blend(green, {128, 106, 54}, turned) * (1 + leaves), LandCover::kTree,
          crown_light(offset, epoch_look(at.epoch)), dome_height_m};
}

/// Distance from the middle of what is round to the ray towards the sun, as far as that is below its height.
double distance_to_ray(const Vector2d& from_center, const Vector2d& to_sun, double length_m) {
  const double t = std::clamp(-from_center.dot(to_sun), 0.0, length_m);
  return (from_center + t * to_sun).norm();
}

bool lies_on(const Box& box, const Vector2d& in) {
  if (is_round(box.kind)) return in.norm() < box.half_length_m;
  return std::abs(in.x()) < box.half_length_m && std::abs(in.y()) < box.half_width_m;
}

bool shades(const Box& box, const Vector2d& in, const Vector2d& sun, double length_m) {
  if (is_round(box.kind)) return distance_to_ray(in, sun, length_m) < box.half_length_m;
  return segment_meets(in, sun * length_m, box.half_length_m, box.half_width_m);
}

}  // namespace

float overlay_objects(const ObjectIndex& objects, const GroundPoint& at, Surface& surface) {
  const int cell = objects.cell_of(at.p);
  if (cell < 0) return 1;
  const auto index = static_cast<std::size_t>(cell);
  const EpochLook& look = epoch_look(at.epoch);
  const auto bit = static_cast<unsigned>(1U << epoch_index(at.epoch));
  for (std::uint32_t i = objects.box_starts[index]; i < objects.box_starts[index + 1]; ++i) {
    const Box& box = objects.boxes[objects.box_ids[i]];
    if ((box.epochs & bit) == 0) continue;
    const Vector2d in = in_box(box, at.p);
    if (lies_on(box, in) && box.height_m > surface.height_m) {
      surface = box_surface(at, box, in);
    }
  }
  for (std::uint32_t i = objects.tree_starts[index]; i < objects.tree_starts[index + 1]; ++i) {
    const Tree& tree = objects.trees[objects.tree_ids[i]];
    const Vector2d from_center = at.p - tree.center_m;
    if (from_center.squaredNorm() > 1.3 * tree.radius_m * tree.radius_m) continue;
    const double ragged = tree.radius_m * look.foliage *
                          (1 + 0.20 * detail_noise(tree.seed + at.fresh_seed, at.p.x(), at.p.y(), 1.9, at.footprint_m));
    const double d2 = from_center.squaredNorm() / (ragged * ragged);
    const auto height = static_cast<float>(tree.height_m * (1 - 0.45 * d2));
    if (d2 < 1 && height > surface.height_m) surface = tree_surface(at, tree, from_center / ragged, height);
  }
  float light = 1;
  for (std::uint32_t i = objects.box_starts[index]; i < objects.box_starts[index + 1]; ++i) {
    const Box& box = objects.boxes[objects.box_ids[i]];
    const double above = box.height_m + 0.5 * box.rise_m - surface.height_m;
    if ((box.epochs & bit) == 0 || above < 0.3) continue;
    const Vector2d in = in_box(box, at.p);
    const Vector2d sun(look.to_sun.dot(box.along), look.to_sun.dot(left_of(box.along)));
    if (shades(box, in, sun, above / look.tan_elevation)) light = 0;
  }
  for (std::uint32_t i = objects.tree_starts[index]; i < objects.tree_starts[index + 1] && light > 0; ++i) {
    const Tree& tree = objects.trees[objects.tree_ids[i]];
    const double above = 0.72 * tree.height_m - surface.height_m;
    if (above < 0.3) continue;
    const double distance = distance_to_ray(at.p - tree.center_m, look.to_sun, above / look.tan_elevation);
    light *= smooth_step(0.80F, 1.0F, static_cast<float>(distance / (tree.radius_m * look.foliage)));
  }
  return light;
}

}  // namespace pilotage::scene_detail
