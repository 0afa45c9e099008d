#include <cmath>
#include <vector>

#include "raster/raster_maker.h"
#include "testing/error_of.h"
#include "testing/temporary_folder.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pilotage/base/error.h"
#include "pilotage/raster/gdal_gray.h"
#include "pilotage/raster/gdal_imagery.h"

// A raster that only ground control points place was refused unless they were an affine transform; it is warped now,
// and says by how much its points miss their places.

namespace pilotage {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using testing::make_raster;
using testing::RasterSpec;
using testing::TemporaryFolder;

/// Where a pixel of the bent picture lies: a curve of a few pixels over its width.
Eigen::Vector2d bent_place(double col, double row) {
  return {500000 + 0.5 * col + 2e-5 * col * row, 5e6 - 0.5 * row + 3e-5 * col * col};
}

/// A grid of points over a picture of 400 x 300 px; `error_m(i)` moves the i-th to the east.
std::string make_bent(
    const std::filesystem::path& path, int columns, int rows,
    const std::function<double(int)>& error_m = [](int) { return 0.0; }) {
  RasterSpec spec;
  spec.width = 400;
  spec.height = 300;
  spec.georeferenced = false;
  spec.srs = "";
  spec.value = [](int, int col, int row) { return (col / 20 + row / 20) % 2 == 0 ? 60 : 180; };
  spec.finish = [=](GDALDataset& dataset) {
    std::vector<GDAL_GCP> points(static_cast<std::size_t>(columns * rows));
    GDALInitGCPs(columns * rows, points.data());
    for (int i = 0; i < columns * rows; ++i) {
      GDAL_GCP& point = points[static_cast<std::size_t>(i)];
      point.dfGCPPixel = 400.0 * (i % columns) / (columns - 1);
      point.dfGCPLine = rows > 1 ? 300.0 * (i / columns) / (rows - 1) : 0;
      const Eigen::Vector2d place = bent_place(point.dfGCPPixel, point.dfGCPLine);
      point.dfGCPX = place.x() + error_m(i);
      point.dfGCPY = place.y();
    }
    OGRSpatialReference reference;
    reference.importFromEPSG(32633);
    dataset.SetGCPs(columns * rows, points.data(), &reference);
    GDALDeinitGCPs(columns * rows, points.data());
  };
  return make_raster(path, spec);
}

std::string control_points_error(const std::string& dataset) {
  return testing::error_of<DataError>([&] { inspect_imagery(dataset); });
}

TEST(ControlPoints, WarpARasterToWhereTheySay) {
  const TemporaryFolder folder;
  const std::string bent = make_bent(folder / "bent.tif", 4, 3);
  const ImageryInfo info = inspect_imagery(bent);
  ASSERT_TRUE(info.control_points.has_value());
  EXPECT_EQ(info.control_points->points, 12);
  EXPECT_EQ(info.control_points->order, 2);
  EXPECT_NEAR(info.control_points->rms_m, 0, 1e-3);
  EXPECT_EQ(info.crs.authority(), "EPSG:32633");
  EXPECT_EQ(info.mask, MaskKind::kAlpha);
  EXPECT_THAT(info.warnings, Contains(HasSubstr("12 ground control points, by a polynomial of order 2")));

  // The squares of the picture stand where the points' own curve puts them.
  const GraySource source = open_gray(bent);
  const Raster raster = source.read({0, 0, static_cast<int>(source.width_px), static_cast<int>(source.height_px)});
  int looked_at = 0;
  for (int row = 10; row < 300; row += 20) {
    for (int col = 10; col < 400; col += 20) {
      const Eigen::Vector2d pixel = info.map_from_pixel.pixel_from_map(bent_place(col, row));
      const cv::Point at(static_cast<int>(std::floor(pixel.x())), static_cast<int>(std::floor(pixel.y())));
      ASSERT_NE(raster.valid.at<std::uint8_t>(at), 0) << col << ", " << row;
      EXPECT_NEAR(raster.pixels.at<std::uint8_t>(at), (col / 20 + row / 20) % 2 == 0 ? 60 : 180, 3)
          << col << ", " << row;
      ++looked_at;
    }
  }
  EXPECT_EQ(looked_at, 20 * 15);
}

// The residual is of points that the fit has not seen: with the fit's own points it would shrink with their number.
TEST(ControlPoints, TheResidualIsOfPointsLeftOut) {
  const TemporaryFolder folder;
  const auto noise = [](int i) { return i % 2 == 0 ? 0.4 : -0.4; };
  const ImageryInfo info = inspect_imagery(make_bent(folder / "noisy.tif", 6, 5, noise));
  ASSERT_TRUE(info.control_points.has_value());
  EXPECT_GT(info.control_points->rms_m, 0.4);
  EXPECT_LT(info.control_points->rms_m, 0.8);
  EXPECT_GE(info.control_points->largest_m, info.control_points->rms_m);
}

TEST(ControlPoints, RefusesTooFewPointsAndPointsThatMissTheirPlaces) {
  const TemporaryFolder folder;
  EXPECT_THAT(control_points_error(make_bent(folder / "line.tif", 6, 1)), HasSubstr("they lie in a line"));
  const auto blunder = [](int i) { return i == 5 ? 80.0 : 0.0; };
  EXPECT_THAT(control_points_error(make_bent(folder / "blunder.tif", 4, 3, blunder)),
              HasSubstr("12 ground control points; left out of the fit, they miss their places by"));
}

}  // namespace
}  // namespace pilotage
