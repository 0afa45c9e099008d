#pragma once

#include <span>
#include <string>
#include <string_view>

#include "pilotage/ins/ins_options.h"

namespace pilotage {

/// An inertial unit one can buy: the figures that its data sheet states in the sense of InsOptions, in the same units.
/// A figure that is 0 is not stated (or stated in another sense, as the in-run stability of a bias) and is that of
/// `grade`.
struct InsProduct {
  std::string_view name;
  std::string_view also;                     ///< Another name it is known by; "" for none.
  InsGrade grade = InsGrade::kConsumer;      ///< The class it belongs to.
  double angle_random_walk_deg_rt_h = 0;     ///< 60 times a noise density in °/s/√Hz.
  double velocity_random_walk_mps_rt_h = 0;  ///< 0.000588399 times a noise density in µg/√Hz.
  double gyro_bias_deg_h = 0;                ///< Repeatability or residual over temperature, one standard deviation.
  double accel_bias_mg = 0;
  double gyro_scale_ppm = 0;
  double accel_scale_ppm = 0;
  bool confirmed = true;    ///< False where no second text states the same figures.
  std::string_view source;  ///< Where the figures stand.
};

/// All of them, by name (docs/methods/ins.md).
std::span<const InsProduct> ins_products();

/// The product of that name, or of that other name; case, blanks and punctuation do not matter. Throws UsageError that
/// names those spelt most alike; for the name "list" one that names all.
const InsProduct& ins_product(std::string_view name);

/// What the options take for the inertial system, in a few words: "tactical INS", "VN-100 INS", "ICM-20689 INS (its
/// figures are not confirmed)"; ", with figures of your own" where one is given. Throws as ins_product.
std::string ins_text(const InsOptions& options);

}  // namespace pilotage
