#pragma once

#include "pilotage/base/error.h"
#include "pilotage/camera/camera.h"
#include "pilotage/mapdb/key_list.h"
#include "pilotage/mapdb/map_delta.h"
#include "pilotage/mapdb/map_purpose.h"
#include "pilotage/mapdb/map_reader.h"
#include "pilotage/match/confirmation.h"
#include "pilotage/match/fix_altitude.h"
#include "pilotage/match/match.h"
#include "pilotage/match/mavlink_position.h"
#include "pilotage/match/nav_sat_fix.h"
#include "pilotage/match/position_measurement.h"
#include "pilotage/navigate/navigation_filter.h"
#include "pilotage/version.h"

/// @file
/// What a program in the aircraft includes: the map, the camera, the matcher, and the messages for the autopilot.
/// docs/examples/onboard is such a program. Link `pilotage::onboard`.
///
/// @code
/// // Before the flight. What is flown is what the signature (map.gpkg.minisig) is of.
/// cv::setNumThreads(1);                          // see Threads
/// auto map = pilotage::MapReader::open("map.gpkg", {public_key});
/// pilotage::check_purpose(map, {.mission_name = mission, .min_version = highest_flown, .now = now});
///
/// // For each frame: 8-bit gray pixels of the camera's size, and what the navigation filter believes.
/// pilotage::MatchPrior prior;
/// prior.position = {lon_deg, lat_deg};           // WGS 84, longitude first
/// prior.covariance_en_m2 = pilotage::isotropic_covariance_m2(25);
/// prior.height_agl_m = 120;
/// prior.attitude = {yaw_deg, pitch_deg, roll_deg};
/// const pilotage::MatchResult result = pilotage::match(frame, prior, camera, map);
/// if (result.fix) use(result.fix->position, result.fix->covariance_en_m2);
/// else log(pilotage::match_status_name(result.status));
///
/// // For others: both messages say "no fix" themselves when there is none.
/// const pilotage::FixAltitude altitude;          // not known, or altitude_over(*result.fix, …)
/// const auto ros = pilotage::nav_sat_fix(result, altitude, exposure_time_ns, "base_link");
/// const auto mavlink = pilotage::mavlink_global_position_sensor(result, altitude, sending);
/// @endcode
///
/// Order
///  1. MapReader::open() takes a map that a trusted key signed (read_key_lists(): who is trusted now),
///     MapReader::open_unverified() any file that was looked at on the ground (verify_map of pilotage/prep.h).
///     update_map() makes a newer one out of it and a delta.
///     check_purpose(): is it for this mission, recent enough, and still valid? MapReader::info() is what it says of
///     itself, MapReader::levels() its scales.
///  2. Camera is the lens that took the frame. MapReader::camera() is the one the map was planned for; for frames of
///     another size ask camera_for_size(). A map serves any camera whose frames show about as much ground.
///  3. match() with MatchPrior and MatchOptions gives a MatchResult: a MatchStatus, a Fix exactly when the status is
///     kFix, a candidate that is never to be used for navigation by itself, and MatchStats. Of several maps of the
///     ground, such as those of imagery of two dates, it asks each and promises the same. without_prior() is what a
///     filter takes that gave the prior; agrees_with_track() and false_confirmation_rate() judge a candidate by it.
///     NavigationFilter is such a filter: an IMU's increments and fixes, however late, in, place and attitude out.
///  4. nav_sat_fix() gives the fields of ROS's sensor_msgs/NavSatFix, mavlink_global_position_sensor() those of
///     MAVLink's GLOBAL_POSITION_SENSOR. Neither ROS nor MAVLink is needed to build them.
///
/// Errors
///  - MapReader throws IntegrityError: the signature is wrong or of another key, or bytes are not those that were
///    signed, which a large map may find out in flight; DataError: a file that cannot be read, is damaged, or of
///    another version; UsageError: no key, or one that cannot be read. check_purpose() throws IntegrityError.
///  - MapReader::tiles_near() throws UsageError for a point that is not on Earth.
///  - match() throws nothing but Interrupted, when it is asked to end. Bad pixels, priors, cameras and options have a
///    status each, and so have a map that is damaged under way and memory that runs out. The messages throw nothing but
///    std::bad_alloc.
///
/// Bounds
///  - MatchOptions::deadline_ms bounds the time of match() (kOutOfTime), MatchOptions::max_memory_mib its memory
///    (kTooUncertain). A wide prior takes longer than a narrow one; docs/benchmarks.md has figures.
///
/// Threads
///  - One MapReader serves one thread at a time, and keeps lately used tiles decoded (open() bounds how many
///    bytes); open one for each thread, on the same file or SignedMap. match() has no other
///    state, starts no threads of its own, and gives the same answer to the last bit whatever runs beside it.
///  - OpenCV, below it, may share one picture out among all cores. The answer does not depend on that. A program whose
///    cores have other work turns it off with cv::setNumThreads(1), which holds for the process and is therefore the
///    program's to call; the library never does.
///
/// Units stand in names: `_m`, `_px`, `_deg`. Points are WGS 84 with the longitude first, yaw is clockwise from north,
/// the centre of the first pixel is (0.5, 0.5). The version of the library is PILOTAGE_VERSION (pilotage/version.h).
