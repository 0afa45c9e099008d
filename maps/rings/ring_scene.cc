#include "ring_scene.h"

#include <algorithm>
#include <cmath>

#include "pilotage/base/angle.h"
#include "pilotage/base/random.h"

namespace pilotage {
namespace {

Eigen::Vector3d place_at(double bearing, double radius_m, double height_m) {
  return radius_m * direction(bearing, 0) + height_m * Eigen::Vector3d::UnitZ();
}

Ring draw_ring(double bearing, double course_radius_m, Random& random) {
  Ring ring;
  ring.ring_class = static_cast<int>(random.below(kRingClasses.size()));
  ring.center_m = place_at(bearing, course_radius_m * random.uniform(0.85, 1.15), random.uniform(5, 8));
  ring.azimuth_deg = bearing + 90 + random.uniform(-25, 25);
  ring.lean_deg = 2 * random.normal();
  return ring;
}

/// Beside the course: one in three outside of it.
Decoy draw_decoy(int number, double course_radius_m, Random& random) {
  Decoy decoy;
  decoy.kind = static_cast<DecoyKind>(number % 3);
  decoy.ring_class = static_cast<int>(random.below(kRingClasses.size()));
  decoy.radius_m = kRingClasses[static_cast<std::size_t>(decoy.ring_class)].inner_radius_m * random.uniform(0.8, 1.2);
  const bool outside = random.uniform() < 1.0 / 3;
  const double radius_m = outside ? course_radius_m + random.uniform(7, 9) : random.uniform(2, course_radius_m - 8);
  const double height_m = decoy.kind == DecoyKind::kPainted ? 0 : random.uniform(2.5, 5);
  decoy.center_m = place_at(random.uniform(0, 360), radius_m, height_m);
  decoy.azimuth_deg = random.uniform(0, 360);
  return decoy;
}

}  // namespace

Eigen::Vector3d direction(double azimuth_deg, double elevation_deg) {
  const double azimuth = azimuth_deg * kRadPerDeg;
  const double elevation = elevation_deg * kRadPerDeg;
  return {std::cos(elevation) * std::sin(azimuth), std::cos(elevation) * std::cos(azimuth), std::sin(elevation)};
}

Eigen::Vector3d Ring::normal() const {
  return direction(azimuth_deg, lean_deg);
}

double bearing_deg(const Eigen::Vector3d& place_m) {
  const double angle = std::atan2(place_m.x(), place_m.y()) / kRadPerDeg;
  return angle < 0 ? angle + 360 : angle;
}

RingScene make_ring_scene(const RingSceneOptions& options, std::uint64_t seed) {
  check_options(options);
  Random random(derive_seed(seed, seed_from_name("ring scene")));
  RingScene scene;
  const double apart_deg = 360.0 / options.rings;
  const double first_deg = random.uniform(0, apart_deg);
  for (int i = 0; i < options.rings; ++i) {
    const double bearing = first_deg + (i + random.uniform(-0.15, 0.15)) * apart_deg;
    scene.rings.push_back(draw_ring(bearing, options.course_radius_m, random));
  }
  std::sort(scene.rings.begin(), scene.rings.end(),
            [](const Ring& a, const Ring& b) { return bearing_deg(a.center_m) < bearing_deg(b.center_m); });
  for (int tries = 0; static_cast<int>(scene.decoys.size()) < options.decoys && tries < 1000; ++tries) {
    const Decoy decoy = draw_decoy(static_cast<int>(scene.decoys.size()), options.course_radius_m, random);
    const bool free = std::none_of(scene.decoys.begin(), scene.decoys.end(), [&](const Decoy& other) {
      return (decoy.center_m - other.center_m).head<2>().norm() < 3.5;
    });
    if (free) scene.decoys.push_back(decoy);
  }
  return scene;
}

}  // namespace pilotage
