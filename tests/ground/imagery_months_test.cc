#include "pilotage/ground/imagery_months.h"

#include <initializer_list>
#include <string>

#include <gtest/gtest.h>

namespace pilotage {
namespace {

Ground ground_of(const std::string& flight_time, std::initializer_list<std::string> acquired) {
  Ground ground;
  ground.flight_time = flight_time;
  for (const std::string& date : acquired) ground.imagery.datasets.emplace_back().acquired = date;
  return ground;
}

std::optional<double> months_of(const std::string& flight_time, std::initializer_list<std::string> acquired) {
  return imagery_months(ground_of(flight_time, acquired));
}

TEST(ImageryMonths, AreThoseOfTheRasterFarthestFromTheFlight) {
  EXPECT_NEAR(months_of("2026-06-01", {"2025-06-01"}).value(), 12, 0.01);
  EXPECT_NEAR(months_of("2026-06-01T09:30:00Z", {"2026-05-01", "2023-06-01", "2026-01-01"}).value(), 36, 0.05);
  EXPECT_NEAR(months_of("2022-06-01", {"2022-03-01", "2025-06-01"}).value(), 36, 0.05) << "taken after the flight";
  EXPECT_NEAR(months_of("2026-06-01", {"2026-06-01"}).value(), 0, 1e-12);
}

TEST(ImageryMonths, AreNotKnownWhereAnyDateIsMissing) {
  EXPECT_FALSE(months_of("2026-06-01", {"2025-06-01", ""}));
  EXPECT_FALSE(months_of("2026-06-01", {"last summer"}));
  EXPECT_FALSE(months_of("", {"2025-06-01"}));
  EXPECT_FALSE(months_of("2026-06-01", {}));
}

TEST(ImageryMonths, GrowOnlyWhereTheOldestRasterIsTheFarthest) {
  const auto growing = [](std::initializer_list<std::string> acquired) {
    const auto oldest = ageing_imagery(ground_of("2026-01-01", acquired));
    return oldest ? std::optional(months_between(*oldest, parse_utc_date("2026-01-01")->time)) : std::nullopt;
  };
  EXPECT_NEAR(growing({"2025-01-01", "2025-10-01"}).value(), 12, 0.02);
  EXPECT_NEAR(growing({"2025-01-01", "2026-06-01"}).value(), 12, 0.02);
  EXPECT_FALSE(growing({"2025-10-01", "2026-12-01"})) << "a later flight is nearer to the second";
  EXPECT_FALSE(growing({"2026-12-01"}));
  EXPECT_FALSE(growing({"2025-01-01", ""}));
  EXPECT_FALSE(growing({}));
}

TEST(ImageryMonths, AMomentSoManyMonthsLater) {
  const UtcTime from = parse_utc_date("2026-03-01")->time;
  EXPECT_EQ(format_utc_time(months_after(from, 12)), "2027-03-01T05:49:12Z");
  EXPECT_NEAR(months_between(from, months_after(from, -7.25)), -7.25, 1e-6);
}

}  // namespace
}  // namespace pilotage
