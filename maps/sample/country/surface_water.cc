#include <cmath>

#include "country/noise.h"
#include "country/surface.h"

namespace pilotage::scene_detail {

Surface water_surface(const GroundPoint& at, float depth_m) {
  const double x = at.p.x();
  const double y = at.p.y();
  const bool second = at.epoch == SceneEpoch::kSecond;
  const Rgb deep = second ? Rgb{62, 74, 74} : Rgb{54, 72, 70};
  const Rgb shoal = second ? Rgb{104, 104, 82} : Rgb{92, 100, 78};
  Rgb colour = blend(shoal, deep, smooth_step(0, 11, depth_m));
  // Wind stripes and currents differ at each date, and so does the grain of glint.
  const double turn = second ? 0.7 : 0.2;
  const double u = x * std::cos(turn) + y * std::sin(turn);
  const double v = -x * std::sin(turn) + y * std::cos(turn);
  const float breeze = gradient_noise(at.fresh_seed + 61, u / 190, v / 60);
  const float ripples = surviving_detail(2.2, at.footprint_m) * gradient_noise(at.fresh_seed + 62, u / 5.0, v / 2.2) +
                        0.7F * detail_noise(at.fresh_seed + 63, x, y, 0.8, at.footprint_m);
  colour = colour * (1 + 0.045F * breeze + (0.012F + 0.012F * clamp01(breeze)) * ripples);
  return {colour, LandCover::kWater, 1, 0};
}

Surface bank_surface(const GroundPoint& at, float depth_m) {
  const double x = at.p.x();
  const double y = at.p.y();
  const float reeds = smooth_step(
      -0.15F, 0.35F,
      gradient_noise(at.seed + 64, x / 38, y / 38) + 0.3F * detail_noise(at.seed + 65, x, y, 6, at.footprint_m));
  const float grain = detail_noise(at.fresh_seed + 66, x, y, 1.3, at.footprint_m) +
                      0.5F * detail_noise(at.fresh_seed + 67, x, y, 3.5, at.footprint_m);
  const Rgb sand = Rgb{168, 154, 124} * (1 + 0.05F * grain - 0.16F * smooth_step(-2.0F, 0.0F, depth_m));
  const Rgb reed = (at.epoch == SceneEpoch::kSecond ? Rgb{132, 120, 80} : Rgb{96, 110, 60}) * (1 + 0.20F * grain);
  return {blend(sand, reed, reeds), LandCover::kBank, 1, 0};
}

}  // namespace pilotage::scene_detail
