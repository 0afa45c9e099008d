#include "pilotage/fetch/fetch_imagery.h"

#include <array>
#include <cmath>
#include <memory>
#include <numbers>

#include "raster/raster_maker.h"
#include "testing/error_of.h"
#include "testing/temporary_folder.h"
#include <gdal_priv.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "pilotage/base/error.h"
#include "pilotage/base/file_digest.h"
#include "pilotage/base/output_file.h"
#include "pilotage/raster/gdal_io.h"
#include "pilotage/raster/gdal_part.h"

namespace pilotage {
namespace {

namespace fs = std::filesystem;
using testing::error_of;
using ::testing::HasSubstr;
using testing::RasterSpec;
using FetchedJson = nlohmann::ordered_json;

/// A catalogue of two items over the same ground, 1,200 × 900 px of half a metre.
class FetchImagery : public ::testing::Test {
 protected:
  FetchImagery() : out_(folder_ / "out") {
    RasterSpec spec;
    spec.width = 1200;
    spec.height = 900;
    spec.bands = 3;
    spec.value = [](int band, int col, int row) { return (band * 50 + col * 3 + row * 7) % 251; };
    spec.finish = [](GDALDataset& dataset) { dataset.SetMetadataItem("TIFFTAG_SOFTWARE", "a camera"); };
    testing::make_raster(folder_ / "a.tif", spec);
    spec.value = [](int, int col, int) { return 100 + col % 100; };
    testing::make_raster(folder_ / "b.tif", spec);
    const CrsTransform transform(Crs::from_user_input(spec.srs));
    const auto corner = [&](double col, double row) {
      return transform.geodetic_from_map(spec.place.map_from_pixel(Eigen::Vector2d(col, row))).value();
    };
    bbox_ = {corner(0, 900).lon_deg, corner(0, 900).lat_deg, corner(1200, 0).lon_deg, corner(1200, 0).lat_deg};
    options_.bounds_deg = {corner(300, 500).lon_deg, corner(300, 500).lat_deg, corner(700, 200).lon_deg,
                           corner(700, 200).lat_deg};
    write_collection("2023-06-14T10:30:00Z");
  }

  void write_collection(const std::string& of_a) const {
    FetchedJson items = FetchedJson::array();
    for (const auto& [id, date] : {std::pair<std::string, std::string>{"a", of_a}, {"b", "2021-01-02T00:00:00Z"}}) {
      items.push_back({{"type", "Feature"},
                       {"id", id},
                       {"bbox", bbox_},
                       {"properties", {{"datetime", date}, {"license", "CC-BY-4.0"}, {"attribution", "© City"}}},
                       {"assets", {{"visual", {{"href", id + ".tif"}, {"type", "image/tiff"}}}}}});
    }
    write_file(folder_ / "items.json", FetchedJson{{"type", "FeatureCollection"}, {"features", items}}.dump(), true);
  }
  FetchResult fetch(bool overwrite = false, const Progress& progress = {}) const {
    return fetch_imagery({(folder_ / "items.json").string()}, options_, out_, overwrite, progress);
  }

  testing::TemporaryFolder folder_;
  fs::path out_;
  std::vector<double> bbox_;
  FetchOptions options_;
};

std::unique_ptr<GDALDataset> open(const fs::path& path) {
  GDALAllRegister();
  return std::unique_ptr<GDALDataset>(GDALDataset::Open(path.c_str(), GDAL_OF_READONLY | GDAL_OF_RASTER));
}

int pixel(GDALDataset& dataset, int band, std::int64_t col, std::int64_t row) {
  std::uint8_t value = 0;
  EXPECT_EQ(dataset.GetRasterBand(band)->RasterIO(GF_Read, static_cast<int>(col), static_cast<int>(row), 1, 1, &value,
                                                  1, 1, GDT_Byte, 0, 0),
            CE_None);
  return value;
}

TEST_F(FetchImagery, CopiesThePartPixelForPixelWithDateAndLicence) {
  const FetchResult result = fetch();
  ASSERT_EQ(result.files.size(), 2u);
  EXPECT_EQ(result.files[0].name, "2021-01-02_b.tif") << "by date, so that later ones lie on top";
  EXPECT_EQ(result.files[1].name, "2023-06-14T1030_a.tif");
  const FetchedFile& file = result.files[1];
  EXPECT_NEAR(static_cast<double>(file.window.col), 300 - 16, 3);
  EXPECT_NEAR(static_cast<double>(file.window.row), 200 - 16, 3);
  EXPECT_NEAR(file.window.width, 400 + 32, 6);
  EXPECT_NEAR(file.window.height, 300 + 32, 6);
  const auto whole = open(folder_ / "a.tif");
  const auto part = open(out_ / file.name);
  ASSERT_NE(part, nullptr);
  EXPECT_EQ(part->GetRasterXSize(), file.window.width);
  for (int band = 1; band <= 3; ++band) {
    for (const auto& [col, row] : {std::pair{0, 0}, std::pair{200, 150}, std::pair{431, 331}}) {
      if (col >= file.window.width || row >= file.window.height) continue;
      EXPECT_EQ(pixel(*part, band, col, row), pixel(*whole, band, file.window.col + col, file.window.row + row));
    }
  }
  std::array<double, 6> of_whole{};
  std::array<double, 6> of_part{};
  whole->GetGeoTransform(of_whole.data());
  part->GetGeoTransform(of_part.data());
  EXPECT_EQ(of_part[0], of_whole[0] + 0.5 * static_cast<double>(file.window.col));
  EXPECT_EQ(of_part[3], of_whole[3] - 0.5 * static_cast<double>(file.window.row));
  EXPECT_STREQ(part->GetMetadataItem("TIFFTAG_SOFTWARE"), "a camera");
  const ImageryInfo info = inspect_imagery((out_ / file.name).string());
  EXPECT_EQ(info.acquired, "2023-06-14T10:30:00Z");
  EXPECT_EQ(info.licence, (Licence{"CC-BY-4.0", "© City"}));
  EXPECT_EQ(info.crs.authority(), "EPSG:32633");
}

TEST_F(FetchImagery, ASecondRunFetchesNothing) {
  fetch();
  const std::string list = read_file(out_ / kFetchedName);
  const auto written = fs::last_write_time(out_ / "2023-06-14T1030_a.tif");
  const FetchResult again = fetch();
  for (const FetchedFile& file : again.files) EXPECT_TRUE(file.kept) << file.name;
  EXPECT_EQ(read_file(out_ / kFetchedName), list);
  EXPECT_EQ(fs::last_write_time(out_ / "2023-06-14T1030_a.tif"), written);
}

TEST_F(FetchImagery, WhatEndedItLosesNothingThatWasFetched) {
  const std::string expected = [&] {
    fetch();
    std::string digests;
    for (const char* name : {"2021-01-02_b.tif", "2023-06-14T1030_a.tif"}) digests += file_digest(out_ / name);
    fs::remove_all(out_);
    return digests;
  }();
  // Stopped one moment later each time; each run goes on where the one before stopped.
  int runs = 0;
  for (bool done = false; !done; ++runs) {
    ASSERT_LT(runs, 200);
    int left = runs;
    try {
      fetch(false, [&](std::string_view, std::int64_t, std::int64_t) { return left-- > 0; });
      done = true;
    } catch (const Interrupted&) {
      std::error_code nothing_yet;
      for (const auto& entry : fs::directory_iterator(out_, nothing_yet)) {
        if (entry.path().extension() == ".tif") {
          EXPECT_NE(open(entry.path()), nullptr) << "half a file";
        }
      }
    }
  }
  EXPECT_GT(runs, 8);
  std::string digests;
  for (const char* name : {"2021-01-02_b.tif", "2023-06-14T1030_a.tif"}) digests += file_digest(out_ / name);
  EXPECT_EQ(digests, expected);
  for (const auto& entry : fs::directory_iterator(out_)) {
    EXPECT_FALSE(entry.path().filename().string().starts_with(".")) << entry.path();
  }
}

TEST_F(FetchImagery, WhatHasChangedThereOrHereIsFetchedAnew) {
  fetch();
  // Here: damaged. The entry does not fit the file, so it is no longer ours to replace unasked.
  write_file(out_ / "2021-01-02_b.tif", "damaged", true);
  EXPECT_THAT(error_of<DataError>([&] { fetch(); }), HasSubstr("exists already; give --overwrite"));
  FetchResult again = fetch(true);
  EXPECT_FALSE(again.files[0].kept);
  EXPECT_TRUE(again.files[1].kept);
  // There: another date says that it is another picture.
  write_collection("2024-06-14T10:30:00Z");
  again = fetch();
  EXPECT_EQ(again.files[1].name, "2024-06-14T1030_a.tif");
  EXPECT_FALSE(again.files[1].kept);
  EXPECT_THAT(again.warnings, ::testing::Contains(HasSubstr("2023-06-14T1030_a.tif: is of an earlier run")));
}

// A second catalogue does not make the folder forget the first.
TEST_F(FetchImagery, AFolderHoldsWhatSeveralRunsFetched) {
  fetch();
  const std::vector<double> first = options_.bounds_deg;
  fs::rename(folder_ / "a.tif", folder_ / "c.tif");
  FetchedJson only{{"type", "Feature"}, {"id", "c"}, {"bbox", bbox_}, {"assets", {{"visual", {{"href", "c.tif"}}}}}};
  write_file(folder_ / "c.json", only.dump(), true);
  const FetchResult second = fetch_imagery({(folder_ / "c.json").string()}, options_, out_, false);
  EXPECT_EQ(second.files.front().name, "0000_undated_c.tif");
  EXPECT_EQ(second.warnings.size(), 2u);
  fs::rename(folder_ / "c.tif", folder_ / "a.tif");
  for (const FetchedFile& file : fetch().files) EXPECT_TRUE(file.kept) << file.name;
}

TEST_F(FetchImagery, AnInputIsNeverReplaced) {
  fs::create_directories(out_);
  fs::create_hard_link(folder_ / "a.tif", out_ / "2023-06-14T1030_a.tif");
  EXPECT_THAT(error_of<UsageError>([&] { fetch(true); }), HasSubstr("is what would be fetched, and would be lost"));
  EXPECT_FALSE(fs::exists(out_ / "2021-01-02_b.tif")) << "before anything is fetched";
}

TEST_F(FetchImagery, OneRunAtATimeWorksInAFolder) {
  bool asked = false;
  fetch(false, [&](std::string_view what, std::int64_t, std::int64_t) {
    if (!asked && what.starts_with("fetching")) {
      asked = true;
      EXPECT_THAT(error_of<DataError>([&] { fetch(); }), HasSubstr("another run of fetch works in it"));
    }
    return true;
  });
  EXPECT_TRUE(asked);
}

// Corner points that are an affine transform are a place as any other.
TEST_F(FetchImagery, APlaceByControlPointsComesAlong) {
  testing::change_raster(folder_ / "a.tif", [](GDALDataset& dataset) {
    std::array<double, 6> t{};
    dataset.GetGeoTransform(t.data());
    std::vector<GDAL_GCP> points(4);
    GDALInitGCPs(4, points.data());
    for (std::size_t i = 0; i < 4; ++i) {
      points[i].dfGCPPixel = i % 2 == 0 ? 0 : 1200;
      points[i].dfGCPLine = i < 2 ? 0 : 900;
      points[i].dfGCPX = t[0] + points[i].dfGCPPixel * t[1];
      points[i].dfGCPY = t[3] + points[i].dfGCPLine * t[5];
    }
    const OGRSpatialReference reference(*dataset.GetSpatialRef());
    ASSERT_EQ(dataset.SetGCPs(4, points.data(), &reference), CE_None);
    GDALDeinitGCPs(4, points.data());
  });
  const FetchResult result = fetch();
  const ImageryInfo part = inspect_imagery((out_ / result.files[1].name).string());
  const auto corner = part.map_from_pixel.map_from_pixel({0, 0});
  EXPECT_NEAR(corner.x(), 500000 + 0.5 * static_cast<double>(result.files[1].window.col), 1e-6);
  EXPECT_NEAR(corner.y(), 5'000'000 - 0.5 * static_cast<double>(result.files[1].window.row), 1e-6);
  EXPECT_EQ(part.crs.authority(), "EPSG:32633");
}

/// A part of a raster, in strips of a few rows.
class RasterPartCopy : public FetchImagery {
 protected:
  void copy(const std::string& dataset, const PixelWindow& window) {
    fs::create_directories(folder_ / "strips");
    const ImageryInfo info = inspect_imagery(dataset);
    copy_raster_part({dataset, window, info.map_from_pixel, info.crs, {}}, folder_ / "part.tif", folder_ / "strips", {},
                     1);
  }
  const PixelWindow window_{31, 45, 700, 300};
};

TEST_F(RasterPartCopy, WhatWasReadIsNotReadAgain) {
  const std::string dataset = (folder_ / "a.tif").string();
  copy(dataset, window_);
  std::vector<fs::path> strips;
  for (const auto& entry : fs::directory_iterator(folder_ / "strips")) strips.push_back(entry.path());
  ASSERT_GT(strips.size(), 3u);
  // The second run takes what is there, whatever the raster says.
  const fs::path first = folder_ / "strips" / "rows_45";
  ASSERT_TRUE(fs::exists(first));
  write_file(first, std::string(fs::file_size(first), '\x07'), true);
  fs::remove(folder_ / "strips" / "rows_60");
  fs::remove(folder_ / "part.tif");
  copy(dataset, window_);
  const auto part = open(folder_ / "part.tif");
  EXPECT_EQ(pixel(*part, 1, 0, 0), 7);
  EXPECT_EQ(pixel(*part, 2, 5, 200), pixel(*open(dataset), 2, 36, 245));
}

TEST_F(RasterPartCopy, MaskPaletteAndNoDataComeAlong) {
  RasterSpec spec;
  spec.width = 1200;
  spec.height = 900;
  spec.finish = [](GDALDataset& dataset) {
    GDALColorTable colors;
    const GDALColorEntry red{200, 10, 20, 255};
    colors.SetColorEntry(3, &red);
    dataset.GetRasterBand(1)->SetColorTable(&colors);
    ASSERT_EQ(dataset.CreateMaskBand(GMF_PER_DATASET), CE_None);
    std::vector<std::uint8_t> mask(1200 * 900);
    for (std::size_t i = 0; i < mask.size(); ++i) mask[i] = i % 1200 < 400 ? 0 : 255;
    ASSERT_EQ(dataset.GetRasterBand(1)->GetMaskBand()->RasterIO(GF_Write, 0, 0, 1200, 900, mask.data(), 1200, 900,
                                                                GDT_Byte, 0, 0),
              CE_None);
  };
  const std::string masked = testing::make_raster(folder_ / "masked.tif", spec);
  copy(masked, window_);
  auto part = open(folder_ / "part.tif");
  EXPECT_EQ(part->GetRasterBand(1)->GetColorTable()->GetColorEntry(3)->c1, 200);
  std::array<std::uint8_t, 2> mask{};
  for (const int at : {0, 1}) {
    EXPECT_EQ(part->GetRasterBand(1)->GetMaskBand()->RasterIO(
                  GF_Read, 400 - 31 - 1 + at, 7, 1, 1, &mask[static_cast<std::size_t>(at)], 1, 1, GDT_Byte, 0, 0),
              CE_None);
  }
  EXPECT_EQ(mask, (std::array<std::uint8_t, 2>{0, 255}));

  spec.type = GDT_UInt16;
  spec.value = [](int, int col, int row) { return col < 600 ? 65535 : col + row; };
  spec.finish = [](GDALDataset& dataset) { dataset.GetRasterBand(1)->SetNoDataValue(65535); };
  const std::string with_no_data = testing::make_raster(folder_ / "no_data.tif", spec);
  fs::remove_all(folder_ / "strips");
  fs::remove(folder_ / "part.tif");
  copy(with_no_data, window_);
  part = open(folder_ / "part.tif");
  EXPECT_EQ(part->GetRasterBand(1)->GetNoDataValue(), 65535);
  EXPECT_EQ(part->GetRasterBand(1)->GetRasterDataType(), GDT_UInt16);
  std::uint16_t value = 0;
  EXPECT_EQ(part->GetRasterBand(1)->RasterIO(GF_Read, 650, 250, 1, 1, &value, 1, 1, GDT_UInt16, 0, 0), CE_None);
  EXPECT_EQ(value, 650 + 31 + 250 + 45);
}

TEST_F(RasterPartCopy, ARotatedPlaceComesAlong) {
  RasterSpec spec;
  spec.width = 1200;
  spec.height = 900;
  spec.place = {500000, 0.4, 0.3, 5'000'000, 0.3, -0.4};
  const std::string turned = testing::make_raster(folder_ / "turned.tif", spec);
  copy(turned, window_);
  const GeoTransform whole = inspect_imagery(turned).map_from_pixel;
  const GeoTransform part = inspect_imagery((folder_ / "part.tif").string()).map_from_pixel;
  EXPECT_LT((part.map_from_pixel({10, 20}) - whole.map_from_pixel({41, 65})).norm(), 1e-6);
}

TEST_F(FetchImagery, ARouteHasARectangleAroundIt) {
  write_file(folder_ / "r.geojson", R"({"type": "LineString", "coordinates": [[15.001, 45.15], [15.002, 45.151]]})",
             false);
  options_.bounds_deg.clear();
  options_.route = (folder_ / "r.geojson").string();
  options_.margin_m = 100;
  const DegreeBounds bounds = bounds_of(options_);
  const double lat_margin_deg = 100 / 111'140.0;
  EXPECT_NEAR(bounds.south_deg, 45.15 - lat_margin_deg, 1e-5);
  EXPECT_NEAR(bounds.north_deg, 45.151 + lat_margin_deg, 1e-5);
  EXPECT_NEAR(bounds.west_deg, 15.001 - lat_margin_deg / std::cos(45.15 * std::numbers::pi / 180), 2e-5);
  EXPECT_EQ(fetch().files.size(), 2u);
  write_file(folder_ / "r.geojson", R"({"type": "LineString", "coordinates": [[179.999, -16], [-179.998, -16]]})",
             true);
  const DegreeBounds pacific = bounds_of(options_);
  EXPECT_GT(pacific.west_deg, 179.99);
  EXPECT_LT(pacific.east_deg, -179.99);
}

TEST_F(FetchImagery, WhatCannotWorkIsSaid) {
  options_.route = "r.geojson";
  EXPECT_THROW(fetch(), UsageError) << "a route and a rectangle";
  options_.route.clear();
  const std::vector<double> good = options_.bounds_deg;
  for (const std::vector<double>& bad :
       {std::vector<double>{}, {1, 2, 3}, {1, 3, 2, 2}, {16, 100, 17, 110}, {16, 55, 16, 56}}) {
    options_.bounds_deg = bad;
    EXPECT_THROW(fetch(), UsageError);
  }
  options_.bounds_deg = {0, 1, 0.1, 1.1};
  EXPECT_THAT(error_of<DataError>([&] { fetch(); }), HasSubstr("no imagery of the catalogue lies in the rectangle"));
  options_.bounds_deg = good;
  fs::create_directories(out_);
  write_file(out_ / kFetchedName, "{\"mine\": 1}", true);
  EXPECT_THAT(error_of<DataError>([&] { fetch(); }), HasSubstr("is no list of fetched imagery"));
  fs::remove(out_ / kFetchedName);
  fs::remove(folder_ / "b.tif");
  EXPECT_THAT(error_of<DataError>([&] { fetch(); }), HasSubstr("b.tif"));
}

}  // namespace
}  // namespace pilotage
