#include <cmath>

#include "pilotage/scene/noise.h"
#include "pilotage/scene/surface.h"

namespace pilotage::scene_detail {
namespace {

using Eigen::Vector2d;

/// The crown that is highest over a point.
struct Canopy {
  float height_m = 0;     ///< 0 in a gap.
  Vector2d offset{0, 0};  ///< From the crown's middle, in radii.
  std::uint64_t seed = 0;
};

struct Stand {
  double cell_m = 6.4;
  double jitter = 0.27;      ///< Of the crowns' middles, in cells.
  double radius_low = 0.46;  ///< In cells.
  double radius_high = 0.66;
  float height_m = 17;
  float dome = 0.45F;  ///< Share of the height that the crown's dome makes up.
  double gaps = 0.05;  ///< Share of cells without a tree.
};

constexpr Stand kBroadleaved{};
constexpr Stand kConifers{3.7, 0.13, 0.44, 0.60, 16, 0.65F, 0.03};

/// Highest crown over point `f`, of the four cells whose corner is nearest.
Canopy canopy_at(std::uint64_t seed, const Stand& stand, const Vector2d& f, float foliage) {
  const double x = f.x() / stand.cell_m;
  const double y = f.y() / stand.cell_m;
  const std::int64_t column = floor_to_int(x - 0.5);
  const std::int64_t row = floor_to_int(y - 0.5);
  Canopy best;
  for (int i = 0; i < 4; ++i) {
    const std::int64_t c = column + (i & 1);
    const std::int64_t r = row + (i >> 1);
    const std::uint64_t hash = lattice_hash(seed, c, r);
    if (hash_part(hash, 3) < stand.gaps) continue;
    const double radius = (stand.radius_low + (stand.radius_high - stand.radius_low) * hash_part(hash, 2)) * foliage;
    const Vector2d offset((x - static_cast<double>(c) - 0.5 - stand.jitter * hash_signed(hash, 0)) / radius,
                          (y - static_cast<double>(r) - 0.5 - stand.jitter * hash_signed(hash, 1)) / radius);
    const double d2 = offset.squaredNorm();
    if (d2 >= 1) continue;
    const float full = stand.height_m * (0.72F + 0.42F * hash_part(hash, 2));
    const float height = full * (1 - stand.dome * static_cast<float>(d2));
    if (height > best.height_m) best = {height, offset, hash};
  }
  return best;
}

Rgb crown_colour(const Canopy& crown, bool conifers, SceneEpoch epoch) {
  const float tone = hash_signed(crown.seed, 1);
  const float hue = hash_part(crown.seed, 0);
  if (conifers) return Rgb{52 + 5 * tone, 70 + 7 * tone, 46 + 4 * tone};
  if (epoch == SceneEpoch::kFirst) return Rgb{70 + 14 * hue + 7 * tone, 92 + 9 * tone, 48 + 6 * tone};
  // Some crowns turn yellow or brown.
  const float turned = smooth_step(0.45F, 0.95F, hue);
  return blend(Rgb{76 + 8 * tone, 88 + 9 * tone, 50 + 5 * tone}, Rgb{128 + 10 * tone, 104 + 10 * tone, 54}, turned);
}

}  // namespace

float crown_light(const Vector2d& offset, const EpochLook& look) {
  // A dome: the side towards the sun is bright, the far side dark.
  const auto facing = static_cast<float>(offset.dot(look.to_sun));
  const auto edge = static_cast<float>(offset.squaredNorm());
  return 1.05F + 0.42F * facing - 0.22F * edge;
}

Surface forest_surface(const GroundPoint& at) {
  const EpochLook& look = epoch_look(at.epoch);
  const bool conifers = at.parcel->use == LandUse::kConifers;
  const Stand& stand = conifers ? kConifers : kBroadleaved;
  const float foliage = conifers ? 1.0F : look.foliage;
  const std::uint64_t seed = at.seed + (conifers ? 51 : 50);
  // Clumps: crowns are wider and higher where the stand is good; leaves stir the outline.
  const double stir = 0.55;
  const Vector2d f = at.p + stir * Vector2d(detail_noise(at.fresh_seed + 52, at.p.x(), at.p.y(), 2.1, at.footprint_m),
                                            detail_noise(at.fresh_seed + 53, at.p.x(), at.p.y(), 2.1, at.footprint_m));
  const float vigour = 1 + 0.13F * at.node.stand;
  const Canopy crown = canopy_at(seed, stand, f, foliage * vigour);
  const float leaves = 0.13F * detail_noise(at.fresh_seed + 54, at.p.x(), at.p.y(), 1.5, at.footprint_m) +
                       0.09F * detail_noise(at.fresh_seed + 55, at.p.x(), at.p.y(), 0.6, at.footprint_m);
  // A neighbour towards the sun shades the crown when it stands above the ray.
  float shade = 1;
  for (const double step_m : {2.4, 5.2}) {
    const Canopy sunward = canopy_at(seed, stand, f + look.to_sun * step_m, foliage * vigour);
    const float above = sunward.height_m - crown.height_m - static_cast<float>(step_m * look.tan_elevation);
    shade *= 1 - 0.50F * smooth_step(-0.6F, 1.4F, above);
  }
  if (crown.height_m <= 0) {
    const Rgb floor_colour = at.epoch == SceneEpoch::kFirst ? Rgb{58, 66, 42} : Rgb{80, 70, 50};
    return {floor_colour * (1 + 2 * leaves), LandCover::kForest, 0.7F * shade, 0};
  }
  const Rgb colour = crown_colour(crown, conifers, at.epoch) * (1 + leaves + 0.08F * at.node.stand);
  return {colour, LandCover::kForest, crown_light(crown.offset, look) * shade, crown.height_m};
}

Surface orchard_surface(const GroundPoint& at) {
  const EpochLook& look = epoch_look(at.epoch);
  const Vector2d rows = at.parcel->rows;
  const double along = rows.dot(at.p) / kOrchardTree_m;
  const double across = Vector2d(-rows.y(), rows.x()).dot(at.p) / kOrchardRow_m;
  const bool second = at.epoch == SceneEpoch::kSecond;
  const auto row_place = static_cast<float>(across - std::floor(across) - 0.5);
  // Mown grass between the rows, bare ground under the trees.
  const Rgb grass = grass_colour(at, second ? Rgb{120, 122, 78} : Rgb{112, 126, 74}, 0.5F);
  Surface surface{blend(grass, {122, 108, 84}, 0.55F * smooth_step(0.17F, 0.10F, std::abs(row_place))),
                  LandCover::kOrchard, 1, 0};
  // Margin for turning.
  if (at.edge_m < at.edge->half_width_m + 6) return surface;
  const auto try_tree = [&](std::int64_t column, std::int64_t row, Surface& result, float& shadow) {
    const std::uint64_t hash = lattice_hash(at.parcel->seed, column, row);
    if (hash_part(hash, 3) < 0.015F) return;  // a tree that died
    const double radius = 1.62 + 0.16 * hash_signed(hash, 0);
    const float height = 3.4F;
    const Vector2d center =
        (static_cast<double>(column) + 0.5 + 0.012 * hash_signed(hash, 1)) * kOrchardTree_m * rows +
        (static_cast<double>(row) + 0.5 + 0.010 * hash_signed(hash, 2)) * kOrchardRow_m * Vector2d(-rows.y(), rows.x());
    const Vector2d offset = at.p - center;
    const double ragged =
        radius * (1 + 0.10 * detail_noise(at.fresh_seed + 56, at.p.x(), at.p.y(), 0.9, at.footprint_m));
    if (offset.squaredNorm() < ragged * ragged) {
      const float leaves = 0.12F * detail_noise(at.fresh_seed + 57, at.p.x(), at.p.y(), 1.0, at.footprint_m);
      const Rgb crown = second ? Rgb{92, 94, 54} : Rgb{78, 98, 54};
      result = {crown * (1 + leaves + 0.05F * hash_signed(hash, 1)), LandCover::kOrchard,
                crown_light(offset / ragged, look), height};
      return;
    }
    const Vector2d from_shadow = offset + look.to_sun * (0.75 * height / look.tan_elevation);
    if (from_shadow.squaredNorm() < radius * radius) shadow = 0.5F;
  };
  float shadow = 1;
  const std::int64_t column = floor_to_int(along);
  const std::int64_t row = floor_to_int(across);
  for (std::int64_t r = row - 1; r <= row + 1; ++r) {
    for (std::int64_t c = column - 1; c <= column + 1; ++c) try_tree(c, r, surface, shadow);
  }
  if (surface.height_m <= 0) surface.light *= shadow;
  return surface;
}

}  // namespace pilotage::scene_detail
