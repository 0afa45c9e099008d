#include "pilotage/base/wording.h"

#include <limits>

#include <gtest/gtest.h>

#include "pilotage/base/nan.h"

namespace pilotage {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

TEST(Wording, Lengths) {
  EXPECT_EQ(length_text(3412), "3.4 km");
  EXPECT_EQ(length_text(850.4), "850 m");
  EXPECT_EQ(length_text(999.6), "1.0 km");
  EXPECT_EQ(length_text(kNaN), "unknown");
}

TEST(Wording, ErrorsAndComparisons) {
  EXPECT_EQ(error_text(61.4), "61 m");
  EXPECT_EQ(error_text(4.21), "4.2 m");
  EXPECT_EQ(error_text(9.96), "10 m");
  EXPECT_EQ(error_text(kInfinity), "unbounded");
  EXPECT_EQ(comparison_text(61, 50), "61 m > 50 m");
  EXPECT_EQ(comparison_text(50, 50), "50 m ≤ 50 m");
  EXPECT_EQ(comparison_text(kInfinity, 50), "unbounded > 50 m");
  EXPECT_EQ(comparison_text(kNaN, 50), "unknown > 50 m");
}

TEST(Wording, ComparisonNeverShowsEqualNumbersThatAreNot) {
  EXPECT_EQ(comparison_text(50.2, 50), "50.2 m > 50.0 m");
  EXPECT_EQ(comparison_text(49.996, 50), "49.996 m ≤ 50.000 m");
}

TEST(Wording, DurationsSharesBytesNumbers) {
  EXPECT_EQ(duration_text(122.3), "122 s");
  EXPECT_EQ(duration_text(845), "14 min 5 s");
  EXPECT_EQ(duration_text(599.7), "10 min 0 s");
  EXPECT_EQ(percent_text(0.87), "87 %");
  EXPECT_EQ(percent_text(0.29), "29 %");
  EXPECT_EQ(percent_text(0.9999), "99 %");
  EXPECT_EQ(percent_text(1), "100 %");
  EXPECT_EQ(percent_text(0.004), "less than 1 %");
  EXPECT_EQ(percent_text(0), "0 %");
  EXPECT_EQ(bytes_text(812), "812 bytes");
  EXPECT_EQ(bytes_text(1.5 * 1024 * 1024), "1.5 MiB");
  EXPECT_EQ(number_text(kNaN, 2), "–");
  EXPECT_EQ(number_text(1.005, 1), "1.0");
  EXPECT_EQ(count_text(1, "class", "classes"), "1 class");
  EXPECT_EQ(count_text(0, "class", "classes"), "0 classes");
  EXPECT_EQ(listed({}), "");
  EXPECT_EQ(listed({"2"}), "2");
  EXPECT_EQ(listed({"2", "4", "5"}), "2, 4 and 5");
}

}  // namespace
}  // namespace pilotage
