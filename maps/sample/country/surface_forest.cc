#include <cmath>

#include "country/noise.h"
#include "country/surface.h"

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

constexpr Stand kBroadleaved{8.2, 0.34, 0.40, 0.61, 18, 0.36F, 0.14};
constexpr Stand kUndergrowth{4.6, 0.33, 0.42, 0.62, 13, 0.40F, 0.10};
constexpr Stand kConifers{4.3, 0.24, 0.42, 0.62, 17, 0.60F, 0.04};

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

Vector2d noise_vector(std::uint64_t seed, const Vector2d& p, double wavelength_m) {
  return {gradient_noise(seed, p.x() / wavelength_m, p.y() / wavelength_m),
          gradient_noise(seed ^ 0x5BD1E995U, p.x() / wavelength_m, p.y() / wavelength_m)};
}

/// Highest of the crowns of a wood: great trees over lesser ones, or conifers alone.
Canopy wood_canopy(const GroundPoint& at, const Vector2d& f, float foliage) {
  if (at.parcel->use == LandUse::kConifers) return canopy_at(at.seed + 51, kConifers, f, foliage);
  const Canopy great = canopy_at(at.seed + 50, kBroadleaved, f, foliage);
  const Canopy lesser = canopy_at(at.seed + 49, kUndergrowth, f, foliage);
  return great.height_m >= lesser.height_m ? great : lesser;
}

Rgb crown_colour(const Canopy& crown, const GroundPoint& at) {
  const float fresh = hash_signed(crown.seed, at.epoch == SceneEpoch::kFirst ? 2 : 3);
  const float tone = 0.6F * hash_signed(crown.seed, 1) + 0.8F * fresh;
  const float hue = hash_part(crown.seed, 0);
  const float parcel = hash_signed(at.parcel->seed, 2);
  if (at.parcel->use == LandUse::kConifers)
    return Rgb{58 + 5 * tone, 72 + 6 * tone, 52 + 4 * tone} * (1 + 0.10F * parcel);
  const Rgb june{78 + 12 * hue + 6 * tone + 5 * parcel, 96 + 8 * tone + 4 * hue, 58 + 5 * tone};
  if (at.epoch == SceneEpoch::kFirst) return june;
  // Some crowns turn yellow or brown, in some stands more than in others.
  const float turned = smooth_step(0.40F, 1.05F, hue + 0.18F * parcel + 0.12F * at.node.stand);
  return blend(Rgb{82 + 7 * tone, 90 + 7 * tone, 56 + 5 * tone}, Rgb{128 + 9 * tone, 108 + 9 * tone, 68}, turned);
}

}  // namespace

float crown_light(const Vector2d& offset, const EpochLook& look) {
  // A dome, flat on top: the side towards the sun is bright, the far side dark.
  const auto facing = static_cast<float>(offset.dot(look.to_sun));
  const auto edge = static_cast<float>(offset.squaredNorm());
  return 1.03F + facing * (0.20F + 0.14F * edge) - 0.16F * edge;
}

bool is_clearing(const GroundPoint& at) {
  return at.node.stand + 0.25F * detail_noise(at.seed + 58, at.p.x(), at.p.y(), 15, at.footprint_m) > 0.80F;
}

Surface forest_surface(const GroundPoint& at) {
  if (is_clearing(at)) return meadow_surface(at);
  const EpochLook& look = epoch_look(at.epoch);
  const double x = at.p.x();
  const double y = at.p.y();
  const double fp = at.footprint_m;
  // Trees stand on no lattice. At each date leaves stir the outline of crowns, and crowns lean this way or that: an
  // orthophoto made over the ground's heights displaces what stands above the ground by as much as it was seen from the
  // side.
  const Vector2d f = at.p + 1.7 * noise_vector(at.seed + 52, at.p, 13) +
                     2.4 * noise_vector(at.fresh_seed + 51, at.p, 70) +
                     0.75 * surviving_detail(2.3, fp) * noise_vector(at.fresh_seed + 53, at.p, 2.3);
  const float vigour = 1 + 0.10F * at.node.stand + 0.05F * hash_signed(at.parcel->seed, 1);
  const float foliage = (at.parcel->use == LandUse::kConifers ? 1.0F : look.foliage) * std::fmin(vigour, 1.12F);
  const Canopy crown = wood_canopy(at, f, foliage);
  const float leaves =
      0.18F * detail_noise(at.fresh_seed + 54, x, y, 1.9, fp) + 0.13F * detail_noise(at.fresh_seed + 55, x, y, 0.7, fp);
  // A neighbour towards the sun shades the crown when it stands above the ray.
  float shade = 1;
  for (const double step_m : {2.2, 5.0}) {
    const Canopy sunward = wood_canopy(at, f + look.to_sun * step_m, foliage);
    const float above = sunward.height_m - crown.height_m - static_cast<float>(step_m * look.tan_elevation);
    shade *= 1 - 0.46F * smooth_step(-1.0F, 2.4F, above);
  }
  if (crown.height_m <= 0) {
    const Rgb floor_colour = at.epoch == SceneEpoch::kFirst ? Rgb{60, 66, 46} : Rgb{78, 70, 54};
    return {floor_colour * (1 + 2 * leaves), LandCover::kForest, 0.78F * shade, 0};
  }
  const float depth = 0.80F + 0.20F * smooth_step(7, 15, crown.height_m);
  const Rgb colour = crown_colour(crown, at) * (depth * (1 + leaves + 0.11F * at.node.stand));
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
