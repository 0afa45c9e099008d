#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "raster/raster_maker.h"
#include "testing/cubic_convolution.h"
#include "testing/read_all.h"
#include "testing/temporary_folder.h"
#include <cpl_conv.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "pilotage/base/error.h"
#include "pilotage/base/parallel.h"
#include "pilotage/base/random.h"
#include "pilotage/raster/gdal_io.h"
#include "pilotage/raster/gray_stretch.h"

namespace pilotage {
namespace {

using testing::change_raster;
using ::testing::HasSubstr;
using testing::make_raster;
using testing::RasterSpec;
using testing::read_all;
using testing::TemporaryFolder;
using testing::utm33;

/// A ramp in the ground's own coordinates, so that its value at a place does not depend on the raster that holds it.
double ground_value(double x, double y) {
  return 100 + (x - 500000) * 0.8 + (y - 5'000'000) * 0.5;
}

RasterSpec ramp(double gsd, int width, int height, GDALDataType type) {
  RasterSpec spec;
  spec.width = width;
  spec.height = height;
  spec.type = type;
  spec.place = GeoTransform::north_up(500000, 5'000'000, gsd);
  spec.value = [place = spec.place](int, int col, int row) {
    const Eigen::Vector2d map = place.map_from_pixel({col + 0.5, row + 0.5});
    return ground_value(map.x(), map.y());
  };
  return spec;
}

TEST(GrayOnGrid, TheSameGridGivesTheSamePixels) {
  const TemporaryFolder folder;
  RasterSpec spec;
  spec.bands = 3;
  spec.creation_options = {"PHOTOMETRIC=RGB"};
  const std::string path = make_raster(folder / "a.tif", spec);
  const Raster own = read_all(open_gray(path));
  const GraySource source = open_gray_on_grid({path}, utm33(), spec.place, 60, 40);
  EXPECT_EQ(source.depth, CV_8U);
  const Raster grid = read_all(source);
  EXPECT_EQ(cv::norm(own.pixels, grid.pixels, cv::NORM_INF), 0);
  EXPECT_EQ(cv::countNonZero(grid.valid), 60 * 40);
  const Raster part = source.read({5, 6, 7, 8});
  EXPECT_EQ(part.map_from_pixel, spec.place.shifted(5, 6));
  EXPECT_EQ(cv::norm(part.pixels, own.pixels(cv::Rect(5, 6, 7, 8)), cv::NORM_INF), 0);
}

double keys_value(const cv::Mat& gray, double col, double row) {
  double sum = 0;
  for (int y = static_cast<int>(std::floor(row)) - 1; y < std::floor(row) + 3; ++y) {
    for (int x = static_cast<int>(std::floor(col)) - 1; x < std::floor(col) + 3; ++x) {
      sum += testing::keys_weight(row - y) * testing::keys_weight(col - x) * gray.at<std::uint8_t>(y, x);
    }
  }
  return std::clamp(sum, 0.0, 255.0);
}

/// Near the imagery's scale the kernel is four pixels wide, in every block; on coarser grids it is wider, as GDAL has
/// it.
TEST(GrayOnGrid, TheCubicKernelIsNotWidenedNearTheImagerysScale) {
  const TemporaryFolder folder;
  Random random(seed_from_name("keys"));
  cv::Mat gray(500, 900, CV_8U);
  for (int row = 0; row < gray.rows; ++row) {
    for (int col = 0; col < gray.cols; ++col) gray.at<std::uint8_t>(row, col) = random.below(256) & 255;
  }
  RasterSpec spec = ramp(0.5, gray.cols, gray.rows, GDT_Byte);
  spec.value = [&](int, int col, int row) { return gray.at<std::uint8_t>(row, col); };
  const std::string path = make_raster(folder / "noise.tif", spec);
  for (const double gsd_m : {0.45, 0.5, 0.53, 0.549, 0.6}) {
    const GeoTransform place = GeoTransform::north_up(500002.13, 4'999'998.4, gsd_m);
    const Raster raster = read_all(open_gray_on_grid({path}, utm33(), place, 700, 300));
    double largest = 0;
    for (int row = 0; row < raster.pixels.rows; ++row) {
      for (int col = 0; col < raster.pixels.cols; ++col) {
        const Eigen::Vector2d at = spec.place.pixel_from_map(place.map_from_pixel({col + 0.5, row + 0.5}));
        const double plain = keys_value(gray, at.x() - 0.5, at.y() - 0.5);
        largest = std::max(largest, std::abs(raster.pixels.at<std::uint8_t>(row, col) - plain));
      }
    }
    if (gsd_m < 0.55) {
      EXPECT_LT(largest, 0.51) << gsd_m;
    } else {
      EXPECT_GT(largest, 10) << gsd_m;
    }
  }
}

TEST(GrayOnGrid, PutsGroundWhereItBelongs) {
  const TemporaryFolder folder;
  // The same ramp, held by rasters in other CRSs, must come out at its place: web Mercator, degrees, a turned grid.
  const CrsTransform utm(utm33());
  struct Case {
    const char* name;
    const char* srs;
    GeoTransform place;
  };
  const CrsTransform web(Crs::from_user_input("EPSG:3857"));
  const auto corner = utm.geodetic_from_map({500000, 5'000'100});
  const Eigen::Vector2d web_corner = *web.map_from_geodetic(*corner);
  const double cos_lat = std::cos(corner->lat_deg * M_PI / 180);
  const std::vector<Case> cases{
      {"web.tif", "EPSG:3857", GeoTransform::north_up(web_corner.x(), web_corner.y(), 0.5 / cos_lat)},
      {"degrees.tif", "EPSG:4326", GeoTransform::north_up(corner->lon_deg, corner->lat_deg, 5e-6)},
      {"turned.tif", "EPSG:32633", {499950, 0.4, 0.3, 5'000'060, 0.3, -0.4}},
      {"feet.tif", "+proj=utm +zone=33 +datum=WGS84 +units=us-ft",
       GeoTransform::north_up(500000 * 3937 / 1200.0, 5'000'100.0 * 3937 / 1200, 2)}};
  for (const Case& c : cases) {
    RasterSpec spec;
    spec.width = spec.height = 300;
    spec.type = GDT_Float32;
    spec.srs = c.srs;
    spec.place = c.place;
    const CrsTransform own(Crs::from_user_input(c.srs));
    spec.value = [&](int, int col, int row) {
      const Eigen::Vector2d map = c.place.map_from_pixel({col + 0.5, row + 0.5});
      const Eigen::Vector2d ground = *utm.map_from_geodetic(*own.geodetic_from_map(map));
      return ground_value(ground.x(), ground.y());
    };
    const std::string path = make_raster(folder / c.name, spec);
    const GeoTransform grid = GeoTransform::north_up(500010, 5'000'070, 0.5);
    const Raster raster = read_all(open_gray_on_grid({path}, utm33(), grid, 60, 60));
    int compared = 0;
    for (int row = 0; row < 60; ++row) {
      for (int col = 0; col < 60; ++col) {
        if (raster.valid.at<std::uint8_t>(row, col) == 0) continue;
        const Eigen::Vector2d map = grid.map_from_pixel({col + 0.5, row + 0.5});
        // Half a pixel amiss would be 0.2 to 0.33.
        ASSERT_NEAR(raster.pixels.at<double>(row, col), ground_value(map.x(), map.y()), 0.05) << c.name;
        ++compared;
      }
    }
    EXPECT_EQ(compared, 3600) << c.name;
  }
}

TEST(GrayOnGrid, TheLaterRasterLiesOnTop) {
  const TemporaryFolder folder;
  RasterSpec spec;
  spec.value = [](int, int, int) { return 50; };
  const std::string below = make_raster(folder / "below.tif", spec);
  spec.place = spec.place.shifted(20, 0);
  spec.value = [](int, int col, int) { return col < 10 ? 0 : 200; };
  spec.finish = [](GDALDataset& dataset) { dataset.GetRasterBand(1)->SetNoDataValue(0); };
  const std::string above = make_raster(folder / "above.tif", spec);
  const GeoTransform grid = GeoTransform::north_up(500000, 5'000'000, 0.5);
  const auto at = [&](const Raster& raster, int col) {
    return raster.valid.at<std::uint8_t>(5, col) == 0 ? -1 : int{raster.pixels.at<std::uint8_t>(5, col)};
  };
  Raster raster = read_all(open_gray_on_grid({below, above}, utm33(), grid, 100, 40));
  EXPECT_EQ(at(raster, 19), 50);
  EXPECT_EQ(at(raster, 25), 50);  // no data of the upper one
  EXPECT_EQ(at(raster, 35), 200);
  EXPECT_EQ(at(raster, 75), 200);
  EXPECT_EQ(at(raster, 85), -1);
  raster = read_all(open_gray_on_grid({above, below}, utm33(), grid, 100, 40));
  EXPECT_EQ(at(raster, 35), 50);
  EXPECT_EQ(at(raster, 75), 200);
  // Resampled no-data stays out of its neighbours: no value between 0 and 200.
  raster = read_all(open_gray_on_grid({above}, utm33(), GeoTransform::north_up(500000.1, 5'000'000.1, 0.4), 120, 40));
  for (int col = 0; col < 120; ++col) EXPECT_TRUE(at(raster, col) == -1 || at(raster, col) == 200) << col;
}

TEST(GrayOnGrid, NanStaysOutOfItsNeighbours) {
  const TemporaryFolder folder;
  RasterSpec spec = ramp(0.5, 60, 40, GDT_Float32);
  const auto value = spec.value;
  spec.value = [value](int band, int col, int row) { return col == 20 && row == 20 ? NAN : value(band, col, row); };
  const std::string path = make_raster(folder / "a.tif", spec);
  const Raster raster =
      read_all(open_gray_on_grid({path}, utm33(), GeoTransform::north_up(500000.2, 5'000'000 - 0.2, 0.5), 50, 30));
  EXPECT_EQ(cv::countNonZero(raster.valid), 50 * 30 - 1);
}

TEST(GrayOnGrid, DepthsMixToDouble) {
  const TemporaryFolder folder;
  RasterSpec spec;
  const std::string bytes = make_raster(folder / "8.tif", spec);
  spec.type = GDT_UInt16;
  const std::string words = make_raster(folder / "16.tif", spec);
  const auto depth_of = [&](const std::vector<std::string>& paths) {
    const GraySource source = open_gray_on_grid(paths, utm33(), spec.place, 60, 40);
    EXPECT_EQ(read_all(source).pixels.type(), source.depth);
    return source.depth;
  };
  EXPECT_EQ(depth_of({bytes, bytes}), CV_8U);
  EXPECT_EQ(depth_of({words, words}), CV_16U);
  EXPECT_EQ(depth_of({bytes, words}), CV_64F);
  EXPECT_EQ(depth_of({words, bytes, bytes}), CV_64F);
}

// An overview's mask that ends elsewhere, as GDAL's COG driver makes it with a cubic kernel, does not decide.
TEST(GrayOnGrid, TheMaskAtFullResolutionDecidesWhatIsValid) {
  const TemporaryFolder folder;
  const CPLConfigOptionSetter internal("GDAL_TIFF_INTERNAL_MASK", "YES", false);
  RasterSpec spec;
  spec.width = spec.height = 128;
  spec.place = GeoTransform::north_up(500000, 5'000'000, 0.5);
  spec.value = [](int, int col, int row) { return col >= 33 && col < 71 ? 0 : 100 + (col * 3 + row * 7) % 50; };
  spec.finish = [](GDALDataset& dataset) {
    ASSERT_EQ(dataset.CreateMaskBand(GMF_PER_DATASET), CE_None);
    std::vector<std::uint8_t> mask(128 * 128);
    for (std::size_t i = 0; i < mask.size(); ++i) mask[i] = i % 128 >= 33 && i % 128 < 71 ? 0 : 255;
    ASSERT_EQ(dataset.GetRasterBand(1)->GetMaskBand()->RasterIO(GF_Write, 0, 0, 128, 128, mask.data(), 128, 128,
                                                                GDT_Byte, 0, 0, nullptr),
              CE_None);
  };
  const std::string plain = make_raster(folder / "plain.tif", spec);
  const std::string with_overviews = make_raster(folder / "overviews.tif", spec);
  testing::change_raster(with_overviews, [](GDALDataset& dataset) {
    const int factors[] = {2, 4};
    ASSERT_EQ(dataset.BuildOverviews("CUBIC", 2, factors, 0, nullptr, nullptr, nullptr), CE_None);
    // Its mask is too small by a pixel to either side.
    GDALRasterBand* mask = dataset.GetRasterBand(1)->GetOverview(0)->GetMaskBand();
    std::vector<std::uint8_t> shrunk(64 * 64);
    for (std::size_t i = 0; i < shrunk.size(); ++i) shrunk[i] = i % 64 >= 18 && i % 64 < 34 ? 0 : 255;
    ASSERT_EQ(mask->RasterIO(GF_Write, 0, 0, 64, 64, shrunk.data(), 64, 64, GDT_Byte, 0, 0, nullptr), CE_None);
  });
  const GeoTransform grid = GeoTransform::north_up(500000, 5'000'000, 1);
  const auto valid_of = [&](const std::string& file) {
    return open_gray_on_grid({file}, testing::utm33(), grid, 64, 64).read({0, 0, 64, 64}).valid;
  };
  const cv::Mat expected = valid_of(plain);
  EXPECT_EQ(cv::norm(valid_of(with_overviews), expected, cv::NORM_INF), 0);
  EXPECT_EQ(cv::countNonZero(expected.row(10)), 64 - 18) << "17 to 34 lie whole in the mask";
}

TEST(GrayOnGrid, UsesOverviews) {
  const TemporaryFolder folder;
  RasterSpec spec;
  spec.width = spec.height = 512;
  spec.value = [](int, int, int) { return 100; };
  const std::string path = make_raster(folder / "a.tif", spec);
  change_raster(path, [](GDALDataset& dataset) {
    int levels[] = {2, 4};
    ASSERT_EQ(dataset.BuildOverviews("AVERAGE", 2, levels, 0, nullptr, nullptr, nullptr), CE_None);
    // Values that only a reader of the overview can see.
    dataset.GetRasterBand(1)->GetOverview(0)->Fill(22);
    dataset.GetRasterBand(1)->GetOverview(1)->Fill(44);
  });
  EXPECT_EQ(inspect_imagery(path).overviews, 2);
  const auto value_at_gsd = [&](double gsd) {
    const GeoTransform grid = GeoTransform::north_up(500000, 5'000'000, gsd);
    return int{read_all(open_gray_on_grid({path}, utm33(), grid, 50, 50)).pixels.at<std::uint8_t>(10, 10)};
  };
  EXPECT_EQ(value_at_gsd(0.5), 100);
  EXPECT_EQ(value_at_gsd(0.9), 100);
  EXPECT_EQ(value_at_gsd(1.0), 22);
  EXPECT_EQ(value_at_gsd(1.9), 22);
  EXPECT_EQ(value_at_gsd(2.0), 44);
  EXPECT_EQ(value_at_gsd(5.0), 44);
}

TEST(GrayOnGrid, ACoarseGridAveragesWhatItCovers) {
  const TemporaryFolder folder;
  RasterSpec spec;
  spec.width = spec.height = 64;
  Random random(seed_from_name("GrayOnGrid.ACoarseGridAveragesWhatItCovers"));
  cv::Mat truth(64, 64, CV_64F);
  for (int i = 0; i < 64 * 64; ++i) truth.at<double>(i / 64, i % 64) = random.uniform(0, 100);
  spec.type = GDT_Float64;
  spec.value = [&](int, int col, int row) { return truth.at<double>(row, col); };
  const std::string path = make_raster(folder / "a.tif", spec);
  const Raster raster =
      read_all(open_gray_on_grid({path}, utm33(), GeoTransform::north_up(500000, 5'000'000, 2), 16, 16));
  for (int row = 0; row < 16; ++row) {
    for (int col = 0; col < 16; ++col) {
      ASSERT_NEAR(raster.pixels.at<double>(row, col), cv::mean(truth(cv::Rect(col * 4, row * 4, 4, 4)))[0], 1e-9);
    }
  }
}

TEST(GrayOnGrid, WindowsAndThreadsDoNotChangeValues) {
  const TemporaryFolder folder;
  RasterSpec spec;
  spec.width = 700;
  spec.height = 500;
  spec.bands = 3;
  spec.srs = "EPSG:4326";
  spec.place = GeoTransform::north_up(15, 45.2, 5e-6);
  Random noise(3);
  std::vector<double> values(static_cast<std::size_t>(spec.width) * 500 * 3);
  for (double& value : values) value = static_cast<double>(noise.below(256));
  spec.value = [&](int band, int col, int row) {
    return values[static_cast<std::size_t>((band * 500 + row) * 700 + col)];
  };
  const std::string path = make_raster(folder / "a.tif", spec);
  const Bounds bounds = imagery_bounds(inspect_imagery(path), utm33());
  const GeoTransform place = GeoTransform::north_up(bounds.min_x_m - 20, bounds.max_y_m + 10, 0.43);
  const auto open = [&] { return open_gray_on_grid({path}, utm33(), place, 800, 700); };
  const Raster whole = read_all(open());
  EXPECT_GT(valid_fraction(whole.valid), 0.5);
  EXPECT_LT(valid_fraction(whole.valid), 0.99);
  for (const int threads : {1, 2, 5}) {
    const GraySource source = open();
    std::vector<double> differences(120, -1);
    parallel_for(differences.size(), threads, [&](std::size_t index, int) {
      Random random(derive_seed(5, index));
      const int col = static_cast<int>(random.below(700));
      const int row = static_cast<int>(random.below(600));
      const int side = 1 + static_cast<int>(random.below(100));
      const cv::Rect rect(col, row, side, side);
      const Raster part = source.read({col, row, side, side});
      differences[index] = cv::norm(part.valid, whole.valid(rect), cv::NORM_INF);
      cv::Mat a = part.pixels.clone();
      cv::Mat b = whole.pixels(rect).clone();
      a.setTo(0, part.valid == 0);
      b.setTo(0, part.valid == 0);
      differences[index] += cv::norm(a, b, cv::NORM_INF);
    });
    EXPECT_EQ(differences, std::vector<double>(120, 0)) << threads;
  }
}

TEST(GrayOnGrid, CrossesTheAntimeridian) {
  const TemporaryFolder folder;
  const Crs fiji = Crs::from_user_input("+proj=tmerc +lon_0=180 +lat_0=-17 +datum=WGS84");
  RasterSpec spec;
  spec.srs = "EPSG:4326";
  spec.width = 100;
  spec.height = 60;
  spec.value = [](int, int col, int) { return col < 50 ? 60 : 180; };
  spec.place = GeoTransform::north_up(179.9995, -16.9997, 1e-5);  // up to 180.0005°
  const std::string across = make_raster(folder / "across.tif", spec);
  const GeoTransform grid = GeoTransform::north_up(-40, 20, 1);
  const Raster raster = read_all(open_gray_on_grid({across}, fiji, grid, 80, 40));
  EXPECT_EQ(cv::countNonZero(raster.valid), 80 * 40);
  EXPECT_EQ(raster.pixels.at<std::uint8_t>(20, 10), 60);
  EXPECT_EQ(raster.pixels.at<std::uint8_t>(20, 70), 180);
}

TEST(GrayOnGrid, ReadsColoursForPeople) {
  const TemporaryFolder folder;
  RasterSpec spec;
  spec.bands = 3;
  spec.creation_options = {"PHOTOMETRIC=RGB"};
  spec.value = [](int band, int, int) { return 10 + 100 * band; };
  Raster raster = read_rgb8_on_grid({make_raster(folder / "rgb.tif", spec)}, utm33(), spec.place, 70, 40);
  EXPECT_EQ(raster.pixels.type(), CV_8UC3);
  EXPECT_EQ(raster.pixels.at<cv::Vec3b>(3, 3), cv::Vec3b(10, 110, 210));
  EXPECT_EQ(cv::countNonZero(raster.valid), 60 * 40);

  for (const GDALDataType type : {GDT_UInt16, GDT_Float32}) {  // 2026-11: one band of doubles was refused
    spec = {};
    spec.type = type;
    spec.value = [](int, int col, int) { return 1000 + col; };
    raster = read_rgb8_on_grid({make_raster(folder / "deep.tif", spec)}, utm33(), spec.place, 60, 40);
    EXPECT_EQ(raster.pixels.at<cv::Vec3b>(3, 0), cv::Vec3b(0, 0, 0));
    EXPECT_EQ(raster.pixels.at<cv::Vec3b>(3, 59), cv::Vec3b(255, 255, 255));
    EXPECT_NEAR(raster.pixels.at<cv::Vec3b>(3, 30)[0], 128, 5);
  }
}

TEST(GrayOnGrid, ReadsTheMaskAlone) {
  const TemporaryFolder folder;
  RasterSpec spec;
  spec.width = spec.height = 200;
  spec.value = [](int, int col, int) { return col < 50 ? 0 : 9; };
  spec.finish = [](GDALDataset& dataset) { dataset.GetRasterBand(1)->SetNoDataValue(0); };
  const std::string path = make_raster(folder / "a.tif", spec);
  const Raster raster =
      read_all(open_valid_on_grid({path}, utm33(), GeoTransform::north_up(500000, 5'000'000, 5), 20, 20));
  EXPECT_EQ(raster.valid.type(), CV_8U);
  EXPECT_EQ(cv::norm(raster.pixels, raster.valid, cv::NORM_INF), 0);
  EXPECT_NEAR(valid_fraction(raster.valid), 0.75, 0.051);
}

/// The mask of the grays, pixel for pixel, whatever kernel, grid and depth: 30 % of the pixels, drawn at random, are
/// no data, and overviews have closed those holes.
TEST(GrayOnGrid, TheMaskAloneIsThatOfTheGrays) {
  const TemporaryFolder folder;
  for (const GDALDataType type : {GDT_Byte, GDT_UInt16, GDT_Float32}) {
    RasterSpec spec;
    spec.width = spec.height = 256;
    spec.type = type;
    Random random(seed_from_name("holes"));
    std::vector<double> values(256 * 256);
    for (double& value : values) value = random.uniform() < 0.3 ? 0 : 1.0 + static_cast<double>(random.below(200));
    if (type == GDT_Float32) values[256 * 128 + 128] = std::numeric_limits<double>::infinity();
    spec.value = [&](int, int col, int row) { return values[static_cast<std::size_t>(row * 256 + col)]; };
    spec.finish = [](GDALDataset& dataset) {
      dataset.GetRasterBand(1)->SetNoDataValue(0);
      const std::array<int, 2> factors{2, 4};
      ASSERT_EQ(dataset.BuildOverviews("AVERAGE", 2, factors.data(), 0, nullptr, nullptr, nullptr), CE_None);
    };
    const std::string path = make_raster(folder / "holes.tif", spec);
    for (const Resampling kernel :
         {Resampling::kAuto, Resampling::kNearest, Resampling::kBilinear, Resampling::kCubic, Resampling::kAverage}) {
      ImageryOptions options;
      options.resampling = kernel;
      for (const double gsd_m : {0.5, 0.73, 1.0, 1.7}) {
        const GeoTransform place = GeoTransform::north_up(500'003.1, 5'000'000 - 2.3, gsd_m);
        const int size = static_cast<int>(110 / gsd_m);
        const cv::Mat expected = read_all(open_gray_on_grid({path}, utm33(), place, size, size, options)).valid;
        const cv::Mat mask = read_all(open_valid_on_grid({path}, utm33(), place, size, size, options)).valid;
        EXPECT_EQ(cv::norm(expected, mask, cv::NORM_INF), 0)
            << GDALGetDataTypeName(type) << ", kernel " << static_cast<int>(kernel) << ", " << gsd_m << " m";
        if (kernel == Resampling::kAuto && gsd_m < 0.75 && type != GDT_Float32) {
          EXPECT_NEAR(valid_fraction(mask), 0.7, 0.01) << gsd_m;
        }
      }
    }
  }
}

TEST(GrayOnGrid, OutsideTheImageryIsNoGround) {
  const TemporaryFolder folder;
  const std::string path = make_raster(folder / "a.tif", {});
  const Raster raster =
      read_all(open_gray_on_grid({path}, utm33(), GeoTransform::north_up(700000, 5'000'000, 0.5), 40, 30));
  EXPECT_EQ(cv::countNonZero(raster.valid), 0);
}

TEST(GrayOnGrid, BadGridsAreRefused) {
  const TemporaryFolder folder;
  const std::string path = make_raster(folder / "a.tif", {});
  const GeoTransform good = GeoTransform::north_up(500000, 5'000'000, 0.5);
  EXPECT_THROW(open_gray_on_grid({}, utm33(), good, 10, 10), UsageError);
  EXPECT_THROW(open_gray_on_grid({path}, utm33(), good, 0, 10), UsageError);
  EXPECT_THROW(open_gray_on_grid({path}, utm33(), good, 10, std::int64_t{1} << 40), UsageError);
  EXPECT_THROW(open_gray_on_grid({path}, utm33(), {500000, 0.5, 0.1, 5e6, 0.1, -0.5}, 10, 10), UsageError);
  EXPECT_THROW(open_gray_on_grid({path}, utm33(), {500000, 0.5, 0, 5e6, 0, 0.5}, 10, 10), UsageError);
  EXPECT_THROW(open_gray_on_grid({path}, utm33(), GeoTransform::north_up(NAN, 5e6, 0.5), 10, 10), UsageError);
  EXPECT_THROW(open_gray_on_grid({path}, Crs(), good, 10, 10), UsageError);
  EXPECT_THROW(open_gray_on_grid({path, "missing.tif"}, utm33(), good, 10, 10), DataError);
}

}  // namespace
}  // namespace pilotage
