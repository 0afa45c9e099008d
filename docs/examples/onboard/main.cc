// One frame in, one fix out, as a program on board would do it: a map, a raw gray frame, what the navigation filter
// believes, and the messages for ROS and MAVLink on standard output. README.md beside this file says how to run it.
#include <array>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include <opencv2/core.hpp>
#include <pilotage/onboard.h>

namespace {

using Clock = std::chrono::system_clock;

// A binary PGM with 8 bits: "P5", width, height, 255, one blank, the pixels. A camera driver hands over the same bytes.
cv::Mat read_pgm(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::string magic;
  int width = 0;
  int height = 0;
  int white = 0;
  file >> magic >> width >> height >> white;
  if (!file || magic != "P5" || white != 255 || width < 1 || height < 1 || width > 32766 || height > 32766) {
    throw std::runtime_error(path + ": not a binary PGM with 8 bits");
  }
  file.get();
  cv::Mat frame(height, width, CV_8UC1);
  file.read(reinterpret_cast<char*>(frame.data), static_cast<std::streamsize>(frame.total()));
  if (!file) throw std::runtime_error(path + ": ends before its last pixel");
  return frame;
}

// Without exceptions for what a sensor may deliver: match() has a status for everything.
int print(const pilotage::MatchResult& result, const pilotage::FixAltitude& altitude, Clock::time_point exposure) {
  const auto since_1970 = exposure.time_since_epoch();
  const auto exposure_us = std::chrono::duration_cast<std::chrono::microseconds>(since_1970).count();
  const auto now_us = std::chrono::duration_cast<std::chrono::microseconds>(Clock::now().time_since_epoch()).count();

  const auto ros = pilotage::nav_sat_fix(
      result, altitude, std::chrono::duration_cast<std::chrono::nanoseconds>(since_1970).count(), "base_link");
  std::printf("NavSatFix status %d latitude %.8f longitude %.8f altitude %.2f covariance_type %d covariance",
              ros.status, ros.latitude, ros.longitude, ros.altitude, ros.position_covariance_type);
  for (const double variance : ros.position_covariance) std::printf(" %.3f", variance);

  pilotage::MavlinkSending sending;
  sending.exposure_time_us = static_cast<std::uint64_t>(exposure_us);
  sending.sending_time_us = static_cast<std::uint64_t>(now_us);
  const auto mavlink = pilotage::mavlink_global_position_sensor(result, altitude, sending);
  std::printf("\nGLOBAL_POSITION_SENSOR source %d flags %d lat %d lon %d alt_ellipsoid %.2f eph %.2f epv %.2f\n",
              static_cast<int>(mavlink.source), mavlink.flags, mavlink.lat, mavlink.lon,
              static_cast<double>(mavlink.alt_ellipsoid), static_cast<double>(mavlink.eph),
              static_cast<double>(mavlink.epv));
  std::printf("%s: %s (%d inliers, confidence %.5f)\n", std::string(match_status_name(result.status)).c_str(),
              std::string(match_status_text(result.status)).c_str(), result.stats.inliers, result.stats.confidence);
  return result.fix ? 0 : 3;
}

// What a navigation filter makes of a fix. In an aircraft it is made where GNSS is lost, advances with every increment
// of the IMU, and gives the prior itself: match_prior(). Here it begins at the prior, and stands.
void navigate(pilotage::MapReader& map, const pilotage::MatchPrior& prior, const pilotage::Fix& fix) {
  pilotage::InsOptions ins;
  ins.name = "VN-100";
  pilotage::InsErrorModel model = pilotage::make_ins_error_model(ins);
  model.start_sigma_m = pilotage::largest_sigma_m(prior.covariance_en_m2);
  pilotage::NavigationOptions options;
  if (const auto map_sigma_m = map.largest_map_sigma_m()) {  // a captured map: off everywhere alike
    options.map_sigma_m = *map_sigma_m;
    options.map_correlation_m = 1e6;
  }
  pilotage::NavigationFilter filter(
      model, options, pilotage::inertial_state(0, prior.position, prior.height_agl_m, {0, 0, 0}, prior.attitude));
  const pilotage::FrameNumber frame = filter.take_frame();
  filter.advance({0.01, {0, 0, 0}, {0, 0, -0.0981}});  // time goes on while match() works
  const auto update = filter.take_fix(frame, pilotage::without_prior(fix, prior));
  const auto estimate = filter.estimate();
  std::printf("navigation: %s, latitude %.8f longitude %.8f sigma %.1f m\n",
              update.outcome == pilotage::FixOutcome::kTaken ? "fix taken" : "fix refused", estimate.position.lat_deg,
              estimate.position.lon_deg, pilotage::largest_sigma_m(estimate.covariance_en_m2));
}

// Once, before the flight: the map. With a public key, or a key list and the root key that signed it, only one whose
// signature holds, and that is valid now. An aircraft without a clock that it may trust leaves `now` out; one that
// keeps the highest version that it has flown asks for MapRequirements::min_version and
// KeyListRequirements::min_version.
pilotage::MapReader open_map(const std::vector<std::string>& arguments) {
  if (arguments.size() == 10) return pilotage::MapReader::open_unverified(arguments[0]);
  const auto now = std::chrono::floor<std::chrono::seconds>(Clock::now());
  std::vector<std::string> keys = {arguments[10]};
  if (arguments.size() == 12)
    keys = pilotage::read_key_lists({arguments[10]}, {arguments[11]}, {1, now}).trusted_keys();
  pilotage::MapReader map = pilotage::MapReader::open(arguments[0], keys);
  pilotage::MapRequirements required;
  required.now = now;
  pilotage::check_purpose(map, required);
  return map;
}

// On the ground, when a delta has arrived: the new map beside the old one, which stays. Nothing is written unless delta
// and map are signed by the key, and the map is of the same mission, valid now, and later than the one before.
int update(const std::vector<std::string>& arguments) {
  pilotage::MapUpdateOptions options;
  options.overwrite = true;
  if (arguments.size() == 5) options.trusted_keys = {arguments[4]};
  options.required.now = std::chrono::floor<std::chrono::seconds>(Clock::now());
  const pilotage::MapUpdate made = pilotage::update_map(arguments[1], arguments[2], arguments[3], options);
  std::printf("%s: %llu bytes, %s\n", arguments[3].c_str(), static_cast<unsigned long long>(made.bytes),
              made.signature ? ("signed by " + made.signature->key_id).c_str() : "whose it is was not checked");
  return 0;
}

int run(const std::vector<std::string>& arguments) {
  std::array<double, 8> numbers{};
  for (std::size_t i = 0; i < numbers.size(); ++i) numbers[i] = std::stod(arguments[i + 2]);
  const auto [lon_deg, lat_deg, sigma_m, height_agl_m, yaw_deg, pitch_deg, roll_deg, ground_ellipsoid_m] = numbers;

  // Once, before the flight: the map, and the camera that it was prepared for, with as many pixels as its frames have.
  pilotage::MapReader map = open_map(arguments);
  if (!map.camera()) throw std::runtime_error(arguments[0] + ": does not say for which camera it was prepared");
  const cv::Mat frame = read_pgm(arguments[1]);
  const pilotage::Camera camera = pilotage::camera_for_size(arguments[1], *map.camera(), frame.cols, frame.rows);

  // For each frame:
  const Clock::time_point exposure = Clock::now();

  pilotage::MatchPrior prior;
  prior.position = {lon_deg, lat_deg};
  prior.covariance_en_m2 = pilotage::isotropic_covariance_m2(sigma_m);
  prior.height_agl_m = height_agl_m;
  prior.attitude = {yaw_deg, pitch_deg, roll_deg};
  const pilotage::MatchResult result = pilotage::match(frame, prior, camera, map);

  pilotage::FixAltitude altitude;
  if (result.fix) {
    const double not_known = std::numeric_limits<double>::quiet_NaN();
    altitude = pilotage::altitude_over(*result.fix, ground_ellipsoid_m, not_known, 5);
  }
  const int code = print(result, altitude, exposure);
  if (result.fix) navigate(map, prior, *result.fix);
  return code;
}

}  // namespace

int main(int argc, char** argv) {
  const std::vector<std::string> arguments(argv + 1, argv + argc);
  const bool updates = !arguments.empty() && arguments[0] == "--update";
  if (updates ? arguments.size() < 4 || arguments.size() > 5 : arguments.size() < 10 || arguments.size() > 12) {
    std::fprintf(stderr,
                 "usage: %s MAP.gpkg FRAME.pgm LON_DEG LAT_DEG SIGMA_M HEIGHT_AGL_M YAW_DEG PITCH_DEG ROLL_DEG "
                 "GROUND_ELLIPSOID_M|nan [PUBLIC_KEY | KEY_LIST ROOT_KEY]\n"
                 "       %s --update OLD.gpkg NEW.gpkg.delta NEW.gpkg [PUBLIC_KEY]\n",
                 argv[0], argv[0]);
    return 2;
  }
  try {
    return updates ? update(arguments) : run(arguments);
  } catch (const std::exception& error) {  // a file that cannot be read, a number that is none
    std::fprintf(stderr, "onboard_example: %s\n", error.what());
    return 1;
  }
}
