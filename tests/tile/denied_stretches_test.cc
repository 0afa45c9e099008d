#include "pilotage/tile/denied_stretches.h"

#include <algorithm>

#include "testing/error_of.h"
#include "testing/temporary_folder.h"
#include "tile/small_mission.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "pilotage/base/error.h"
#include "pilotage/mission/gnss_availability.h"
#include "pilotage/mission/plan_file.h"
#include "pilotage/tile/plan_tiles.h"

namespace pilotage {
namespace {

using ::testing::HasSubstr;
using testing::TemporaryFolder;

// Eastward along the equator from `lon_deg`, a sample every 10 m; a degree is 100 km here.
std::vector<FlightSample> eastward(double length_m, double lon_deg = 0) {
  std::vector<FlightSample> samples;
  for (double at_m = 0; at_m <= length_m; at_m += 10) {
    FlightSample sample;
    sample.distance_m = at_m;
    sample.point = {wrap_lon_deg(lon_deg + at_m / 100'000), 0};
    samples.push_back(sample);
  }
  return samples;
}

GeodeticArea box(double west_deg, double east_deg, double south_deg = -1, double north_deg = 1) {
  return {{{{west_deg, south_deg}, {east_deg, south_deg}, {east_deg, north_deg}, {west_deg, north_deg}}}};
}

std::vector<std::pair<double, double>> pairs(const std::vector<DeniedStretch>& stretches) {
  std::vector<std::pair<double, double>> result;
  for (const DeniedStretch& stretch : stretches) result.emplace_back(stretch.from_distance_m, stretch.to_distance_m);
  return result;
}

using Pairs = std::vector<std::pair<double, double>>;

Pairs read_pairs(const std::vector<std::string>& given, double length_m = 9960) {
  std::vector<std::string> warnings;
  return pairs(read_denial(given, eastward(length_m), warnings).stretches);
}

TEST(ReadDenial, KilometresAlongTheRoute) {
  EXPECT_EQ(read_pairs({"3.2-7.5"}), (Pairs{{3200, 7500}}));
  EXPECT_EQ(read_pairs({"7-8,1–2", "1.5-3"}), (Pairs{{1000, 3000}, {7000, 8000}}));
  EXPECT_EQ(read_pairs({"0-2", "2-4"}), (Pairs{{0, 4000}}));
  EXPECT_EQ(read_pairs({"9-10.0"}), (Pairs{{9000, 9960}})) << "10.0 km is what a page says of 9,960 m";
  EXPECT_EQ(read_pairs({"all"}), Pairs{});
  std::vector<std::string> warnings;
  EXPECT_TRUE(read_denial({"anywhere"}, eastward(100), warnings).anywhere);
  EXPECT_TRUE(read_denial({}, eastward(100), warnings).from_start());
}

TEST(ReadDenial, WrongTextsAreNamedWithWhatIsAllowed) {
  const auto error = [](const std::vector<std::string>& given) {
    return testing::error_of<UsageError>([&] { read_pairs(given); });
  };
  EXPECT_THAT(error({"3.2-12"}), HasSubstr("denied = \"3.2-12\" lies outside the route, which has 0 to 9.96 km"));
  EXPECT_THAT(error({"-1-2"}), HasSubstr("lies outside the route"));
  EXPECT_THAT(error({"5-5"}), HasSubstr("has no length"));
  EXPECT_THAT(error({"7.5-3.2"}), HasSubstr("first end must come before its second"));
  EXPECT_THAT(error({"nan-3"}), HasSubstr("no finite number"));
  EXPECT_THAT(error({"1-inf"}), HasSubstr("no finite number"));
  EXPECT_THAT(error({"zones.geojson"}), HasSubstr("is neither a stretch nor a file that is there; allowed are"));
  EXPECT_THAT(error({""}), HasSubstr("allowed are stretches in km along the route as 3.2-7.5"));
  EXPECT_THAT(error({"1-2,"}), HasSubstr("is neither a stretch"));
  EXPECT_THAT(error({"anywhere", "1-2"}), HasSubstr("it stands alone"));
}

TEST(StretchesInside, EndWhereEdgesAreCrossed) {
  EXPECT_EQ(pairs(stretches_inside(box(0.0105, 0.02003), eastward(9000))), (Pairs{{1050, 2003}}));
  EXPECT_EQ(pairs(stretches_inside(box(-1, 0.001), eastward(9000))), (Pairs{{0, 100}}));
  EXPECT_EQ(pairs(stretches_inside(box(0.01, 0.010012), eastward(9000))), (Pairs{{1000, 1001.2}}))
      << "narrower than the step of samples";
  EXPECT_TRUE(stretches_inside(box(0.01, 0.02, 0.5, 1), eastward(9000)).empty());
  GeodeticArea with_hole = box(0.01, 0.05);
  with_hole.rings.push_back(box(0.02, 0.03).rings[0]);
  EXPECT_EQ(pairs(stretches_inside(with_hole, eastward(9000))), (Pairs{{1000, 2000}, {3000, 5000}}));
}

TEST(StretchesInside, AcrossTheAntimeridian) {
  EXPECT_EQ(pairs(stretches_inside(box(179.99, 180.02), eastward(9000, 179.97))), (Pairs{{2000, 5000}}));
  EXPECT_EQ(pairs(stretches_inside(box(-180.01, -179.98), eastward(9000, 179.97))), (Pairs{{2000, 5000}}));
}

std::string feature(const std::string& geometry) {
  return R"({"type":"Feature","properties":{},"geometry":)" + geometry + "}";
}

std::string box_text(double west_deg, double east_deg) {
  const std::string west = format_number(west_deg);
  const std::string east = format_number(east_deg);
  return R"({"type":"Polygon","coordinates":[[[)" + west + ",-1],[" + east + ",-1],[" + east + ",1],[" + west +
         ",1],[" + west + ",-1]]]}";
}

TEST(ReadDenial, PolygonsOfFiles) {
  const TemporaryFolder folder;
  const std::string geojson = (folder.path() / "zone.geojson").string();
  write_file(geojson, feature(box_text(0.01, 0.02)), true);
  const std::string kml = (folder.path() / "zone.kml").string();
  write_file(kml,
             "<kml xmlns=\"http://www.opengis.net/kml/2.2\"><Document><Placemark><MultiGeometry><Polygon>"
             "<outerBoundaryIs><LinearRing><coordinates>0.03,-1 0.04,-1 0.04,1 0.03,1 0.03,-1</coordinates>"
             "</LinearRing></outerBoundaryIs></Polygon></MultiGeometry></Placemark></Document></kml>",
             true);
  EXPECT_EQ(read_pairs({geojson, "1.9-2.5", kml}), (Pairs{{1000, 2500}, {3000, 4000}}));
  const std::string away = (folder.path() / "away.geojson").string();
  write_file(away, feature(box_text(2, 3)), true);
  std::vector<std::string> warnings;
  const GnssDenial denied = read_denial({away, "1-2"}, eastward(9000), warnings);
  EXPECT_EQ(pairs(denied.stretches), (Pairs{{1000, 2000}}));
  EXPECT_EQ(denied.files, std::vector<std::string>{away});
  ASSERT_EQ(warnings.size(), 1U);
  EXPECT_THAT(warnings[0], HasSubstr("the route enters none of the 1 polygons of " + away));
  EXPECT_THAT(testing::error_of<DataError>([&] { read_pairs({away}); }), HasSubstr("GNSS would never be lost"));
}

TEST(ReadDenial, FilesThatHoldNoPolygon) {
  const TemporaryFolder folder;
  const std::string path = (folder.path() / "zone.geojson").string();
  const auto error = [&](const std::string& text) {
    write_file(path, text, true);
    return testing::error_of<DataError>([&] { read_pairs({path}); });
  };
  EXPECT_THAT(error(feature(R"({"type":"LineString","coordinates":[[0,0],[1,1]]})")),
              HasSubstr(path + ": holds no polygon, but 1 other shapes"));
  EXPECT_THAT(error("not a file of shapes"), HasSubstr("GeoJSON, KML, KMZ, GeoPackage or OpenStreetMap"));
  EXPECT_THAT(error(R"({"type":"Polygon","coordinates":[[[0,0],[1,95],[1,1],[0,0]]]})"),
              HasSubstr("the corner 1, 95 of a polygon is no longitude and latitude"));
  EXPECT_THAT(error("{}"), HasSubstr(path));
}

TEST(PlanFile, KeepsWhereGnssIsDenied) {
  const TemporaryFolder folder;
  TileOptions options = testing::make_small_mission(folder.path(), testing::two_legs());
  const auto plain = plan_to_json(plan_tiles(options));
  EXPECT_FALSE(plain.contains("denied"));
  options.denied = {"all"};
  EXPECT_EQ(plan_to_json(plan_tiles(options)).dump(), plain.dump());
  for (const char* text : {"anywhere", "0.1-0.2,0.3-0.5"}) {
    options.denied = {text};
    const auto json = plan_to_json(plan_tiles(options));
    ASSERT_TRUE(json.contains("denied")) << text;
    EXPECT_EQ(plan_to_json(plan_from_json(json, "plan.json")).dump(), json.dump());
  }
  auto json = plan_to_json(plan_tiles(options));
  json["denied"]["stretches"][1]["from_distance_m"] = 150;
  EXPECT_THAT(testing::error_of<DataError>([&] { plan_from_json(json, "plan.json"); }),
              HasSubstr("150 to 500 m is no stretch behind 200 m"));
}

// Two legs of 400 m and 100 m; two samples stand at the corner.
TEST(GnssAvailability, StepsThatTouchAStretchAreDenied) {
  const TemporaryFolder folder;
  Mission mission = plan_tiles(testing::make_small_mission(folder.path(), testing::two_legs()));
  const std::vector<FlightSample>& samples = mission.flight.samples;
  const auto corner = static_cast<std::size_t>(
      std::find_if(samples.begin(), samples.end(), [](const FlightSample& sample) { return sample.leg == 1; }) -
      samples.begin());
  const double corner_m = samples[corner].distance_m;
  ASSERT_EQ(samples[corner - 1].distance_m, corner_m);
  mission.flight.denied.stretches = {{104, 146}, {corner_m, corner_m + 20}};
  const GnssAvailability gnss = gnss_availability(mission.flight);
  for (std::size_t i = 0; i + 1 < samples.size(); ++i) {
    const double at_m = samples[i].distance_m;
    const double next_m = samples[i + 1].distance_m;
    const bool in_first = at_m < 146 && next_m > 104;
    const bool in_second = i >= corner && at_m < corner_m + 20 && next_m > corner_m;
    EXPECT_EQ(gnss.over_step[i], !in_first && !in_second) << at_m;
    const bool denied = (at_m >= 104 && at_m < 146) || (i >= corner && at_m < corner_m + 20);
    EXPECT_EQ(gnss.at_sample[i], !denied) << at_m;
  }
  EXPECT_TRUE(gnss.at_sample.back());
  const GnssAvailability lost = gnss_lost_at(mission.flight, corner_m);
  EXPECT_TRUE(lost.at_sample[corner - 1]);
  EXPECT_FALSE(lost.at_sample[corner]);
  EXPECT_FALSE(lost.at_sample.back());
}

}  // namespace
}  // namespace pilotage
