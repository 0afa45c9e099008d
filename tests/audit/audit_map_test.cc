#include "pilotage/audit/audit_map.h"

#include <cmath>

#include "raster/raster_maker.h"
#include "registration/two_dates.h"
#include "testing/error_of.h"
#include "testing/temporary_folder.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pilotage/audit/shift_picture.h"
#include "pilotage/base/error.h"
#include "pilotage/raster/map_sigma.h"

namespace pilotage {
namespace {

using testing::change_raster;
using testing::error_of;
using ::testing::HasSubstr;
using testing::make_raster;
using testing::make_two_dates;
using ::testing::Not;
using testing::random_texture;
using testing::RasterSpec;
using testing::TemporaryFolder;
using testing::TrueField;

constexpr int kMapSide_px = 400;

std::string write_gray(const std::filesystem::path& path, const cv::Mat& gray) {
  RasterSpec spec;
  spec.width = gray.cols;
  spec.height = gray.rows;
  spec.place = GeoTransform::north_up(500'000, 5'000'000, 1);
  spec.value = [&](int, int col, int row) { return gray.at<std::uint8_t>(row, col); };
  return make_raster(path, spec);
}

/// The other map shows the ground at p + field(p).
struct TwoMaps {
  explicit TwoMaps(const TrueField& field) {
    const auto dates = make_two_dates(kMapSide_px, field, "audit");
    map = write_gray(folder / "map.tif", dates.reference.pixels);
    other = write_gray(folder / "other.tif", dates.second.pixels);
  }
  MapAudit audit(AuditOptions options = {}, int threads = 0) const {
    options.registration.search_radius_m = 12;
    return audit_map(map, {other}, options, threads);
  }

  TemporaryFolder folder;
  std::string map;
  std::string other;
};

Eigen::Vector2d shifted(const Eigen::Vector2d& /*point_m*/) {
  return {4, -3};
}

TEST(AuditMap, FindsHowFarTheMapIsOffAndWhichWay) {
  const TwoMaps maps(shifted);
  const MapAudit audit = maps.audit();
  EXPECT_EQ(audit.verdict, AuditVerdict::kBeyond);
  EXPECT_NEAR(audit.median_shift_en_m.x(), -4, 0.1);
  EXPECT_NEAR(audit.median_shift_en_m.y(), 3, 0.1);
  EXPECT_NEAR(audit.shift_m.median, 5, 0.1);
  EXPECT_LT(audit.about_median_m.quantile_95, 0.3);
  EXPECT_GT(audit.compared, 0.8);
  EXPECT_NEAR(audit.common_m2, kMapSide_px * kMapSide_px, 0.02 * kMapSide_px * kMapSide_px);
  EXPECT_TRUE(std::isnan(audit.map_sigma_m));
  AuditOptions wider;
  wider.max_shift_m = 6;
  EXPECT_EQ(maps.audit(wider).verdict, AuditVerdict::kWithin);
}

TEST(AuditMap, ABentMapIsJudgedByItsWorstPart) {
  // In the middle both agree; to the east the map is off by up to 8 m.
  const TwoMaps maps([](const Eigen::Vector2d& p) {
    const double u = (p.x() - 1000) / kMapSide_px;
    return Eigen::Vector2d(8 * u * u, 0);
  });
  const MapAudit audit = maps.audit();
  EXPECT_EQ(audit.verdict, AuditVerdict::kBeyond);
  EXPECT_LT(audit.shift_m.median, 3);
  EXPECT_GT(audit.shift_m.quantile_95, 6);
  EXPECT_GT(audit.about_median_m.quantile_95, 4);
}

/// A part of a mosaic that is off by itself, by more than the field bends.
TEST(AuditMap, APartThatIsOffByItselfIsNotTakenForItsNeighbours) {
  const TwoMaps maps([](const Eigen::Vector2d& p) {
    const bool inside = std::abs(p.x() - 1200) < 100 && std::abs(p.y() - 4800) < 100;
    return Eigen::Vector2d(inside ? 10 : 0, 0);
  });
  const MapAudit audit = maps.audit();
  EXPECT_LT(audit.compared, 0.92);  // a quarter of the map is off, and its edge is compared with what lies around it
  AuditOptions strict;
  strict.min_compared = 0.95;
  EXPECT_EQ(maps.audit(strict).verdict, AuditVerdict::kNotKnown);
}

TEST(AuditMap, OtherGroundIsNoVerdict) {
  const TwoMaps maps(shifted);
  write_gray(maps.folder / "other.tif", random_texture(kMapSide_px, "elsewhere"));
  const MapAudit audit = maps.audit();
  EXPECT_EQ(audit.verdict, AuditVerdict::kNotKnown);
  EXPECT_LT(audit.compared, 0.3);
  EXPECT_THAT(shift_picture_svg(audit, maps.map, {}), Not(HasSubstr("<line class=\"beyond\"")));
}

TEST(AuditMap, TooLittleCommonGroundIsNoVerdict) {
  const TwoMaps maps(shifted);
  change_raster(maps.other, [](GDALDataset& dataset) {
    double place[] = {500'000 + kMapSide_px - 30, 1, 0, 5'000'000, 0, -1};
    dataset.SetGeoTransform(place);
  });
  const MapAudit audit = maps.audit();
  EXPECT_EQ(audit.verdict, AuditVerdict::kNotKnown);
  EXPECT_EQ(audit.compared_m2, 0);
  EXPECT_NEAR(audit.common_m2, 30 * kMapSide_px, 0.1 * 30 * kMapSide_px);
}

TEST(AuditMap, MapsWithoutCommonGroundAreRefused) {
  const TwoMaps maps(shifted);
  change_raster(maps.other, [](GDALDataset& dataset) {
    double place[] = {600'000, 1, 0, 5'000'000, 0, -1};
    dataset.SetGeoTransform(place);
  });
  EXPECT_THAT(error_of<DataError>([&] { maps.audit(); }), HasSubstr("other.tif: shows no ground that "));
}

TEST(AuditMap, TellsWhatTheMapSaysOfItself) {
  const TwoMaps maps(shifted);
  change_raster(maps.map, [](GDALDataset& dataset) { dataset.SetMetadataItem(kMapSigmaTag, "map.map_sigma.tif"); });
  EXPECT_THAT(maps.audit().warnings, ::testing::Contains(HasSubstr("map.map_sigma.tif, which does not exist")));
  RasterSpec spec;
  spec.width = spec.height = kMapSide_px / 16;
  spec.type = GDT_Float32;
  spec.place = GeoTransform::north_up(500'000, 5'000'000, 16);
  spec.value = [](int, int, int) { return 2.5; };
  make_raster(maps.folder / "map.map_sigma.tif", spec);
  EXPECT_NEAR(maps.audit().map_sigma_m, 2.5, 1e-6);
}

TEST(AuditMap, ThePictureShowsWhatIsBeyond) {
  const TwoMaps maps(shifted);
  AuditOptions options;
  const MapAudit audit = maps.audit(options);
  const std::string beyond = shift_picture_svg(audit, maps.map, options);
  EXPECT_THAT(beyond, HasSubstr("<line class=\"beyond\""));
  EXPECT_THAT(beyond, Not(HasSubstr("<line class=\"within\"")));
  EXPECT_THAT(beyond, HasSubstr("arrows are drawn 2 times as long"));
  EXPECT_THAT(beyond, HasSubstr("Orange: beyond 3 m."));
  options.max_shift_m = 6;
  EXPECT_THAT(shift_picture_svg(audit, maps.map, options), HasSubstr("<line class=\"within\""));
}

TEST(AuditMap, TheSameForAnyNumberOfThreads) {
  const TwoMaps maps(shifted);
  const MapAudit one = maps.audit({}, 1);
  const MapAudit three = maps.audit({}, 3);
  EXPECT_EQ(shift_picture_svg(one, maps.map, {}), shift_picture_svg(three, maps.map, {}));
  EXPECT_EQ(one.shift_m.median, three.shift_m.median);
}

}  // namespace
}  // namespace pilotage
