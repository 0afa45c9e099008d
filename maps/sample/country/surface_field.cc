#include <cmath>
#include <numbers>

#include "country/field_look.h"
#include "country/noise.h"
#include "country/surface.h"

namespace pilotage::scene_detail {
namespace {

using Eigen::Vector2d;

float wave(double metres, double spacing_m, double footprint_m) {
  return surviving_detail(spacing_m, footprint_m) *
         static_cast<float>(std::cos(2 * std::numbers::pi * metres / spacing_m));
}

/// Distance to the nearest multiple of `spacing_m`.
double to_multiple(double metres, double spacing_m) {
  return std::abs(metres - spacing_m * std::round(metres / spacing_m));
}

/// Opacity of a sprayer's two wheel tracks.
float tramline(double across_m, double footprint_m) {
  const double from_axis = to_multiple(across_m, kTramline_m);
  return line_coverage(from_axis - 0.95, 0.28, footprint_m);
}

}  // namespace

Rgb grass_colour(const GroundPoint& at, const Rgb& tone, float patchiness) {
  const double x = at.p.x();
  const double y = at.p.y();
  const float growth = detail_noise(at.seed + 21, x, y, 13, at.footprint_m) +
                       0.6F * detail_noise(at.fresh_seed + 21, x, y, 5, at.footprint_m);
  const float blades = 0.07F * detail_noise(at.fresh_seed + 22, x, y, 1.7, at.footprint_m) +
                       0.05F * detail_noise(at.fresh_seed + 23, x, y, 0.7, at.footprint_m);
  const float dry = clamp01(0.5F + patchiness * (0.55F * at.node.soil + 0.5F * growth) -
                            (at.epoch == SceneEpoch::kSecond ? 0.2F : 0.5F));
  const Rgb dry_tone{tone.r * 1.30F, tone.g * 1.12F, tone.b * 1.18F};
  return blend(tone, dry_tone, dry) * (1 + blades + 0.06F * growth * patchiness);
}

Surface field_surface(const GroundPoint& at) {
  const FieldLook& look = field_look(at.parcel->crop, at.epoch);
  const double headland_m = 17 + 6 * hash_part(at.parcel->seed, 0);
  const bool headland = at.edge_m < headland_m;
  const Vector2d rows = headland ? at.edge->direction() : at.parcel->rows;
  const double across = headland ? at.edge_m - at.edge->half_width_m - 0.5 * kTramline_m + 3
                                 : Vector2d(-rows.y(), rows.x()).dot(at.q - at.parcel->center_m);
  const double along = rows.dot(at.q);
  const double fp = at.footprint_m;
  const std::uint64_t own = at.parcel->seed;
  const float tone =
      1 + 0.10F * hash_signed(own, 1) + (at.epoch == SceneEpoch::kSecond ? 0.07F : 0.0F) * hash_signed(own, 2);

  float light = 1 + look.patches * 0.9F * at.node.soil;
  light += look.mottle * (detail_noise(at.fresh_seed + 31, at.p.x(), at.p.y(), 17, fp) +
                          0.7F * detail_noise(at.fresh_seed + 32, at.p.x(), at.p.y(), 6.5, fp));
  // What machines leave: streaks along the direction of work, and rows.
  light += (0.4F * look.mottle + 0.25F * look.rows) * gradient_noise(at.fresh_seed ^ own, across / 3.1, along / 70);
  light +=
      look.rows * (0.55F + 0.6F * gradient_noise(own, across / 9.0, along / 40)) * wave(across, look.row_spacing_m, fp);
  light += look.swaths * std::fmax(-0.4F, wave(across, 7.5, fp));
  light += look.grain * (detail_noise(at.fresh_seed + 33, at.p.x(), at.p.y(), 1.6, fp) +
                         0.8F * detail_noise(at.fresh_seed + 34, at.p.x(), at.p.y(), 0.7, fp));
  if (headland) light *= 0.965F;

  Rgb colour = look.colour * tone;
  colour.r *= 1 + 0.05F * hash_signed(own, 3);
  // Thin growth shows the soil.
  colour = blend(colour, look.soil, clamp01(0.9F * look.patches * (at.node.soil - 0.35F) * 5));
  colour = blend(colour, look.soil * 0.93F, look.tramlines * tramline(across, fp));
  return {colour * light, LandCover::kField, 1, 0};
}

Surface meadow_surface(const GroundPoint& at) {
  const bool second = at.epoch == SceneEpoch::kSecond;
  const float own = hash_signed(at.parcel->seed, 0);
  const Rgb tone = second ? Rgb{118 + 10 * own, 122, 76} : Rgb{98 + 8 * own, 118 + 5 * own, 66};
  Rgb colour = grass_colour(at, tone, 0.9F);
  const float tufts = detail_noise(at.seed + 24, at.p.x(), at.p.y(), 7, at.footprint_m);
  colour = colour * (1 + 0.10F * at.node.stand * (second ? 0.6F : 1.0F) - 0.10F * smooth_step(0.25F, 0.7F, tufts));
  // Some meadows are mown in strips by the second date.
  if (second && hash_part(at.parcel->seed, 1) < 0.5F) {
    const double across = Vector2d(-at.parcel->rows.y(), at.parcel->rows.x()).dot(at.q);
    colour = colour * (1.05F + 0.05F * wave(across, 6, at.footprint_m));
  }
  return {colour, LandCover::kGrass, 1, 0};
}

Surface strip_surface(const GroundPoint& at) {
  const bool second = at.epoch == SceneEpoch::kSecond;
  const bool hedge = at.edge->kind == EdgeKind::kHedge;
  const Rgb tone = hedge ? Rgb{76, 92, 52} : (second ? Rgb{128, 124, 82} : Rgb{106, 118, 70});
  return {
      grass_colour(at, tone, 0.8F) * (1 + 0.10F * detail_noise(at.seed + 25, at.q.x(), at.q.y(), 4, at.footprint_m)),
      hedge ? LandCover::kTree : LandCover::kGrass, 1, 0};
}

Surface pit_surface(const GroundPoint& at) {
  const double x = at.p.x();
  const double y = at.p.y();
  const double fp = at.footprint_m;
  const float heaps =
      gradient_noise(at.seed + 41, x / 34, y / 34) + 0.55F * gradient_noise(at.seed + 42, x / 13, y / 13);
  const float heaps_sunward = gradient_noise(at.seed + 41, (x + 4 * epoch_look(at.epoch).to_sun.x()) / 34,
                                             (y + 4 * epoch_look(at.epoch).to_sun.y()) / 34) +
                              0.55F * gradient_noise(at.seed + 42, (x + 4 * epoch_look(at.epoch).to_sun.x()) / 13,
                                                     (y + 4 * epoch_look(at.epoch).to_sun.y()) / 13);
  const float ruts = gradient_noise(at.seed + 43, x / 2.2, y / 30) * surviving_detail(2.2, fp);
  const float grain = detail_noise(at.seed + 44, x, y, 2.4, fp) + 0.8F * detail_noise(at.seed + 45, x, y, 0.8, fp);
  Rgb colour = blend({186, 168, 138}, {150, 130, 106}, clamp01(0.5F + 0.6F * at.node.soil));
  const float weeds = smooth_step(0.35F, 0.75F, at.node.stand + 0.3F * detail_noise(at.fresh_seed + 46, x, y, 3, fp));
  colour = blend(colour, {98, 108, 66}, 0.75F * weeds);
  return {colour * (1 + 0.05F * ruts + 0.07F * grain), LandCover::kBare,
          clamp01(0.78F + 0.55F * (heaps - heaps_sunward)) + 0.18F, 0};
}

Surface farmyard_surface(const GroundPoint& at) {
  const float grain = detail_noise(at.seed + 47, at.p.x(), at.p.y(), 4.5, at.footprint_m) +
                      0.7F * detail_noise(at.seed + 48, at.p.x(), at.p.y(), 1.1, at.footprint_m);
  const Rgb colour = blend({158, 148, 130}, {124, 116, 100}, clamp01(0.5F + 0.8F * grain + 0.3F * at.node.soil));
  return {colour, LandCover::kBare, 1, 0};
}

}  // namespace pilotage::scene_detail
