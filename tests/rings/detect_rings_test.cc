#include "detect_rings.h"

#include <cmath>

#include "ring_field.h"
#include "rings/ring_views.h"
#include <gtest/gtest.h>

namespace pilotage {
namespace {

using testing::circle_of;
using testing::gray_ground;
using testing::looking;
using testing::pixel_of;

cv::Mat seen(const RingScene& scene, const CameraPose& pose) {
  return rasterise(mesh_of(scene), gray_ground(), forward_camera(), pose).rgb;
}

double distance_px(const SeenRing& ring, const Eigen::Vector2d& pixel) {
  const Eigen::Vector2d d = pixel - ring.center_px;
  const double along = std::cos(ring.angle_rad) * d.x() + std::sin(ring.angle_rad) * d.y();
  const double across = std::cos(ring.angle_rad) * d.y() - std::sin(ring.angle_rad) * d.x();
  const double share = std::hypot(along / ring.major_px, across / ring.minor_px);
  return std::abs(share - 1) * d.norm();
}

// Near and far, from ahead and from the side, either kind.
TEST(DetectRings, TheEllipseIsThatOfTheProjectedCircle) {
  for (int ring_class = 0; ring_class < 2; ++ring_class) {
    for (const double azimuth_deg : {0.0, 35.0, -60.0}) {
      for (const double range_m : {6.0, 15.0, 28.0}) {
        const Ring ring{ring_class, {1, 2, 6}, azimuth_deg, 3};
        const CameraPose pose = looking({1.5, 2 - range_m, 9}, {1.2, 2, 5});
        const std::vector<SeenRing> rings = detect_rings(seen({{ring}, {}}, pose));
        ASSERT_EQ(rings.size(), 1u) << azimuth_deg << " " << range_m;
        EXPECT_EQ(rings[0].ring_class, ring_class);
        for (const Eigen::Vector3d& point : circle_of(ring, 24)) {
          EXPECT_LT(distance_px(rings[0], pixel_of(point, forward_camera(), pose)), 0.25 + 0.012 * rings[0].major_px)
              << azimuth_deg << " " << range_m;
        }
        const double share = ring.kind().inner_radius_m / (ring.kind().inner_radius_m + 2 * ring.kind().tube_radius_m);
        EXPECT_NEAR(rings[0].inner_share, share, 0.01 + 1.2 / rings[0].major_px);
      }
    }
  }
}

TEST(DetectRings, DiscsAndSquaresAreNone) {
  for (const DecoyKind kind : {DecoyKind::kDisc, DecoyKind::kSquare}) {
    for (const double azimuth_deg : {0.0, 30.0}) {
      DetectionCounts counts;
      const RingScene scene{{}, {{kind, 0, {0, 0, 4}, azimuth_deg, 1.1}}};
      EXPECT_TRUE(detect_rings(seen(scene, looking({0, -12, 6}, {0, 0, 4})), &counts).empty());
      EXPECT_EQ(counts.patches, 1);
      EXPECT_EQ(kind == DecoyKind::kDisc ? counts.no_hole : counts.no_ellipse, 1);
    }
  }
}

TEST(DetectRings, ARingThatIsHiddenOrCutInPartIsNotReported) {
  const Ring ring{0, {0, 0, 6}, 0, 0};
  const CameraPose pose = looking({0, -12, 6}, {0, 0, 6});
  RingScene scene{{ring}, {}};
  EXPECT_EQ(detect_rings(seen(scene, pose)).size(), 1u);
  scene.decoys.push_back({DecoyKind::kDisc, 1, {1, -2, 6}, 0, 0.6});
  EXPECT_TRUE(detect_rings(seen(scene, pose)).empty());
  DetectionCounts counts;
  EXPECT_TRUE(detect_rings(seen({{ring}, {}}, looking({0, -12, 6}, {9.2, 0, 6})), &counts).empty());
  EXPECT_EQ(counts.cut + counts.no_hole, 1);
}

}  // namespace
}  // namespace pilotage
