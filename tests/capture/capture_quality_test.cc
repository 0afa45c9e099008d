#include "pilotage/capture/capture_quality.h"

#include <algorithm>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace pilotage {
namespace {

using ::testing::HasSubstr;

/// A good map of forty frames, on its positions alone.
CaptureResult good_map() {
  CaptureResult done;
  for (int i = 0; i < 40; ++i) {
    CapturedFrame frame;
    frame.measured_sigma_m = 2;
    frame.sightings = 300;
    done.frames.push_back(frame);
  }
  done.frames_given = 40;
  done.sightings = 11'800;
  done.sightings_found = 12'000;
  done.reprojection_rms_px = 0.4;
  done.given_focal_length_px = 1000;
  done.camera.fx_px = 1010;
  done.position_rms_m = 2.5;
  done.position_ratio = 0.9;
  done.map_sigma_median_m = 5;
  done.seen_by_three = 0.9;
  done.frames_seen_median = 6;
  done.ground_spread_m = 0.2;
  return done;
}

const QualityRow& row_of(const std::vector<QualityRow>& rows, const std::string& name) {
  static const QualityRow kNone;
  const auto found = std::find_if(rows.begin(), rows.end(), [&](const QualityRow& row) { return row.name == name; });
  EXPECT_NE(found, rows.end()) << name;
  return found == rows.end() ? kNone : *found;
}

TEST(CaptureQuality, AGoodMapLacksAPlaceThatIsChecked) {
  for (const QualityRow& row : capture_quality(good_map())) {
    const bool is_place = row.name == "georeference";
    EXPECT_EQ(row.status, is_place ? QualityStatus::kMarginal : QualityStatus::kGood) << row.name << ": " << row.value;
    EXPECT_EQ(row.advice.empty(), !is_place) << row.name;
    EXPECT_FALSE(row.decides) << row.name;
  }
}

TEST(CaptureQuality, EveryRowCanBeMarginalAndBad) {
  struct Case {
    const char* name;
    void (*spoil)(CaptureResult& done, double share);  ///< 0.5: marginal, 1: bad.
  };
  for (const Case& one : {
           Case{"frames", [](CaptureResult&done, double share) { done.frames_given = share < 1 ? 50 : 100; }},
           Case{"sightings",
                [](CaptureResult&done, double share) {
                  for (CapturedFrame& frame : done.frames) frame.sightings = share < 1 ? 60 : 20;
                }},
           Case{"fitting", [](CaptureResult&done, double share) { done.sightings = share < 1 ? 9'600 : 6'600; }},
           Case{"reprojection", [](CaptureResult&done, double share) { done.reprojection_rms_px = 3 * share; }},
           Case{"focal_length", [](CaptureResult&done, double share) { done.camera.fx_px = 1000 - 150 * share; }},
           Case{"positions", [](CaptureResult&done, double share) { done.position_ratio = 4 * share; }},
           Case{"overlap", [](CaptureResult&done, double share) { done.seen_by_three = 1.1 - 0.8 * share; }},
           Case{"relief", [](CaptureResult&done, double share) { done.ground_spread_m = 8 * share; }},
       }) {
    for (const double share : {0.5, 1.0}) {
      CaptureResult done = good_map();
      one.spoil(done, share);
      const auto rows = capture_quality(done);
      const QualityRow& row = row_of(rows, one.name);
      EXPECT_EQ(row.status, share < 1 ? QualityStatus::kMarginal : QualityStatus::kBad)
          << one.name << ": " << row.value;
      EXPECT_NE(row.advice, "") << one.name;
      const auto others = std::count_if(rows.begin(), rows.end(),
                                        [](const QualityRow& other) { return other.status == QualityStatus::kGood; });
      EXPECT_EQ(others, 7) << one.name;
    }
  }
}

TEST(CaptureQuality, FewFramesAndContradictedPositionsAreSaid) {
  CaptureResult done = good_map();
  done.contradicted_positions = 3;
  EXPECT_EQ(row_of(capture_quality(done), "positions").status, QualityStatus::kMarginal);
  EXPECT_THAT(row_of(capture_quality(done), "positions").value, HasSubstr("3 that contradict"));
  done.frames.resize(12);
  EXPECT_EQ(row_of(capture_quality(done), "focal_length").status, QualityStatus::kMarginal);
  EXPECT_THAT(row_of(capture_quality(done), "focal_length").value, HasSubstr("held to 1 %"));
}

TEST(CaptureQuality, ControlPointsAreHeldAgainstTheirMarks) {
  CaptureResult done = good_map();
  done.gsd_m = 0.04;
  done.control_sigma_m = 0.03;  // with a pixel of the map: 0.05
  done.control_points = 5;
  const auto status = [&](double rms_m) {
    done.control_rms_m = rms_m;
    return row_of(capture_quality(done), "control_points").status;
  };
  EXPECT_EQ(status(0.099), QualityStatus::kGood);
  EXPECT_EQ(status(0.12), QualityStatus::kMarginal);
  EXPECT_EQ(status(0.16), QualityStatus::kBad);
  const auto rows = capture_quality(done);
  EXPECT_EQ(row_of(rows, "control_points").value, "0.160 m over 5, 3.2 times what is stated");
  EXPECT_NE(row_of(rows, "control_points").advice, "");
}

TEST(CaptureQuality, PlaceIsGoodOnControlPointsAnotherMapAndChecked) {
  CaptureResult done = good_map();
  done.control_points = 3;
  EXPECT_EQ(row_of(capture_quality(done), "georeference").status, QualityStatus::kMarginal);
  done.control_points = 4;
  EXPECT_EQ(row_of(capture_quality(done), "georeference").status, QualityStatus::kGood);
  done.control_points = 0;
  done.alignment.emplace().ties = 12;
  done.alignment->after.verdict = AuditVerdict::kWithin;
  const auto rows = capture_quality(done);
  EXPECT_EQ(row_of(rows, "georeference").status, QualityStatus::kGood);
  EXPECT_THAT(row_of(rows, "georeference").value,
              HasSubstr("another map (12 ties); one standard deviation 5.00 m, each axis"));
  done.alignment->counted_sigma_m = 10;
  EXPECT_EQ(row_of(capture_quality(done), "georeference").status, QualityStatus::kMarginal);
  done.alignment->counted_sigma_m = 1;
  done.alignment->ties = 1;
  EXPECT_EQ(row_of(capture_quality(done), "georeference").status, QualityStatus::kMarginal);
  done.alignment->ties = 12;
  done.alignment->after.verdict = AuditVerdict::kNotKnown;
  EXPECT_EQ(row_of(capture_quality(done), "georeference").status, QualityStatus::kMarginal);
  done.check_points.resize(3);
  done.check_rms_m = 12;
  done.check_ratio = 2.4;
  const auto checked = capture_quality(done);
  EXPECT_EQ(row_of(checked, "check_points").status, QualityStatus::kMarginal);
  done.check_ratio = std::numeric_limits<double>::quiet_NaN();  // the map says nothing there
  EXPECT_EQ(row_of(capture_quality(done), "check_points").status, QualityStatus::kBad);
  EXPECT_THAT(row_of(checked, "check_points").value, HasSubstr("12.00 m over 3, 2.4 times what the map says"));
}

}  // namespace
}  // namespace pilotage
