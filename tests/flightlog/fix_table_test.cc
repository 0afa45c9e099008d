#include "pilotage/flightlog/fix_table.h"

#include <map>

#include "flightlog/numbered_match.h"
#include "testing/source_folder.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pilotage/base/csv.h"
#include "pilotage/base/output_file.h"

namespace pilotage {
namespace {

using testing::numbered_match;

/// The cells of the only row, by column.
std::map<std::string, std::string> cells_of(const FrameMatch& match, bool timings = true) {
  const std::string text = fix_table_to_csv({&match, 1}, timings);
  CsvReader reader("fixes.csv", text);
  std::vector<std::string> names;
  std::vector<std::string> cells;
  EXPECT_TRUE(reader.next(names));
  EXPECT_TRUE(reader.next(cells));
  EXPECT_EQ(names.size(), cells.size());
  std::map<std::string, std::string> result;
  for (std::size_t i = 0; i < std::min(names.size(), cells.size()); ++i) result[names[i]] = cells[i];
  return result;
}

TEST(FixTable, ColumnsAreThePromisedOnes) {
  EXPECT_EQ(fix_table_to_csv({}),
            "file,time_s,status,reason,lon_deg,lat_deg,east_sigma_m,north_sigma_m,covariance_en_m2,center_lon_deg,"
            "center_lat_deg,center_east_sigma_m,center_north_sigma_m,center_covariance_en_m2,yaw_deg,yaw_sigma_deg,"
            "pitch_deg,roll_deg,height_agl_m,height_sigma_m,scale,tile_id,map_sigma_m,map_index,map_statuses,level,gsd_"
            "m,frame_"
            "features,map_"
            "features,"
            "support,expected_features,vote_peak,vote_rival,inliers,residual_m,ncc,ncc_rival,chip_pixels,agreement,"
            "confidence,"
            "search_half_width_m,landmarks_seen,landmarks_expected,landmarks_matched,confirmed,"
            "error_m,error_east_m,error_north_m,nees,center_error_m,center_nees,candidate_error_m,candidate_center_"
            "error_m,milliseconds\n");
}

TEST(FixTable, EveryCellHoldsItsOwnNumber) {
  auto cells = cells_of(numbered_match());
  const std::map<std::string, std::string> expected{{"file", "a, b.jpg"},
                                                    {"time_s", "12.5"},
                                                    {"status", "fix"},
                                                    {"reason", ""},
                                                    {"lon_deg", "16.1"},
                                                    {"lat_deg", "55.2"},
                                                    {"east_sigma_m", "2"},
                                                    {"north_sigma_m", "3"},
                                                    {"covariance_en_m2", "1.5"},
                                                    {"center_lon_deg", "16.3"},
                                                    {"center_lat_deg", "55.4"},
                                                    {"center_east_sigma_m", "4"},
                                                    {"center_north_sigma_m", "5"},
                                                    {"center_covariance_en_m2", "-2.5"},
                                                    {"yaw_deg", "151.5"},
                                                    {"yaw_sigma_deg", "0.5"},
                                                    {"pitch_deg", "1.25"},
                                                    {"roll_deg", "-0.75"},
                                                    {"height_agl_m", "118.5"},
                                                    {"height_sigma_m", "1.75"},
                                                    {"scale", "0.9875"},
                                                    {"tile_id", "4711"},
                                                    {"map_statuses", "no_map;ambiguous;fix"},
                                                    {"map_index", "2"},
                                                    {"map_sigma_m", "1.125"},
                                                    {"level", "1"},
                                                    {"gsd_m", "0.55"},
                                                    {"frame_features", "1500"},
                                                    {"map_features", "8000"},
                                                    {"support", "128.5"},
                                                    {"expected_features", "640"},
                                                    {"vote_peak", "33.5"},
                                                    {"vote_rival", "7.25"},
                                                    {"inliers", "210"},
                                                    {"residual_m", "0.65"},
                                                    {"ncc", "0.85"},
                                                    {"ncc_rival", "0.45"},
                                                    {"chip_pixels", "320"},
                                                    {"agreement", "4.5"},
                                                    {"confidence", "0.999"},
                                                    {"search_half_width_m", "77.5"},
                                                    {"landmarks_seen", "5"},
                                                    {"landmarks_expected", "4"},
                                                    {"landmarks_matched", "3"},
                                                    {"confirmed", "1"},
                                                    {"error_m", "2.25"},
                                                    {"error_east_m", "1"},
                                                    {"error_north_m", "-2"},
                                                    {"nees", "3.5"},
                                                    {"center_error_m", "0.25"},
                                                    {"center_nees", "1.75"},
                                                    {"candidate_error_m", "2.25"},
                                                    {"candidate_center_error_m", "0.25"},
                                                    {"milliseconds", "21.5"}};
  EXPECT_EQ(cells, expected);
}

TEST(FixTable, ARefusedFrameShowsItsReasonAndHidesItsPlace) {
  FrameMatch match = numbered_match();
  match.result.status = MatchStatus::kAmbiguous;
  match.result.fix.reset();
  match.error.reset();
  match.center_error.reset();
  auto cells = cells_of(match);
  EXPECT_EQ(cells["status"], "ambiguous");
  EXPECT_EQ(cells["reason"], "another place in the window looks as good, or another map says another place");
  for (const char* empty : {"lon_deg", "center_lat_deg", "east_sigma_m", "tile_id", "error_m", "nees"}) {
    EXPECT_EQ(cells[empty], "") << empty;
  }
  EXPECT_EQ(cells["vote_peak"], "33.5");
  EXPECT_EQ(cells["candidate_error_m"], "2.25");
}

TEST(FixTable, AnUnreadableFrameHasNothingButItsReason) {
  FrameMatch match;
  match.frame.file = "x.jpg";
  match.frame.time_s = 1;
  match.problem = "x.jpg: cannot be opened as a raster: \"why\"";
  for (const auto& [name, cell] : cells_of(match)) {
    const std::string expected = name == "file"     ? "x.jpg"
                                 : name == "time_s" ? "1"
                                 : name == "status" ? "unreadable"
                                 : name == "reason" ? match.problem
                                                    : "";
    EXPECT_EQ(cell, expected) << name;
  }
}

TEST(FixTable, WithoutTimingsOnlyThatColumnIsMissing) {
  auto with = cells_of(numbered_match());
  const auto without = cells_of(numbered_match(), false);
  with.erase("milliseconds");
  EXPECT_EQ(without, with);
}

TEST(FixTable, EveryColumnIsSpecified) {
  const std::string page = read_file(testing::source_folder() / "schemas/fixes-csv.md");
  std::size_t place = 0;
  for (const FixColumn& column : fix_columns()) {
    const std::size_t found = page.find("\n| `" + column.name + "` |", place);
    ASSERT_NE(found, std::string::npos) << column.name << " is missing, or stands in another order";
    place = found;
  }
}

}  // namespace
}  // namespace pilotage
