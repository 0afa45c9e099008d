#include "ring_flight.h"

#include "ring_report.h"
#include "testing/temporary_folder.h"
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace pilotage {
namespace {

/// A field that is just large enough, its map, and a flight over it: computed once.
struct SmallFlight {
  testing::TemporaryFolder folder;
  RingField field = make_ring_field({.side_m = 84, .gsd_m = 0.06}, 0);
  std::filesystem::path map = prepare_ring_field(field, down_camera(), kLowest_m, kScanHeight_m, folder / "map", 0);
  RingFlightOptions options = [] {
    RingFlightOptions few;
    few.scene.rings = 3;
    few.scene.decoys = 3;
    few.scan_speed_mps = 7;
    return few;
  }();

  RingFlight fly() const {
    MapReader reader = MapReader::open_unverified(map);
    return fly_rings(field, reader, options, 5);
  }
};

const SmallFlight& small_flight() {
  static const SmallFlight kFlight;
  return kFlight;
}

const RingFlight& flown() {
  static const RingFlight kFlown = small_flight().fly();
  return kFlown;
}

TEST(RingFlight, FindsAllRingsAndNoneThatIsNot) {
  EXPECT_EQ(flown().found, 3);
  EXPECT_EQ(flown().false_rings, 0);
  for (const JudgedRing& judged : flown().array) {
    EXPECT_LT(judged.error_m, 0.3);
    EXPECT_LT(judged.nees, 16.3);  // one in a thousand
    EXPECT_LT(std::abs(judged.azimuth_error_deg), 2);
    EXPECT_LT(std::abs(judged.radius_error_m), 0.1);
    EXPECT_GE(judged.ring.views, 3);
  }
}

TEST(RingFlight, CrossesThemInOrderWithFixesAndNotWithout) {
  const CourseFlight& with = flown().with_fixes;
  EXPECT_TRUE(with.outcome.in_order);
  EXPECT_EQ(with.outcome.crossed, 3);
  EXPECT_EQ(with.outcome.collisions, 0);
  EXPECT_LT(with.end_error_m, 0.5);
  EXPECT_GE(with.fixes.taken, with.fixes.frames / 2);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_GT(with.planned_clearance_m[i], 0);
    EXPECT_GT(with.outcome.crossings[i].clearance_m, with.planned_clearance_m[i] - 0.2);
  }
  const CourseFlight& without = flown().without_fixes;
  EXPECT_EQ(without.fixes.frames, 0);
  EXPECT_FALSE(without.outcome.in_order);
  EXPECT_GT(without.end_error_m, 1.5);
}

TEST(RingFlight, TheSameSeedGivesTheSameBytes) {
  const RingFlight again = small_flight().fly();
  const GeodeticPoint middle = small_flight().field.middle;
  EXPECT_EQ(rings_json({again}, middle).dump(), rings_json({flown()}, middle).dump());
  EXPECT_EQ(rings_svg(again), rings_svg(flown()));
  EXPECT_EQ(rings_text({again}), rings_text({flown()}));
}

TEST(RingScene, IsDrawnFromItsSeed) {
  const RingScene scene = make_ring_scene({}, 1);
  EXPECT_EQ(scene.rings.size(), 6u);
  EXPECT_EQ(scene.decoys.size(), 6u);
  EXPECT_EQ(make_ring_scene({}, 1).rings[3].center_m, scene.rings[3].center_m);
  EXPECT_NE(make_ring_scene({}, 2).rings[3].center_m, scene.rings[3].center_m);
  double before_deg = -1;
  for (const Ring& ring : scene.rings) {
    EXPECT_GT(bearing_deg(ring.center_m), before_deg);
    before_deg = bearing_deg(ring.center_m);
    EXPECT_LT(std::abs(std::remainder(ring.azimuth_deg - bearing_deg(ring.center_m) - 90, 360.0)), 25.001);
  }
}

}  // namespace
}  // namespace pilotage
