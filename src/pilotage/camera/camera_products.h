#pragma once

#include <span>
#include <string>
#include <string_view>

#include "pilotage/camera/camera.h"
#include "pilotage/camera/route_camera.h"

namespace pilotage {

/// A camera one can buy, with the figures that its maker or a published list states for its whole photo. One of three
/// ways to say the field of view is there; the figures of the others are 0.
struct CameraProduct {
  std::string_view name;
  std::string_view also;  ///< Another name it is known by; "" for none.
  int width_px = 0;
  int height_px = 0;
  double diagonal_fov_deg = 0;
  double horizontal_fov_deg = 0;
  double sensor_width_mm = 0;
  double sensor_height_mm = 0;
  double focal_length_mm = 0;
  int dji_payload = -1;     ///< payloadEnumValue of DJI missions; -1 for none.
  std::string_view source;  ///< Where the figures stand.
};

/// All of them, by name (docs/methods/products.md).
std::span<const CameraProduct> camera_products();

/// The product of that name, or of that other name; case, blanks and punctuation do not matter. Throws UsageError that
/// names those spelt most alike; for the name "list" one that names all.
const CameraProduct& camera_product(std::string_view name);

/// The product of a DJI payload number; nullptr when the table has none.
const CameraProduct* dji_camera_product(int payload);

/// An ideal lens with the product's field of view: square pixels, principal point in the middle.
Camera camera_of(const CameraProduct& product);

double horizontal_fov_deg(const CameraProduct& product);

/// The same as sensor figures: the product's own where its source states them, else those of a sensor of the image's
/// shape with the diagonal of 35 mm film (43.267 mm).
RouteCamera route_camera_of(const CameraProduct& product);

}  // namespace pilotage
