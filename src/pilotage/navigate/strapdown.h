#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "pilotage/camera/attitude.h"
#include "pilotage/geo/geodetic_point.h"

#pragma GCC visibility push(default)

namespace pilotage {

/// What an inertial measurement unit counted over a short time, along body axes (x nose, y right wing, z belly), which
/// turn meanwhile: the integrals of the angular rate against inertial space and of the specific force.
struct ImuIncrement {
  double dt_s = 0;
  Eigen::Vector3d angle_rad = Eigen::Vector3d::Zero();
  Eigen::Vector3d velocity_mps = Eigen::Vector3d::Zero();
};

/// Place, velocity over ground and attitude, along Earth-centred, Earth-fixed axes (geo/ecef.h).
struct InertialState {
  double time_s = 0;
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d velocity_mps = Eigen::Vector3d::Zero();
  Eigen::Quaterniond ecef_from_body = Eigen::Quaterniond::Identity();
};

/// The state `now.dt_s` later: strapdown mechanisation along Earth-fixed axes (P. Groves, Principles of GNSS, Inertial,
/// and Multisensor Integrated Navigation Systems, 2nd ed., 2013, section 5.3) with the two-sample corrections for
/// coning and sculling, for which `before` is the increment that came before, of the same length (zero for the first;
/// P. Savage, "Strapdown inertial navigation integration algorithm design", J. Guidance, Control, and Dynamics 21,
/// 1998). Both without the sensors' errors. docs/methods/navigate.md has the equations and how exact they are.
InertialState advance(const InertialState& state, const ImuIncrement& now, const ImuIncrement& before);

/// Gravity (attraction and centrifugal) at a place: the point mass, J2 and J4 of WGS 84's normal field (Groves,
/// eq. 2.133 and 2.142; J4: O. Montenbruck, E. Gill, Satellite Orbits, 2000, section 3.2); below 1e-6 m/s² of WGS 84's
/// normal gravity at the ellipsoid.
Eigen::Vector3d gravity_mps2(const Eigen::Vector3d& position_m);

/// The Earth's rate of turn about z.
inline constexpr double kEarthRate_radps = 7.292115e-5;

/// A state from what people give: `height_m` above the ellipsoid, the velocity east, north and up.
InertialState inertial_state(double time_s, GeodeticPoint point, double height_m,
                             const Eigen::Vector3d& velocity_enu_mps, const Attitude& attitude);

/// The attitude against north, east, down of the place of the state. Pitch within ±90°.
Attitude attitude_of(const InertialState& state);

}  // namespace pilotage

#pragma GCC visibility pop
