#include "pilotage/ground/imagery_months.h"

#include <initializer_list>
#include <string>

#include <gtest/gtest.h>

namespace pilotage {
namespace {

std::optional<double> months_of(const std::string& flight_time, std::initializer_list<std::string> acquired) {
  Ground ground;
  ground.flight_time = flight_time;
  for (const std::string& date : acquired) ground.imagery.datasets.emplace_back().acquired = date;
  return imagery_months(ground);
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

}  // namespace
}  // namespace pilotage
