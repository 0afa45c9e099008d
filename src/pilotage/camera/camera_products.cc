#include "pilotage/camera/camera_products.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "pilotage/base/product_name.h"

namespace pilotage {
namespace {

constexpr std::string_view kQgcList = "QGroundControl, src/Camera/CameraMetaData.json";

CameraProduct by_diagonal(std::string_view name, std::string_view also, int width_px, int height_px,
                          double diagonal_fov_deg, std::string_view source, int dji_payload = -1) {
  return {name, also, width_px, height_px, diagonal_fov_deg, 0, 0, 0, 0, dji_payload, source};
}

CameraProduct by_width(std::string_view name, int width_px, int height_px, double horizontal_fov_deg,
                       std::string_view source) {
  return {name, "", width_px, height_px, 0, horizontal_fov_deg, 0, 0, 0, -1, source};
}

CameraProduct by_sensor(std::string_view name, double sensor_width_mm, double sensor_height_mm, double focal_length_mm,
                        int width_px, int height_px, std::string_view source = kQgcList) {
  return {name, "", width_px, height_px, 0, 0, sensor_width_mm, sensor_height_mm, focal_length_mm, -1, source};
}

const std::vector<CameraProduct>& product_list() {
  static const std::vector<CameraProduct> kProducts = {
      by_sensor("Canon EOS-M 22mm", 22.3, 14.9, 22, 5184, 3456),
      by_sensor("Canon S100 PowerShot", 7.6, 5.7, 5.2, 4000, 3000),
      by_diagonal("DJI Matrice 30", "M30", 4000, 3000, 84, "enterprise.dji.com/matrice-30/specs", 52),
      by_diagonal("DJI Matrice 30T", "M30T", 4000, 3000, 84, "enterprise.dji.com/matrice-30/specs", 53),
      by_diagonal("DJI Matrice 3D", "M3D", 5280, 3956, 84, "enterprise.dji.com/dock-2/specs", 80),
      by_diagonal("DJI Matrice 4E", "M4E", 5280, 3956, 84, "enterprise.dji.com/matrice-4-series/specs", 88),
      by_diagonal("DJI Mavic 2 Pro", "", 5472, 3648, 77, "dji.com/mavic-2/info"),
      by_diagonal("DJI Mavic 3", "", 5280, 3956, 84, "dji.com/mavic-3/specs"),
      by_diagonal("DJI Mavic 3E", "M3E", 5280, 3956, 84, "enterprise.dji.com/mavic-3-enterprise/specs", 66),
      by_diagonal("DJI Mavic 3M", "M3M", 5280, 3956, 84, "ag.dji.com/mavic-3-m/specs", 68),
      by_diagonal("DJI Mavic 3T", "M3T", 8000, 6000, 84, "enterprise.dji.com/mavic-3-enterprise/specs", 67),
      by_diagonal("DJI Mini 4 Pro", "", 8064, 6048, 82.1, "dji.com/mini-4-pro/specs"),
      by_diagonal("DJI Phantom 4 Pro", "P4P", 5472, 3648, 84, "dji.com/phantom-4-pro/info"),
      by_diagonal("DJI Phantom 4 RTK", "P4R", 5472, 3648, 84, "dji.com/phantom-4-rtk/info"),
      by_sensor("DJI Zenmuse P1 35mm", 35.9, 24, 35, 8192, 5460, "enterprise.dji.com/zenmuse-p1/specs"),
      by_width("Raspberry Pi Camera Module 2", 3280, 2464, 62.2,
               "raspberrypi.com/documentation/accessories/camera.html"),
      by_width("Raspberry Pi Camera Module 3", 4608, 2592, 66, "raspberrypi.com/documentation/accessories/camera.html"),
      by_width("Raspberry Pi Camera Module 3 Wide", 4608, 2592, 102,
               "raspberrypi.com/documentation/accessories/camera.html"),
      by_sensor("Ricoh GR II", 23.7, 15.7, 18.3, 4928, 3264),
      by_sensor("Sony DSC-RX0", 13.2, 8.8, 7.7, 4800, 3200),
      by_sensor("Sony DSC-RX1R II 35mm", 35.9, 24, 35, 7952, 5304),
      by_sensor("Sony RX100 II 28mm", 13.2, 8.8, 10.4, 5472, 3648),
      by_sensor("Sony a6000 16mm", 23.5, 15.6, 16, 6000, 4000),
      by_sensor("Sony a6000 35mm", 23.5, 15.6, 35, 6000, 4000),
      by_sensor("Sony a7R III 35mm", 35.9, 24, 35, 7952, 5304),
      by_sensor("Sony a7R IV 35mm", 35.7, 23.8, 35, 9504, 6336),
      by_sensor("Yuneec E90", 13.3056, 8.656, 8.29, 5472, 3648),
  };
  return kProducts;
}

/// Focal length in widths of the image.
double focal_widths(const CameraProduct& product) {
  constexpr double kRad = std::numbers::pi / 180;
  if (product.sensor_width_mm > 0) return product.focal_length_mm / product.sensor_width_mm;
  if (product.horizontal_fov_deg > 0) return 0.5 / std::tan(product.horizontal_fov_deg / 2 * kRad);
  const double diagonal = std::hypot(1.0, static_cast<double>(product.height_px) / product.width_px);
  return diagonal / 2 / std::tan(product.diagonal_fov_deg / 2 * kRad);
}

}  // namespace

std::span<const CameraProduct> camera_products() {
  return product_list();
}

const CameraProduct& camera_product(std::string_view name) {
  std::vector<ProductName> names;
  for (const CameraProduct& product : product_list()) names.push_back({product.name, product.also});
  return product_list()[product_of_name(
      name, names, {"camera", "--camera-name", "any camera can be given by its field of view or its sensor"})];
}

const CameraProduct* dji_camera_product(int payload) {
  const auto& products = product_list();
  const auto found = std::find_if(products.begin(), products.end(), [&](const CameraProduct& product) {
    return payload >= 0 && product.dji_payload == payload;
  });
  return found == products.end() ? nullptr : &*found;
}

Camera camera_of(const CameraProduct& product) {
  Camera camera;
  camera.width_px = product.width_px;
  camera.height_px = product.height_px;
  camera.fx_px = camera.fy_px = focal_widths(product) * product.width_px;
  camera.cx_px = product.width_px / 2.0;
  camera.cy_px = product.height_px / 2.0;
  return camera;
}

double horizontal_fov_deg(const CameraProduct& product) {
  return 2 * std::atan(0.5 / focal_widths(product)) * 180 / std::numbers::pi;
}

RouteCamera route_camera_of(const CameraProduct& product) {
  RouteCamera camera;
  camera.name = product.name;
  camera.image_width_px = product.width_px;
  camera.image_height_px = product.height_px;
  const double aspect = static_cast<double>(product.height_px) / product.width_px;
  constexpr double kFilmDiagonal_mm = 43.267;  // of 36 mm x 24 mm
  camera.sensor_width_mm =
      product.sensor_width_mm > 0 ? product.sensor_width_mm : kFilmDiagonal_mm / std::hypot(1.0, aspect);
  camera.sensor_height_mm = camera.sensor_width_mm * aspect;
  camera.focal_length_mm = focal_widths(product) * camera.sensor_width_mm;
  return camera;
}

}  // namespace pilotage
