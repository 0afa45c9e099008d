#include "pilotage/tile/cloud_table.h"

#include <fstream>
#include <string>

#include "testing/temporary_folder.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pilotage/base/error.h"

namespace pilotage {
namespace {

using ::testing::HasSubstr;
using testing::TemporaryFolder;

double hidden(const std::string& table, const char* flight) {
  const TemporaryFolder folder;
  std::ofstream(folder / "clouds.csv") << table;
  return hidden_fraction(folder / "clouds.csv", parse_utc_date(flight).value());
}

std::string refusal(const std::string& table, const char* flight) {
  try {
    hidden(table, flight);
  } catch (const DataError& error) {
    return error.what();
  }
  return "";
}

TEST(CloudTable, IsAskedByMonth) {
  const std::string table = "station,month,hidden_fraction\nX,5,0.25\nX,6,0.4\n";
  EXPECT_EQ(hidden(table, "2026-06-01"), 0.4);
  EXPECT_EQ(hidden(table, "2026-05-31T23:59:59Z"), 0.25);
  EXPECT_THAT(refusal(table, "2026-07-01"), HasSubstr("says nothing of month 7, in which the flight begins"));
}

TEST(CloudTable, IsAskedByHourWhereItHasHours) {
  const std::string table = "month,hour_utc,hidden_fraction\n6,9,0.5\n6,10,0.1\n7,9,1\n";
  EXPECT_EQ(hidden(table, "2026-06-01T09:59:59Z"), 0.5);
  EXPECT_EQ(hidden(table, "2026-06-01T10:00:00Z"), 0.1);
  EXPECT_DOUBLE_EQ(hidden(table, "2026-06-01"), 0.3) << "a day alone: the mean of its hours";
  EXPECT_THAT(refusal(table, "2026-06-01T11:00:00Z"), HasSubstr("month 6 at hour 11 UTC"));
}

TEST(CloudTable, WhatIsNoneIsRefused) {
  EXPECT_THAT(refusal("", "2026-06-01"), HasSubstr("a table of clouds by month"));
  EXPECT_THAT(refusal("hidden_fraction\n0.1\n", "2026-06-01"), HasSubstr("lacks the column month"));
  EXPECT_THAT(refusal("month\n6\n", "2026-06-01"), HasSubstr("lacks the column hidden_fraction"));
  EXPECT_THAT(refusal("month,hidden_fraction\n6,40\n", "2026-06-01"), HasSubstr("\"40\" is not a number from 0 to 1"));
  EXPECT_THAT(refusal("month,hidden_fraction\n6,nan\n", "2026-06-01"), HasSubstr("is not a number from 0 to 1"));
  EXPECT_THAT(refusal("month,hidden_fraction\n6.5,0.4\n", "2026-06-01"), HasSubstr("is not a whole number"));
  EXPECT_THAT(refusal("month,hidden_fraction\n6,0.4\n6,0.5\n", "2026-06-01"), HasSubstr("month 6 is there already"));
}

}  // namespace
}  // namespace pilotage
