#include "pilotage/landmark/label_landmarks.h"

#include <cmath>

#include "raster/raster_maker.h"
#include "testing/error_of.h"
#include "testing/read_all.h"
#include "testing/temporary_folder.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pilotage/base/error.h"
#include "pilotage/base/output_file.h"
#include "pilotage/base/text.h"
#include "pilotage/landmark/annotated_picture.h"
#include "pilotage/landmark/landmark_label.h"
#include "pilotage/landmark/outline.h"
#include "pilotage/raster/gdal_gray.h"

namespace pilotage {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector2d;
using testing::error_of;
using ::testing::HasSubstr;
using testing::make_raster;
using testing::RasterSpec;
using testing::TemporaryFolder;
using testing::utm33;

constexpr int kSide_px = 400;
constexpr double kGsd_m = 0.5;

/// 200 m of ground whose north-west corner is (500000, 5000000).
class LabelLandmarksTest : public ::testing::Test {
 protected:
  LabelLandmarksTest() {
    spec.width = kSide_px;
    spec.height = kSide_px;
    imagery = make_raster(folder / "ortho.tif", spec);
  }

  /// "[lon, lat]" of a point given in metres east and south of the corner.
  static std::string place(double east_m, double south_m) {
    const CrsTransform transform(utm33());
    const GeodeticPoint point = *transform.geodetic_from_map(Vector2d(500'000 + east_m, 5'000'000 - south_m));
    return "[" + format_fixed(point.lon_deg, 10) + ", " + format_fixed(point.lat_deg, 10) + "]";
  }
  static std::string square(double east_m, double south_m, double side_m, const std::string& properties) {
    const std::string first = place(east_m, south_m);
    return R"({"type": "Feature", "properties": )" + properties +
           R"(, "geometry": {"type": "Polygon", "coordinates": [[)" + first + ", " + place(east_m + side_m, south_m) +
           ", " + place(east_m + side_m, south_m + side_m) + ", " + place(east_m, south_m + side_m) + ", " + first +
           "]]}}";
  }
  static std::string point(double east_m, double south_m, const std::string& properties) {
    return R"({"type": "Feature", "properties": )" + properties + R"(, "geometry": {"type": "Point", "coordinates": )" +
           place(east_m, south_m) + "}}";
  }
  void write_labels(const std::vector<std::string>& features) {
    write_file(folder / "labels.geojson",
               R"({"type": "FeatureCollection", "features": [)" + join(features, ",\n") + "]}", true);
    options.labels = {(folder / "labels.geojson").string()};
  }
  LabelledChips label(bool overwrite = false) {
    return label_landmarks({imagery}, options, folder / "chips", overwrite, 1);
  }
  std::string error() {
    return error_of<DataError>([&] { label(); });
  }

  RasterSpec spec;
  TemporaryFolder folder;
  std::string imagery;
  LabelOptions options;
};

TEST_F(LabelLandmarksTest, ChipsAreTheImageryAroundEachLabel) {
  write_labels({square(60, 80, 20, R"({"class": "hall"})"), point(150, 100, R"({"class": "tank", "diameter": 16})")});
  options.background_chips = 3;
  const LabelledChips chips = label();
  ASSERT_EQ(chips.classes.size(), 2U);
  EXPECT_EQ(chips.classes[0].class_name, "hall");
  EXPECT_NEAR(chips.classes[0].median_m, 20, 1e-3);
  EXPECT_NEAR(chips.classes[1].median_m, 16, 0.1);
  EXPECT_EQ(chips.background_chips, 3);
  EXPECT_NEAR(chips.gsd_m, kGsd_m, 1e-3);  // on the ground

  const auto pictures = read_annotations(folder / "chips" / kChipAnnotations);
  ASSERT_EQ(pictures.size(), 5U);
  // The label lies on its chip where the imagery has it: the chip's pixels are the imagery's.
  const ImageryInfo info = inspect_imagery(pictures[0].picture.string());
  EXPECT_TRUE(info.crs.same_as(utm33()));
  EXPECT_EQ(info.width_px, 128);  // 3.2 lengths
  const Vector2d middle = info.map_from_pixel.map_from_pixel(oriented_box(pictures[0].labels[0].outline_px).center);
  EXPECT_NEAR(middle.x(), 500'070, kGsd_m / 2);
  EXPECT_NEAR(middle.y(), 4'999'910, kGsd_m / 2);
  const cv::Mat chip = read_gray8_picture(pictures[0].picture.string());
  const Vector2d first_px = spec.place.pixel_from_map(info.map_from_pixel.map_from_pixel({0.5, 0.5}));
  for (const int at : {0, 17, 127}) {
    EXPECT_EQ(chip.at<std::uint8_t>(at, 127 - at),
              spec.value(0, static_cast<int>(first_px.x()) + 127 - at, static_cast<int>(first_px.y()) + at));
  }
  EXPECT_GT(circularity(pictures[1].labels[0].outline_px), 0.95);
  for (std::size_t i = 2; i < 5; ++i) EXPECT_TRUE(pictures[i].labels.empty());
}

TEST_F(LabelLandmarksTest, WhatWasLabelledCanBeLabelledAgain) {
  write_labels({square(60, 80, 20, R"({"kind": "hall"})"), square(100, 80, 10, R"({"kind": "shed"})"),
                point(20, 20, R"({"name": "no label"})")});
  options.class_field = "kind";
  const LabelledChips first = label();
  EXPECT_EQ(first.classes.size(), 2U);
  for (const char* again : {kLabelShapes, kChipAnnotations}) {
    LabelOptions relabel;
    relabel.labels = {(folder / "chips" / again).string()};
    const LabelledChips second = label_landmarks({imagery}, relabel, folder / "again", true, 1);
    ASSERT_EQ(second.classes.size(), 2U) << again;
    EXPECT_NEAR(second.classes[0].median_m, 20, kGsd_m) << again;
    EXPECT_EQ(second.classes[1].labels, 1) << again;
    EXPECT_EQ(second.merged, 0) << "the shed stands on the hall's chip, too, but is ignored there";
    // Each at its place: the halls of both runs cover each other.
    const auto middle_of = [&](const fs::path& chips) {
      const auto pictures = read_annotations(chips / kChipAnnotations);
      const ImageryInfo info = inspect_imagery(pictures[0].picture.string());
      return info.map_from_pixel.map_from_pixel(oriented_box(pictures[0].labels[0].outline_px).center);
    };
    EXPECT_NEAR((middle_of(folder / "chips") - middle_of(folder / "again")).norm(), 0, kGsd_m) << again;
  }
}

TEST_F(LabelLandmarksTest, NeighboursAreIgnoredOnAChip) {
  write_labels({square(60, 80, 20, R"({"class": "hall"})"), square(90, 80, 20, R"({"class": "hall"})")});
  label();
  const auto pictures = read_annotations(folder / "chips" / kChipAnnotations);
  for (const std::size_t i : {0U, 1U}) {
    ASSERT_EQ(pictures[i].labels.size(), 2U);
    EXPECT_FALSE(pictures[i].labels[0].ignore);
    EXPECT_TRUE(pictures[i].labels[1].ignore);
  }
}

TEST_F(LabelLandmarksTest, WhatIsIgnoredHasNoChipAndIsNoBackground) {
  write_labels(
      {square(60, 80, 20, R"({"class": "hall"})"), square(90, 80, 20, R"({"class": "hall", "ignore": true})")});
  const LabelledChips chips = label();
  EXPECT_EQ(chips.classes[0].labels, 1);
  EXPECT_EQ(chips.background_chips, 1);
  EXPECT_FALSE(fs::exists(folder / "chips" / "chip_000002.png"));
  const auto pictures = read_annotations(folder / "chips" / kChipAnnotations);
  ASSERT_EQ(pictures[0].labels.size(), 2U);
  EXPECT_TRUE(pictures[0].labels[1].ignore);
  // No background lies on either.
  options.background_chips = 30;
  const LabelledChips many = label(true);
  EXPECT_GT(many.background_chips, 10);
  for (std::int64_t i = 1; i <= many.background_chips; ++i) {
    const std::string digits = std::to_string(i);
    const ImageryInfo info = inspect_imagery(
        (folder / "chips" / ("background_" + std::string(6 - digits.size(), '0') + digits + ".png")).string());
    const Vector2d corner = info.map_from_pixel.map_from_pixel({0, 0}) - Vector2d(500'000, 5'000'000);
    const double side_m = info.width_px * kGsd_m;
    const bool clear =
        corner.x() >= 110 || corner.x() + side_m <= 60 || -corner.y() >= 100 || -corner.y() + side_m <= 80;
    EXPECT_TRUE(clear) << corner.transpose();
  }
}

TEST_F(LabelLandmarksTest, ClosedLinesAreOutlinesAndOpenOnesAreRefused) {
  const auto line = [&](bool closed) {
    std::string points;
    for (int i = 0; i < 12; ++i) {
      points += place(100 + 12 * std::cos(i * 0.5236), 100 + 12 * std::sin(i * 0.5236)) + ", ";
    }
    return R"({"type": "Feature", "properties": {"class": "roundabout"}, "geometry": {"type": "LineString", "coordinates": [)" +
           points + (closed ? place(112, 100) : place(300, 300)) + "]}}";
  };
  write_labels({line(true)});
  EXPECT_NEAR(label().classes[0].median_m, 24, 0.9);
  write_labels({line(false)});
  EXPECT_THAT(error_of<DataError>([&] { label(true); }), HasSubstr("feature 0: is an open line"));
}

TEST_F(LabelLandmarksTest, LabelsThatDoNotFitAreRefusedByNameOrSkipped) {
  write_labels({square(60, 80, 20, R"({"class": "hall"})"), square(190, 80, 20, R"({"class": "hall"})"),
                square(20, 20, 20, R"({"class": "hall", "start_date": "2024"})")});
  spec.finish = [](GDALDataset& dataset) { dataset.SetMetadataItem("TIFFTAG_DATETIME", "2023:06:14 09:40:00"); };
  imagery = make_raster(folder / "dated.tif", spec);
  EXPECT_THAT(error(), HasSubstr("feature 2: begins 2024, after the imagery of 2023-06-14"));
  EXPECT_FALSE(fs::exists(folder / "chips" / kChipAnnotations));
  options.unfit = UnfitLabels::kSkip;
  const LabelledChips chips = label();
  EXPECT_EQ(chips.classes[0].labels, 1);
  EXPECT_EQ(chips.outside, 1);
  EXPECT_EQ(chips.other_date, 1);

  options.unfit = UnfitLabels::kRefuse;
  write_labels(
      {square(60, 80, 20, R"({"class": "hall", "start_date": "2023"})"), square(190, 80, 20, R"({"class": "hall"})")});
  EXPECT_THAT(error_of<DataError>([&] { label(true); }),
              HasSubstr("feature 1: does not lie wholly on ground that the imagery shows"));
}

TEST_F(LabelLandmarksTest, GroundThatIsNotThereIsNoGround) {
  spec.finish = [](GDALDataset& dataset) { dataset.GetRasterBand(1)->SetNoDataValue(7); };
  spec.value = [](int, int col, int row) { return col > 300 ? 7 : 50 + (col * 3 + row * 5) % 150; };
  imagery = make_raster(folder / "half.tif", spec);
  write_labels({square(140, 80, 20, R"({"class": "hall"})")});
  EXPECT_THAT(error(), HasSubstr("does not lie wholly on ground"));
}

TEST_F(LabelLandmarksTest, ContradictionsNameBothAndTwinsCount) {
  write_labels({square(60, 80, 20, R"({"class": "hall"})"), square(61, 81, 20, R"({"class": "barn"})")});
  EXPECT_THAT(error(),
              ::testing::AllOf(HasSubstr("feature 1: is a barn where"), HasSubstr("feature 0 has labelled a hall")));
  write_labels({square(60, 80, 20, R"({"class": "hall"})"), square(61, 81, 20, R"({"class": "hall"})")});
  EXPECT_EQ(label().merged, 1);
}

TEST_F(LabelLandmarksTest, NamesWhatIsMissing) {
  write_labels({point(100, 100, R"({"class": "tank"})")});
  EXPECT_THAT(error(), HasSubstr("is a point, and nobody says its size; give --diameter-m"));
  write_labels({point(100, 100, R"({"class": "tank", "diameter": "wide"})")});
  EXPECT_THAT(error(), HasSubstr("its diameter \"wide\" is no number of metres"));
  write_labels({point(100, 100, R"({"man_made": "tank"})")});
  EXPECT_THAT(error(),
              HasSubstr("no shape has a property class; give --class, or --class-field with one of: man_made"));
  options.diameter_m = 10;
  options.class_name = "tank";
  options.classes = {"silo"};
  EXPECT_THAT(error(), HasSubstr("hold no label of the classes silo"));
  options.labels.clear();
  EXPECT_THROW(label(), UsageError);
}

TEST_F(LabelLandmarksTest, ExistingChipsAreReplacedTogether) {
  write_labels({square(60, 80, 20, R"({"class": "hall"})"), square(100, 80, 20, R"({"class": "hall"})")});
  label();
  EXPECT_TRUE(fs::exists(folder / "chips" / "chip_000002.png"));
  write_labels({square(60, 80, 20, R"({"class": "hall"})")});
  EXPECT_THAT(error(), HasSubstr("exists already; give --overwrite"));
  label(true);
  EXPECT_FALSE(fs::exists(folder / "chips" / "chip_000002.png"));
  EXPECT_FALSE(fs::exists(folder / "chips" / "chip_000002.png.aux.xml"));
}

TEST_F(LabelLandmarksTest, LabelsAtTheEdgeOfTheImageryFit) {
  write_labels({square(180, 180, 20, R"({"class": "hall"})"), square(0, 0, 20, R"({"class": "hall"})")});
  const LabelledChips chips = label();
  EXPECT_EQ(chips.classes[0].labels, 2);
  EXPECT_EQ(chips.outside, 0);
}

TEST_F(LabelLandmarksTest, HallsSideBySideAreTwo) {
  const auto diagonal = [&](double off_m) {
    std::string ring;
    for (const auto& [a, b] : {std::pair{-40, -3}, {40, -3}, {40, 3}, {-40, 3}, {-40, -3}}) {
      const double along = a * std::sqrt(0.5);
      const double across = (b + off_m) * std::sqrt(0.5);
      ring += (ring.empty() ? "" : ", ") + place(100 + along - across, 100 + along + across);
    }
    return R"({"type": "Feature", "properties": {"class": "hall"}, "geometry": {"type": "Polygon", "coordinates": [[)" +
           ring + "]]}}";
  };
  write_labels({diagonal(0), diagonal(8)});
  const LabelledChips chips = label();
  EXPECT_EQ(chips.classes[0].labels, 2);
  EXPECT_EQ(chips.merged, 0);
}

TEST_F(LabelLandmarksTest, DaysAreComparedAndGoWithTheLabels) {
  spec.finish = [](GDALDataset& dataset) { dataset.SetMetadataItem("TIFFTAG_DATETIME", "2023:06:14 09:40:00"); };
  imagery = make_raster(folder / "dated.tif", spec);
  write_labels({square(60, 80, 20, R"({"class": "hall", "start_date": "2023-06-15"})")});
  EXPECT_THAT(error(), HasSubstr("begins 2023-06-15, after the imagery of 2023-06-14"));
  write_labels({square(60, 80, 20, R"({"class": "hall", "start_date": "2023-06-14", "end_date": "2023-07"})")});
  label();
  LabelOptions later;
  later.labels = {(folder / "chips" / kLabelShapes).string()};
  spec.finish = [](GDALDataset& dataset) { dataset.SetMetadataItem("TIFFTAG_DATETIME", "2024:06:14 09:40:00"); };
  const std::string year_later = make_raster(folder / "later.tif", spec);
  EXPECT_THAT(error_of<DataError>([&] { label_landmarks({year_later}, later, folder / "later", true, 1); }),
              HasSubstr("ended 2023-07, before the imagery of 2024-06-14"));
  write_labels({square(60, 80, 20, R"({"class": "hall", "start_date": "~1990"})")});
  EXPECT_THAT(label(true).warnings, ::testing::Contains(HasSubstr("1 labels have dates that are none")));
}

TEST_F(LabelLandmarksTest, WhatIsNowhereIsSkippedWhenAsked) {
  const std::string broken = R"({"type": "Feature", "properties": {"class": "hall"},
 "geometry": {"type": "Polygon", "coordinates": [[[15, 45], [15.1, 45], [15, 45]]]}})";
  write_labels({square(60, 80, 20, R"({"class": "hall"})"), broken, square(500'000, 80, 9000, R"({"class": "hall"})")});
  EXPECT_THAT(error(), HasSubstr("feature 1: a ring of a polygon has fewer than three corners; --unfit skip"));
  options.unfit = UnfitLabels::kSkip;
  const LabelledChips chips = label();
  EXPECT_EQ(chips.classes[0].labels, 1);
  EXPECT_EQ(chips.outside, 2);
  write_labels({square(60, 80, 0.1, R"({"class": "hall"})")});
  EXPECT_THAT(error_of<DataError>([&] { label(true); }), HasSubstr("is an outline without extent, 0.1"));
}

TEST_F(LabelLandmarksTest, AnnotationsMustBeOfTheirPicture) {
  const auto imglab = [&](const std::string& picture, const std::string& box) {
    write_file(folder / "boxes.xml",
               "<dataset><images><image file='" + picture + "'>" + box + "</image></images></dataset>", true);
    options.labels = {(folder / "boxes.xml").string()};
  };
  options.class_name = "hall";  // its boxes have no class
  imglab("ortho.tif", "<box left='360' top='360' width='40' height='40'/>");
  EXPECT_EQ(label().classes[0].labels, 1);
  imglab("ortho.tif", "<box left='380' top='360' width='40' height='40'/>");
  EXPECT_THAT(error_of<DataError>([&] { label(true); }),
              HasSubstr("box 1: reaches out of its picture of 400 x 400 px"));

  spec.srs = "";
  make_raster(folder / "no_crs.tif", spec);
  imglab("no_crs.tif", "<box left='60' top='60' width='40' height='40'/>");
  EXPECT_THAT(error_of<DataError>([&] { label(true); }), HasSubstr("its picture has no place on the ground"));
  options.imagery.imagery_crs = "EPSG:32633";
  EXPECT_EQ(label(true).classes[0].labels, 1);

  write_file(folder / "coco.json", R"({"images": [{"id": 1, "file_name": "ortho.tif", "width": 200, "height": 200}],
 "categories": [{"id": 1, "name": "hall"}],
 "annotations": [{"image_id": 1, "category_id": 1, "bbox": [10, 10, 30, 30]}]})",
             true);
  options.labels = {(folder / "coco.json").string()};
  EXPECT_THAT(error_of<DataError>([&] { label(true); }),
              HasSubstr("was drawn on a picture of 200 x 200 px, and the picture has 400 x 400"));
}

TEST_F(LabelLandmarksTest, HalvesOfOneGridKeepItsPixels) {
  RasterSpec half = spec;
  half.width = kSide_px / 2;
  const std::string west = make_raster(folder / "west.tif", half);
  half.place = GeoTransform::north_up(500'100, 5'000'000, kGsd_m);
  half.value = [&](int band, int col, int row) { return spec.value(band, col + kSide_px / 2, row); };
  const std::string east = make_raster(folder / "east.tif", half);
  write_labels({square(90, 80, 20, R"({"class": "hall"})")});
  label();
  label_landmarks({west, east}, options, folder / "halves", false, 1);
  EXPECT_EQ(read_file(folder / "chips" / "chip_000001.png"), read_file(folder / "halves" / "chip_000001.png"));
}

TEST_F(LabelLandmarksTest, TheSameInputGivesTheSameBytes) {
  write_labels({square(60, 80, 20, R"({"class": "hall"})")});
  const LabelledChips first = label();
  label_landmarks({imagery}, options, folder / "again", false, 1);
  for (const std::string& file : first.files) {
    EXPECT_EQ(read_file(folder / "chips" / file), read_file(folder / "again" / file)) << file;
  }
}

TEST_F(LabelLandmarksTest, ImageryInDegreesIsResampledToMetres) {
  RasterSpec degrees;
  degrees.srs = "EPSG:4326";
  degrees.width = degrees.height = 300;
  degrees.place = {15.0, 1e-5, 0, 45.15, 0, -1e-5};
  imagery = make_raster(folder / "degrees.tif", degrees);
  write_labels(
      {R"({"type": "Feature", "properties": {"class": "tank", "diameter": 30}, "geometry": {"type": "Point", "coordinates": [15.0015, 45.1485]}})"});
  const LabelledChips chips = label();
  EXPECT_TRUE(chips.crs.is_projected());
  EXPECT_NEAR(chips.gsd_m, 1.11, 0.01);
}

}  // namespace
}  // namespace pilotage
