#include "pilotage/ins/ins_products.h"

#include <string>

#include "testing/error_of.h"
#include "testing/source_folder.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pilotage/base/error.h"
#include "pilotage/base/output_file.h"
#include "pilotage/base/text.h"
#include "pilotage/ins/drift.h"

namespace pilotage {
namespace {

using ::testing::HasSubstr;

InsErrorModel product_model(std::string_view name) {
  InsOptions options;
  options.name = name;
  return make_ins_error_model(options);
}

InsErrorModel grade_model(InsGrade grade) {
  InsOptions options;
  options.grade = grade;
  return make_ins_error_model(options);
}

TEST(InsProducts, EachIsSoundAndItsOwn) {
  for (const InsProduct& product : ins_products()) {
    EXPECT_EQ(&ins_product(product.name), &product) << product.name;
    if (!product.also.empty()) {
      EXPECT_EQ(&ins_product(product.also), &product) << product.also;
    }
    EXPECT_FALSE(product.source.empty()) << product.name;
    EXPECT_GT(product.angle_random_walk_deg_rt_h, 0) << product.name;
    const InsErrorModel model = product_model(product.name);
    EXPECT_FALSE(model.is_odometry()) << product.name;
    // A slip of a unit shows as a unit of another class: ten times better or worse than its own.
    const InsErrorModel grade = grade_model(product.grade);
    const double ratio = longest_bridgeable_gap_s(model, 20, 50, 3, 2) / longest_bridgeable_gap_s(grade, 20, 50, 3, 2);
    EXPECT_GT(ratio, 0.5) << product.name;
    EXPECT_LT(ratio, 2) << product.name;
  }
}

TEST(InsProducts, FiguresAreThoseOfTheDataSheets) {
  // 0.0028 °/s/√Hz and 70 µg/√Hz, in degrees and m/s per root hour.
  EXPECT_NEAR(ins_product("ICM-42688-P").angle_random_walk_deg_rt_h, 0.168, 1e-12);
  EXPECT_NEAR(ins_product("ICM-42688-P").velocity_random_walk_mps_rt_h, 0.0412, 1e-4);
  // HG1700: 0.065 ft/s/√h.
  EXPECT_NEAR(ins_product("hg 1700").velocity_random_walk_mps_rt_h, 0.065 * 0.3048, 2e-5);
  // The tactical grade stands for the STIM300, the consumer grade for the ICM-20948, the navigation grade for the
  // HG9900: by name they are the same model.
  const auto same = [](const InsErrorModel& a, const InsErrorModel& b) {
    EXPECT_NEAR(a.accel_bias_mps2, b.accel_bias_mps2, 1e-15);
    EXPECT_NEAR(a.gyro_bias_radps, b.gyro_bias_radps, 1e-15);
    EXPECT_NEAR(a.velocity_random_walk_mps_rt_s, b.velocity_random_walk_mps_rt_s, 1e-6);
    EXPECT_NEAR(a.angle_random_walk_rad_rt_s, b.angle_random_walk_rad_rt_s, 1e-15);
    EXPECT_NEAR(a.accel_scale, b.accel_scale, 1e-15);
    EXPECT_NEAR(a.gyro_scale, b.gyro_scale, 1e-15);
  };
  same(product_model("STIM300"), grade_model(InsGrade::kTactical));
  same(product_model("ICM-20948"), grade_model(InsGrade::kConsumer));
  same(product_model("HG9900"), grade_model(InsGrade::kNavigation));
}

TEST(InsProducts, WhatTheDataSheetLeavesOpenIsOfTheClassAndAFigureGivenWins) {
  InsOptions options;
  options.name = "vn100";
  const InsErrorModel stated = make_ins_error_model(options);
  EXPECT_EQ(stated.accel_bias_mps2, grade_model(InsGrade::kIndustrial).accel_bias_mps2);
  EXPECT_NE(stated.angle_random_walk_rad_rt_s, grade_model(InsGrade::kIndustrial).angle_random_walk_rad_rt_s);
  options.gyro_bias_deg_h = 1;
  EXPECT_LT(make_ins_error_model(options).gyro_bias_radps, stated.gyro_bias_radps);
  EXPECT_EQ(ins_text(options), "VN-100 INS, with figures of your own");
}

TEST(InsProducts, ANameExcludesAGradeAndUnknownNamesAreHelped) {
  InsOptions options;
  options.name = "STIM300";
  options.grade = InsGrade::kConsumer;
  EXPECT_THAT(testing::error_of<UsageError>([&] { make_ins_error_model(options); }),
              HasSubstr("--ins-grade and --ins-name exclude each other: STIM300 is of the class tactical"));
  const auto error = [](const std::string& name) { return testing::error_of<UsageError>([&] { ins_product(name); }); };
  EXPECT_THAT(error("ICM-20649"),
              HasSubstr("no inertial unit \"ICM-20649\" is known by name; did you mean ICM-20689?"));
  EXPECT_THAT(error("sextant"), HasSubstr("--ins-name list names all; any other can be given by its grade"));
  EXPECT_THAT(error("list"), HasSubstr("the inertial units known by name: ADIS16448; "));
}

// The verdict rests on the inertial system more than on anything else, so its words say which was taken.
TEST(InsProducts, WordsSayWhatIsTaken) {
  InsOptions options;
  EXPECT_EQ(ins_text(options), "tactical INS (default)");
  options.grade = InsGrade::kConsumer;
  EXPECT_EQ(ins_text(options), "consumer INS");
  options.grade.reset();
  options.name = "icm 20689";
  EXPECT_EQ(ins_text(options), "ICM-20689 INS (its figures are not confirmed)");
}

TEST(InsProducts, ThePageStatesTheFigures) {
  const std::string page = read_file(testing::source_folder() / "docs/methods/ins.md");
  const auto cell = [](double stated, int decimals) {
    return stated > 0 ? format_fixed(stated, decimals) : std::string("–");
  };
  for (const InsProduct& product : ins_products()) {
    const std::string row =
        "| " + std::string(product.name) + " | " + (product.also.empty() ? "–" : std::string(product.also)) + " | " +
        options_detail::enum_to_name(product.grade) + " | " + cell(product.angle_random_walk_deg_rt_h, 3) + " | " +
        cell(product.velocity_random_walk_mps_rt_h, 4) + " | " + format_number(product.gyro_bias_deg_h) + " | " +
        format_number(product.accel_bias_mg) + " | " +
        format_fixed(longest_bridgeable_gap_s(product_model(product.name), 20, 50, 3, 2), 0) + " | " +
        std::string(product.source) + (product.confirmed ? "" : " (not confirmed)") + " |";
    std::string wanted = row;
    for (std::size_t at; (at = wanted.find("| 0 |")) != std::string::npos;) wanted.replace(at, 5, "| – |");
    EXPECT_THAT(page, HasSubstr(wanted));
  }
}

}  // namespace
}  // namespace pilotage
