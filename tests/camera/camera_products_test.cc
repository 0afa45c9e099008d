#include "pilotage/camera/camera_products.h"

#include <cmath>
#include <set>
#include <string>

#include "testing/error_of.h"
#include "testing/source_folder.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pilotage/base/error.h"
#include "pilotage/base/output_file.h"
#include "pilotage/camera/camera_options.h"

namespace pilotage {
namespace {

using ::testing::HasSubstr;

TEST(CameraProducts, EachIsSoundAndItsOwn) {
  std::set<int> payloads;
  for (const CameraProduct& product : camera_products()) {
    EXPECT_EQ(&camera_product(product.name), &product) << product.name;
    if (!product.also.empty()) {
      EXPECT_EQ(&camera_product(product.also), &product) << product.also;
    }
    EXPECT_FALSE(product.source.empty()) << product.name;
    EXPECT_EQ(camera_problem(camera_of(product)), "") << product.name;
    const int ways = (product.diagonal_fov_deg > 0 ? 1 : 0) + (product.horizontal_fov_deg > 0 ? 1 : 0) +
                     (product.sensor_width_mm > 0 ? 1 : 0);
    EXPECT_EQ(ways, 1) << product.name;
    if (product.dji_payload >= 0) {
      EXPECT_TRUE(payloads.insert(product.dji_payload).second) << product.dji_payload;
    }
    // Both ways to use a product are one camera.
    CameraOptions by_name;
    by_name.name = product.name;
    const Camera direct = make_camera(by_name);
    const Camera by_route = make_camera({}, route_camera_of(product));
    EXPECT_NEAR(by_route.fx_px, direct.fx_px, 1e-6) << product.name;
    EXPECT_EQ(by_route.width_px, direct.width_px);
    // A sensor of another shape than its image would be a slip of the table.
    if (product.sensor_width_mm > 0) {
      EXPECT_NEAR(product.sensor_height_mm / product.sensor_width_mm * product.width_px / product.height_px, 1, 0.03)
          << product.name;
    }
  }
}

TEST(CameraProducts, FieldsOfViewAreThoseOfTheDataSheets) {
  EXPECT_NEAR(horizontal_fov_deg(camera_product("DJI Phantom 4 RTK")), 73.7, 0.05)
      << "84 degrees over the diagonal, 3:2";
  EXPECT_NEAR(horizontal_fov_deg(camera_product("dji mavic-3e")), 71.6, 0.05);
  EXPECT_NEAR(horizontal_fov_deg(camera_product("Raspberry Pi Camera Module 2")), 62.2, 1e-9);
  EXPECT_NEAR(horizontal_fov_deg(camera_product("DJI Zenmuse P1 35mm")), 54.3, 0.1);
}

TEST(CameraProducts, UnknownNamesAreHelped) {
  const auto error = [](const std::string& name) {
    return testing::error_of<UsageError>([&] { camera_product(name); });
  };
  EXPECT_THAT(error("Mavic 3"), HasSubstr("did you mean DJI Mavic 3, or DJI Mavic 3E"));
  EXPECT_THAT(error("DJI Mavik 3E"), HasSubstr("did you mean DJI Mavic 3E?"));
  EXPECT_THAT(error("box brownie"), HasSubstr("--camera-name list names all"));
  EXPECT_THAT(error("list"), HasSubstr("DJI Zenmuse P1 35mm; "));
}

TEST(CameraProducts, ANameExcludesFigures) {
  CameraOptions options;
  options.name = "M3E";
  options.hfov_deg = 70;
  EXPECT_THAT(testing::error_of<UsageError>([&] { make_camera(options); }),
              HasSubstr("--camera-name and --camera-hfov-deg exclude each other"));
  options.hfov_deg.reset();
  EXPECT_EQ(make_camera(options).width_px, 5280);
}

TEST(CameraProducts, ThePageNamesEach) {
  const std::string page = read_file(testing::source_folder() / "docs/methods/products.md");
  for (const CameraProduct& product : camera_products()) {
    EXPECT_THAT(page, HasSubstr("| " + std::string(product.name) + " |"));
    EXPECT_THAT(page, HasSubstr(std::string(product.source)));
  }
}

}  // namespace
}  // namespace pilotage
