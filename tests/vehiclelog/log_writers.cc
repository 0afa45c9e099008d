#include "vehiclelog/log_writers.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace pilotage {
namespace {

constexpr double kLat_deg = 55.5;
double lon_deg_at(int second) {
  return 16.5 + 1e-4 * second;
}

std::string damaged(std::string log) {
  log[log.size() / 2] = static_cast<char>(log[log.size() / 2] ^ 0x5A);
  return log;
}

std::string cut(const std::string& log) {
  return log.substr(0, log.size() - 7);
}

std::string big_endian_time(double time_s) {
  std::string text = LogText().u(static_cast<std::uint64_t>(std::llround(time_s * 1e6)), 8).str();
  std::reverse(text.begin(), text.end());
  return text;
}

}  // namespace

LogText ulog_attitude_record(double time_s, double yaw_deg) {
  const double half_rad = yaw_deg * std::numbers::pi / 360;
  return ulog_time(time_s).f(std::cos(half_rad)).f(0).f(0).f(std::sin(half_rad));
}

std::string small_ulog() {
  std::string log = ulog_head() + ulog_flags(0) + ulog_format(kAttitudeFormat) + ulog_format(kPositionFormat) +
                    ulog_format("camera_capture:uint64_t timestamp;uint32_t seq;float ground_distance;int8_t result;") +
                    ulog_stream(0, "vehicle_attitude") + ulog_stream(1, "vehicle_global_position") +
                    ulog_stream(2, "camera_capture");
  for (int second = 1; second <= 10; ++second) {
    log += ulog_record(0, ulog_attitude_record(second, 90));
    log += ulog_record(1, ulog_time(second).d(kLat_deg).d(lon_deg_at(second)).f(220));
    if (second % 2 == 0) log += ulog_record(2, ulog_time(second + 0.5).u(second / 2, 4).f(120).i(1, 1));
    log += ulog_sync();
  }
  return log;
}

std::string dataflash_format(unsigned id, std::string_view name, std::string_view letters, std::string_view labels) {
  static const std::map<char, unsigned> kSizes{{'a', 64}, {'b', 1}, {'B', 1}, {'h', 2}, {'H', 2},  {'i', 4},  {'I', 4},
                                               {'f', 4},  {'d', 8}, {'g', 2}, {'n', 4}, {'N', 16}, {'Z', 64}, {'c', 2},
                                               {'C', 2},  {'e', 4}, {'E', 4}, {'L', 4}, {'M', 1},  {'q', 8},  {'Q', 8}};
  unsigned size = 3;
  for (const char letter : letters) size += kSizes.at(letter);
  return dataflash_record(128, LogText().u(id, 1).u(size, 1).text(name, 4).text(letters, 16).text(labels, 64));
}

std::string small_dataflash() {
  std::string log =
      dataflash_format(128, "FMT", "BBnNZ", "Type,Length,Name,Format,Columns") +
      dataflash_format(10, "ATT", "QccccCC", "TimeUS,DesRoll,Roll,DesPitch,Pitch,DesYaw,Yaw") +
      dataflash_format(11, "POS", "QLLf", "TimeUS,Lat,Lng,Alt") +
      dataflash_format(12, "CAM", "QBHIHLLeeefff", "TimeUS,I,Img,GPSTime,GPSWeek,Lat,Lng,Alt,RelAlt,GPSAlt,R,P,Y");
  for (int second = 1; second <= 10; ++second) {
    const auto time_us = static_cast<std::uint64_t>(second) * 1000000;
    const auto lat = static_cast<std::int64_t>(std::llround(kLat_deg * 1e7));
    const auto lon = static_cast<std::int64_t>(std::llround(lon_deg_at(second) * 1e7));
    log += dataflash_record(10, LogText().u(time_us, 8).i(0, 2).i(-150, 2).i(0, 2).i(200, 2).u(0, 2).u(9000, 2));
    log += dataflash_record(11, LogText().u(time_us, 8).i(lat, 4).i(lon, 4).f(220));
    if (second % 2 != 0) continue;
    log += dataflash_record(12, LogText()
                                    .u(time_us + 500000, 8)
                                    .u(0, 1)
                                    .u(second / 2, 2)
                                    .u(1000, 4)
                                    .u(2300, 2)
                                    .i(lat, 4)
                                    .i(lon, 4)
                                    .i(22000, 4)
                                    .i(12000, 4)
                                    .i(22000, 4)
                                    .f(-1.5)
                                    .f(2)
                                    .f(90));
  }
  return log;
}

std::string telemetry_record(int version, double time_s, std::uint32_t id, std::string payload, std::uint8_t extra,
                             std::uint8_t system, std::uint8_t component) {
  LogText frame;
  if (version == 1) {
    frame.u(payload.size(), 1).u(7, 1).u(system, 1).u(component, 1).u(id, 1);
  } else {
    while (payload.size() > 1 && payload.back() == '\0') payload.pop_back();
    frame.u(payload.size(), 1).u(0, 2).u(7, 1).u(system, 1).u(component, 1).u(id, 3);
  }
  frame.text(payload);
  const char last = static_cast<char>(extra);
  const std::uint16_t crc = mavlink_crc({&last, 1}, mavlink_crc(frame.str()));
  return big_endian_time(time_s) + (version == 1 ? "\xFE" : "\xFD") + frame.str() + LogText().u(crc, 2).str();
}

std::string small_telemetry() {
  std::string log;
  for (int second = 1; second <= 10; ++second) {
    const int version = 1 + second % 2;
    const double time_s = 1.7e9 + second;
    const auto lat = static_cast<std::int64_t>(std::llround(kLat_deg * 1e7));
    const auto lon = static_cast<std::int64_t>(std::llround(lon_deg_at(second) * 1e7));
    log += telemetry_record(version, time_s, 30,
                            LogText().u(1000, 4).f(-0.1).f(0.2).f(std::numbers::pi / 2).f(0).f(0).f(0).str(), 39);
    log += telemetry_record(
        version, time_s, 33,
        LogText().u(1000, 4).i(lat, 4).i(lon, 4).i(220000, 4).i(120000, 4).i(0, 2).i(630, 2).i(-10, 2).u(9000, 2).str(),
        104);
    log += telemetry_record(version, time_s, 0, LogText().u(4, 4).u(2, 1).u(3, 1).u(81, 1).u(4, 1).u(3, 1).str(), 50);
    if (second % 2 == 0) {
      log += telemetry_record(version, time_s + 0.5, 112, LogText().u(1, 8).u(second / 2, 4).str(), 174);
    }
  }
  return log;
}

std::string small_airsim() {
  std::string log = "VehicleName\tTimeStamp\tPOS_X\tPOS_Y\tPOS_Z\tQ_W\tQ_X\tQ_Y\tQ_Z\tImageFile\n";
  for (int second = 1; second <= 10; ++second) {
    log += "Drone1\t" + std::to_string(1700000000000 + second * 1000) + "\t0\t" + std::to_string(6.3 * second) +
           "\t-120\t0.7071068\t0\t0\t0.7071068\timg_Drone1_3_0_" + std::to_string(second) + ".png\n";
  }
  return log;
}

std::map<std::string, std::string> fuzz_corpus(const std::string& reader) {
  std::map<std::string, std::string> files;
  const auto add = [&](const std::string& log, const std::string& suffix) {
    files["whole" + suffix] = log;
    files["cut_short" + suffix] = cut(log);
    files["changed_byte" + suffix] = damaged(log);
  };
  if (reader == "ulog") {
    add(small_ulog(), ".ulg");
    files["format_inside_itself.ulg"] = ulog_head() + ulog_format("a:b x;uint64_t timestamp;") +
                                        ulog_format("b:a[9] x;") + ulog_stream(0, "a") +
                                        ulog_record(0, ulog_time(1).d(55).d(16));
    const std::string before = ulog_head() + ulog_flags(0);
    files["appended.ulg"] = ulog_head() + ulog_flags(before.size() + 3) + "cut" + small_ulog().substr(before.size());
  }
  if (reader == "dataflash") add(small_dataflash(), ".bin");
  if (reader == "telemetry") add(small_telemetry(), ".tlog");
  if (reader == "airsim_recording") add(small_airsim(), ".txt");
  return files;
}

}  // namespace pilotage
