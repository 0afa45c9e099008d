#pragma once

#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "pilotage/base/options.h"

namespace pilotage {

/// A kind of ring. What flies knows the kinds: colour and size.
struct RingClass {
  std::string_view name;
  double inner_radius_m;
  double tube_radius_m;               ///< Half the thickness of the ring.
  std::array<std::uint8_t, 3> color;  ///< Red, green, blue.
};
inline constexpr std::array<RingClass, 2> kRingClasses = {{
    {"red", 1.2, 0.10, {215, 35, 30}},
    {"blue", 1.5, 0.12, {25, 70, 215}},
}};

/// Where an obstacle stands: east, north, up in metres from the middle of the field, whose ground is at 0.
struct Ring {
  int ring_class = 0;  ///< Index of kRingClasses.
  Eigen::Vector3d center_m = Eigen::Vector3d::Zero();
  double azimuth_deg = 0;  ///< Of the normal, clockwise from north; the normal's sense is that of the course.
  double lean_deg = 0;     ///< Angle of the normal above the horizon.

  const RingClass& kind() const { return kRingClasses[static_cast<std::size_t>(ring_class)]; }
  Eigen::Vector3d normal() const;
};

/// The unit vector of a direction, east, north, up.
Eigen::Vector3d direction(double azimuth_deg, double elevation_deg);

/// The angle from the middle of the field to a place, clockwise from north, 0 … 360. The course is flown by it: every
/// ring once, clockwise, each in the direction that leads clockwise.
double bearing_deg(const Eigen::Vector3d& place_m);

/// What looks like a ring and is none; in the colours of the rings.
enum class DecoyKind {
  kDisc,     ///< Without a hole.
  kSquare,   ///< A frame with four corners.
  kPainted,  ///< A ring on the ground.
};
struct Decoy {
  DecoyKind kind = DecoyKind::kDisc;
  int ring_class = 0;
  Eigen::Vector3d center_m = Eigen::Vector3d::Zero();
  double azimuth_deg = 0;
  double radius_m = 1;
};

struct RingSceneOptions {
  int rings = 6;
  int decoys = 6;
  double course_radius_m = 16;

  template <class Self, class Fields>
  static void describe(Self& self, Fields& fields) {
    fields.field("rings", self.rings, "How many rings stand on the field.", Range{1, 8});
    fields.field("decoys", self.decoys, "How many discs, square frames and rings painted on the ground.", Range{0, 12});
    fields.field("course_radius_m", self.course_radius_m, "Mean distance of the rings from the middle of the field.",
                 Range{12, 20});
  }
};

struct RingScene {
  std::vector<Ring> rings;  ///< By bearing_deg: in the order of the course.
  std::vector<Decoy> decoys;
};

/// Everything is drawn from `seed`. Rings stand around the field, 5 to 8 m high, their normals within 25° of the
/// direction around it; decoys stand inside and outside of the course.
RingScene make_ring_scene(const RingSceneOptions& options, std::uint64_t seed);

}  // namespace pilotage
