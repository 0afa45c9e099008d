#include "pilotage/verdict/imagery_age.h"

#include <cmath>

#include "report/report_scene.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "pilotage/base/error.h"
#include "pilotage/report/imagery_age_section.h"
#include "pilotage/report/report.h"
#include "pilotage/verdict/verdict.h"

namespace pilotage {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::StartsWith;

/// A flight of 1,200 s along the equator at 0° E over one raster.
Mission over_imagery_of(const std::string& acquired, const std::string& flight_time) {
  Mission mission;
  mission.ground.imagery.datasets.resize(1);
  mission.ground.imagery.datasets[0].dataset = "ortho.tif";
  mission.ground.imagery.datasets[0].acquired = acquired;
  mission.ground.flight_time = flight_time;
  mission.flight.samples.resize(3);
  for (std::size_t i = 0; i < 3; ++i) {
    mission.flight.samples[i].distance_m = 6000.0 * static_cast<double>(i);
    mission.flight.samples[i].speed_mps = 10;
  }
  return mission;
}

TEST(ImageryAge, IsNotSaidWithoutATimeOfTheFlight) {
  EXPECT_FALSE(imagery_age(over_imagery_of("2023-06-14", "")));
  EXPECT_TRUE(imagery_age_rows(over_imagery_of("2023-06-14", "")).empty());
  EXPECT_EQ(imagery_age_assumptions(over_imagery_of("2023-06-14", ""), false), "");
  EXPECT_EQ(imagery_age_html(std::nullopt), "");
  EXPECT_THROW(imagery_age(over_imagery_of("2023-06-14", "tomorrow")), DataError);
}

TEST(ImageryAge, CountsMonthsAndSeasonsRoundTheYear) {
  const auto age = imagery_age(over_imagery_of("2023-06-15", "2026-04-15")).value();
  EXPECT_NEAR(age.datasets[0].age_months, 34, 0.05);
  EXPECT_NEAR(age.datasets[0].season_months, 2, 0.05);
  EXPECT_FALSE(age.flight) << "its hour is not known";
  const auto other = imagery_age(over_imagery_of("2023-06-15", "2023-12-15")).value();
  EXPECT_NEAR(other.datasets[0].season_months, 6, 0.05);
  const auto younger = imagery_age(over_imagery_of("2024-06-15", "2023-12-15")).value();
  EXPECT_NEAR(younger.datasets[0].age_months, -6, 0.05);
  EXPECT_THAT(imagery_age_sentences(younger)[0], HasSubstr("6 months younger than the flight"));
}

// On the equator at an equinox the sun goes from due east over the zenith to due west: at 45° a shadow is as long as
// its object is high, so three hours before and three hours after noon the tips lie two heights apart.
TEST(ImageryAge, ShadowsOfMorningAndAfternoonLieApart) {
  const auto age = imagery_age(over_imagery_of("2024-03-20T09:07:24Z", "2026-03-20T14:57:24Z")).value();
  ASSERT_TRUE(age.flight);  // half-way, ten minutes after take-off
  EXPECT_EQ(format_utc_time(age.flight->time), "2026-03-20T15:07:24Z");
  EXPECT_NEAR(age.flight->sun.elevation_deg, 45, 0.3);
  EXPECT_NEAR(age.flight->shadow_shift_m, 20, 0.2);
  const auto same = imagery_age(over_imagery_of("2024-03-20T15:07:24Z", "2026-03-20T14:57:24Z")).value();
  EXPECT_NEAR(same.flight->shadow_shift_m, 0, 0.2);
}

TEST(ImageryAge, SaysWhenShadowsDifferMost) {
  const auto age = imagery_age(over_imagery_of("2024-03-20T09:07:24Z", "2026-03-20")).value();
  ASSERT_EQ(age.hours.size(), 11U) << "from 7 to 17 h";
  EXPECT_THAT(imagery_age_sentences(age).back(),
              AllOf(HasSubstr("least at 09:00 UTC"), HasSubstr("most at 17:00 UTC")));
  const std::string html = imagery_age_html(age);
  EXPECT_THAT(html, HasSubstr("ortho.tif, of 2024-03-20T09:07:24Z: 24 months old, 0 months apart in season"));
  EXPECT_THAT(html, HasSubstr("<th scope=\"row\">17:00</th>"));
  EXPECT_THAT(html, HasSubstr("The default P(correct fix) counts the age"));
}

TEST(ImageryAge, AnHourThatIsNotKnownIsTakenForNoonAndSaidSo) {
  const auto age = imagery_age(over_imagery_of("2024-03-20", "2026-03-20T11:57:24Z")).value();
  EXPECT_FALSE(age.datasets[0].hour_known);
  EXPECT_NEAR(age.datasets[0].sun->elevation_deg, 90, 0.5);
  EXPECT_THAT(imagery_age_sentences(age)[0], HasSubstr("if it was taken at noon: its hour is not known"));
  const auto unknown = imagery_age(over_imagery_of("", "2026-03-20T11:57:24Z")).value();
  EXPECT_EQ(imagery_age_sentences(unknown)[0], "ortho.tif: when it was taken is not known.");
  EXPECT_TRUE(std::isnan(unknown.flight->shadow_shift_m));
  EXPECT_EQ(imagery_age_json(unknown)["datasets"][0]["age_months"], nullptr);
}

TEST(ImageryAge, RowsJudgeAgeSeasonAndSun) {
  const auto statuses = [](const std::string& acquired, const std::string& flight_time) {
    std::vector<QualityStatus> said;
    for (const QualityRow& row : imagery_age_rows(over_imagery_of(acquired, flight_time))) said.push_back(row.status);
    return said;
  };
  constexpr auto kGood = QualityStatus::kGood;
  constexpr auto kMarginal = QualityStatus::kMarginal;
  EXPECT_THAT(statuses("2025-04-01", "2026-03-20T12:00:00Z"), ElementsAre(kGood, kGood));
  EXPECT_THAT(statuses("2024-02-20", "2026-03-20T12:00:00Z"), ElementsAre(kMarginal, kGood)) << "25 months";
  EXPECT_THAT(statuses("2025-12-20", "2026-03-20T12:00:00Z"), ElementsAre(kMarginal, kGood)) << "winter";
  EXPECT_THAT(statuses("", "2026-03-20T12:00:00Z"), ElementsAre(kMarginal, kGood));
  EXPECT_THAT(statuses("2025-04-01", "2026-03-20T06:30:00Z"), ElementsAre(kGood, kMarginal)) << "8° high";
  EXPECT_THAT(statuses("2025-04-01", "2026-03-20T20:00:00Z"), ElementsAre(kGood, QualityStatus::kBad)) << "night";
}

TEST(ImageryAge, AFlightByNightIsNoGo) {
  ReportInput input = testing::report_scene({});
  const QualityStatus before = make_report(input).verdict;
  EXPECT_NE(before, QualityStatus::kBad);
  const GeodeticPoint point = input.mission.flight.samples.front().point;
  const int noon_utc = 12 - static_cast<int>(std::lround(point.lon_deg / 15));
  const auto at = [&](int hour) {
    const int wrapped = (hour + 24) % 24;
    input.mission.ground.flight_time =
        "2026-03-20T" + std::string(wrapped < 10 ? "0" : "") + std::to_string(wrapped) + ":00:00Z";
    return make_report(input);
  };
  EXPECT_EQ(at(noon_utc).verdict, before);
  const Report night = at(noon_utc + 12);
  EXPECT_EQ(night.verdict, QualityStatus::kBad);
  EXPECT_THAT(night.verdict_text, HasSubstr("below the horizon"));
}

TEST(ImageryAge, OfImageryWithoutAFlightIsToldAlike) {
  const auto phrase = [](const std::string& acquired, const std::string& flight_time, bool counted = true) {
    return imagery_age_phrase(imagery_age(over_imagery_of(acquired, "").ground.imagery.datasets, {10, 50}, flight_time),
                              counted);
  };
  EXPECT_EQ(phrase("2024-03-20", "2026-07-01"),
            "imagery 27 months old, 3 months apart in season (P(correct fix) counts the age by a rule of thumb, not "
            "the season)");
  EXPECT_EQ(phrase("2024-03-20", "2026-07-01", false),
            "imagery 27 months old, 3 months apart in season (P(correct fix) counts neither)");
  EXPECT_EQ(phrase("2026-09-20", "2026-07-01"),
            "imagery 3 months younger than the flight (P(correct fix) counts the age by a rule of thumb, "
            "not the season)");
  EXPECT_EQ(phrase("", "2026-07-01"), "imagery of unknown age, which P(correct fix) does not count");
  ImageryAge half = imagery_age(over_imagery_of("2024-03-20", "2026-07-01")).value();
  half.datasets.emplace_back().dataset = "other.tif";
  EXPECT_THAT(imagery_age_phrase(half, false), HasSubstr("counts neither; of some imagery the date is not known)"));
  EXPECT_THROW(phrase("2024-03-20", "tomorrow"), UsageError);
}

TEST(ImageryAge, IsSaidToBeCountedWhereTheSelectionCountsIt) {
  const Mission mission = over_imagery_of("2025-04-01", "2026-03-20");
  Selection selection;
  selection.probability.emplace();
  EXPECT_THAT(assumptions_line(mission, selection), HasSubstr("(P(correct fix) counts neither)"));
  selection.probability->level_age_months = 11.6;
  EXPECT_THAT(assumptions_line(mission, selection),
              HasSubstr("(P(correct fix) counts the age by a rule of thumb, not the season)"));
}

TEST(ImageryAge, CloudsAreSaidBesideTheVerdict) {
  Mission mission = over_imagery_of("2025-04-01", "2026-03-20");
  mission.flight.ground_hidden = GroundHidden{0.35, "clouds.csv"};
  const auto rows = imagery_age_rows(mission);
  ASSERT_EQ(rows.size(), 2U);
  EXPECT_EQ(rows[1].value, "35 % of the time, by clouds.csv");
  EXPECT_EQ(rows[1].status, QualityStatus::kMarginal);
  EXPECT_THAT(assumptions_line(mission, {}), HasSubstr(", imagery 12 months old, 0 months apart in season, ground in "
                                                       "sight (it is hidden 35 % of the time)"));
  mission.flight.ground_hidden->fraction = 0.1;
  EXPECT_EQ(imagery_age_rows(mission)[1].status, QualityStatus::kGood);
}

}  // namespace
}  // namespace pilotage
