#include <cmath>
#include <csignal>

#include "raster/raster_maker.h"
#include "testing/temporary_folder.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>
#include <sys/resource.h>

#include "pilotage/base/error.h"
#include "pilotage/base/output_file.h"
#include "pilotage/base/random.h"
#include "pilotage/raster/gdal_io.h"

namespace pilotage {
namespace {

using testing::TemporaryFolder;
using testing::utm33;

const GeoTransform kPlace = GeoTransform::north_up(500000, 5'000'000, 32);

std::vector<ScoreBand> two_bands(int width, int height) {
  Random random(seed_from_name("write_test"));
  cv::Mat entropy(height, width, CV_64F);
  cv::Mat variance(height, width, CV_64F);
  for (int i = 0; i < width * height; ++i) {
    entropy.at<double>(i / width, i % width) = std::exp(1) * (1 - 1e-6 * random.uniform());
    variance.at<double>(i / width, i % width) = i % 5 == 0 ? NAN : random.uniform(0, 100);
  }
  return {{"frieden_entropy", "", entropy}, {"gray_variance", "gray levels", variance}};
}

std::size_t files_in(const TemporaryFolder& folder) {
  std::size_t count = 0;
  for ([[maybe_unused]] const auto& entry : std::filesystem::directory_iterator(folder.path())) ++count;
  return count;
}

TEST(WriteScoreRaster, KeepsEveryBitAndSaysWhatItHolds) {
  const TemporaryFolder folder;
  const std::vector<ScoreBand> bands = two_bands(700, 600);
  write_score_raster(folder / "scores.tif", bands, utm33(), kPlace, false);
  EXPECT_EQ(files_in(folder), 1U);  // no side-car, no temporary

  testing::change_raster(folder / "scores.tif", [&](GDALDataset& dataset) {
    EXPECT_STREQ(dataset.GetMetadataItem("LAYOUT", "IMAGE_STRUCTURE"), "COG");
    ASSERT_EQ(dataset.GetRasterCount(), 2);
    for (int i = 0; i < 2; ++i) {
      GDALRasterBand& band = *dataset.GetRasterBand(i + 1);
      const ScoreBand& expected = bands[static_cast<std::size_t>(i)];
      EXPECT_EQ(band.GetRasterDataType(), GDT_Float64);
      EXPECT_EQ(band.GetDescription(), expected.name);
      EXPECT_EQ(band.GetUnitType(), expected.unit);
      EXPECT_TRUE(std::isnan(band.GetNoDataValue()));
      EXPECT_GE(band.GetOverviewCount(), 1);
      cv::Mat values(600, 700, CV_64F);
      ASSERT_EQ(band.RasterIO(GF_Read, 0, 0, 700, 600, values.data, 700, 600, GDT_Float64, 0, 0, nullptr), CE_None);
      double sum = 0;
      int count = 0;
      for (int row = 0; row < 600; ++row) {
        for (int col = 0; col < 700; ++col) {
          const double value = values.at<double>(row, col);
          const double truth = expected.values.at<double>(row, col);
          ASSERT_TRUE(value == truth || (std::isnan(value) && std::isnan(truth)));
          if (std::isnan(truth)) continue;
          sum += truth;
          ++count;
        }
      }
      // Statistics stand in the file: asking for them without permission to compute finds them.
      double low = 0;
      double high = 0;
      double mean = 0;
      double deviation = 0;
      ASSERT_EQ(band.GetStatistics(FALSE, FALSE, &low, &high, &mean, &deviation), CE_None);
      EXPECT_NEAR(mean, sum / count, 1e-9);
      EXPECT_GE(low, 0);
      EXPECT_LE(high, 100);
      EXPECT_GT(deviation, 0);
    }
    std::array<double, 6> numbers{};
    ASSERT_EQ(dataset.GetGeoTransform(numbers.data()), CE_None);
    EXPECT_EQ(numbers[0], 500000);
    EXPECT_EQ(numbers[5], -32);
    EXPECT_STREQ(dataset.GetSpatialRef()->GetAuthorityCode(nullptr), "32633");
  });
}

TEST(WriteScoreRaster, TheSameScoresGiveTheSameBytes) {
  const TemporaryFolder folder;
  write_score_raster(folder / "a.tif", two_bands(300, 200), utm33(), kPlace, false);
  write_score_raster(folder / "b.tif", two_bands(300, 200), utm33(), kPlace, false);
  EXPECT_EQ(read_file(folder / "a.tif"), read_file(folder / "b.tif"));
}

TEST(WriteScoreRaster, SmallAndEmptyRastersWork) {
  const TemporaryFolder folder;
  write_score_raster(folder / "one.tif", {{"a", "", cv::Mat(1, 1, CV_64F, cv::Scalar(3))}}, utm33(), kPlace, false);
  write_score_raster(folder / "nothing.tif", {{"a", "", cv::Mat(9, 9, CV_64F, cv::Scalar(NAN))}}, utm33(), kPlace,
                     false);
  EXPECT_EQ(open_gray((folder / "one.tif").string()).read({0, 0, 1, 1}).pixels.at<double>(0, 0), 3);
  EXPECT_EQ(cv::countNonZero(open_gray((folder / "nothing.tif").string()).read({0, 0, 9, 9}).valid), 0);
}

TEST(WriteScoreRaster, RefusesWhatIsNotRight) {
  const TemporaryFolder folder;
  const cv::Mat good(4, 5, CV_64F, cv::Scalar(1));
  EXPECT_THROW(write_score_raster(folder / "a.tif", {}, utm33(), kPlace, false), UsageError);
  EXPECT_THROW(write_score_raster(folder / "a.tif", {{"a", "", cv::Mat(4, 5, CV_32S)}}, utm33(), kPlace, false),
               UsageError);
  EXPECT_THROW(
      write_score_raster(folder / "a.tif", {{"a", "", good}, {"b", "", cv::Mat(5, 4, CV_64F)}}, utm33(), kPlace, false),
      UsageError);
  EXPECT_THROW(write_score_raster(folder / "none" / "a.tif", {{"a", "", good}}, utm33(), kPlace, false), DataError);
  EXPECT_EQ(files_in(folder), 0U);
  write_score_raster(folder / "a.tif", {{"a", "", good}}, utm33(), kPlace, false);
  EXPECT_THROW(write_score_raster(folder / "a.tif", {{"a", "", good}}, utm33(), kPlace, false), DataError);
  EXPECT_NO_THROW(write_score_raster(folder / "a.tif", {{"a", "", good}}, utm33(), kPlace, true));
}

/// No file may grow beyond `bytes` while it lives: what a full disk does to a writer.
class FileSizeLimit {
 public:
  explicit FileSizeLimit(rlim_t bytes) : handler_(std::signal(SIGXFSZ, SIG_IGN)) {
    getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit limit{bytes, before_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~FileSizeLimit() {
    setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, handler_);
  }
  FileSizeLimit(const FileSizeLimit&) = delete;
  FileSizeLimit& operator=(const FileSizeLimit&) = delete;

 private:
  rlimit before_{};
  void (*handler_)(int);
};

TEST(WriteScoreRaster, AFullDiskIsAnErrorAndLeavesNothing) {
  const TemporaryFolder folder;
  const std::vector<ScoreBand> bands = two_bands(700, 600);  // about 4 MB when complete
  for (const rlim_t bytes : {rlim_t{0}, rlim_t{1000}, rlim_t{100'000}, rlim_t{2'000'000}}) {
    const FileSizeLimit limit(bytes);
    EXPECT_THROW(write_score_raster(folder / "scores.tif", bands, utm33(), kPlace, false), DataError) << bytes;
    EXPECT_EQ(files_in(folder), 0U) << bytes;
  }
}

TEST(WriteClassRaster, HoldsColoursAndNames) {
  const TemporaryFolder folder;
  cv::Mat classes(200, 300, CV_8U, cv::Scalar(1));
  classes.row(0).setTo(2);
  classes.col(0).setTo(kNoClass);
  const std::vector<RasterClass> names{{"go", {0, 34, 78}}, {"marginal", {124, 123, 120}}, {"no-go", {253, 234, 69}}};
  write_class_raster(folder / "classes.tif", "verdict", classes, names, utm33(), kPlace, false);
  write_class_raster(folder / "again.tif", "verdict", classes, names, utm33(), kPlace, false);
  EXPECT_EQ(read_file(folder / "classes.tif"), read_file(folder / "again.tif"));
  EXPECT_EQ(files_in(folder), 2U);
  testing::change_raster(folder / "classes.tif", [&](GDALDataset& dataset) {
    GDALRasterBand& band = *dataset.GetRasterBand(1);
    EXPECT_STREQ(dataset.GetMetadataItem("LAYOUT", "IMAGE_STRUCTURE"), "COG");
    EXPECT_EQ(band.GetRasterDataType(), GDT_Byte);
    EXPECT_STREQ(band.GetDescription(), "verdict");
    EXPECT_EQ(band.GetNoDataValue(), 255);
    EXPECT_STREQ(band.GetMetadataItem("CLASS_2"), "no-go");
    ASSERT_NE(band.GetColorTable(), nullptr);
    EXPECT_EQ(band.GetColorTable()->GetColorEntry(2)->c1, 253);
    EXPECT_EQ(band.GetColorTable()->GetColorEntry(1)->c3, 120);
    std::uint8_t pixels[2] = {};
    ASSERT_EQ(band.RasterIO(GF_Read, 0, 5, 2, 1, pixels, 2, 1, GDT_Byte, 0, 0, nullptr), CE_None);
    EXPECT_EQ(pixels[0], 255);
    EXPECT_EQ(pixels[1], 1);
  });
}

TEST(WriteClassRaster, RefusesValuesThatAreNoClass) {
  const TemporaryFolder folder;
  const std::vector<RasterClass> names{{"go", {}}, {"no-go", {}}};
  EXPECT_THROW(
      write_class_raster(folder / "a.tif", "v", cv::Mat(3, 3, CV_8U, cv::Scalar(2)), names, utm33(), kPlace, false),
      UsageError);
  EXPECT_THROW(
      write_class_raster(folder / "a.tif", "v", cv::Mat(3, 3, CV_8U, cv::Scalar(0)), {}, utm33(), kPlace, false),
      UsageError);
  EXPECT_THROW(
      write_class_raster(folder / "a.tif", "v", cv::Mat(3, 3, CV_64F, cv::Scalar(0)), names, utm33(), kPlace, false),
      UsageError);
}

TEST(GdalConfig, TakesKeyAndValue) {
  set_gdal_config({"PILOTAGE_TEST_OPTION=a=b"});
  EXPECT_STREQ(CPLGetConfigOption("PILOTAGE_TEST_OPTION", ""), "a=b");
  EXPECT_THROW(set_gdal_config({"no value"}), UsageError);
  EXPECT_THROW(set_gdal_config({"=x"}), UsageError);
}

}  // namespace
}  // namespace pilotage
