// Positions from standard input to an autopilot, as GLOBAL_POSITION_SENSOR over UDP: what a program on board does with
// its fixes, here for simulated autopilots. README.md beside this file says how to run it.
#include <chrono>
#include <cstdio>
#include <iostream>
#include <iterator>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "mavlink_frame.h"
#include <netdb.h>
#include <sys/socket.h>
#include <unistd.h>

namespace {

using mavlink_example::Bytes;

/// A UDP socket that sends to one peer, or -1.
int open_udp(const std::string& host, const std::string& port) {
  addrinfo hints{};
  hints.ai_socktype = SOCK_DGRAM;
  addrinfo* addresses = nullptr;
  if (::getaddrinfo(host.c_str(), port.c_str(), &hints, &addresses) != 0) return -1;
  int stream = -1;
  for (const addrinfo* address = addresses; address != nullptr && stream < 0; address = address->ai_next) {
    stream = ::socket(address->ai_family, SOCK_DGRAM, 0);
    if (stream >= 0 && ::connect(stream, address->ai_addr, address->ai_addrlen) != 0) {
      ::close(stream);
      stream = -1;
    }
  }
  ::freeaddrinfo(addresses);
  return stream;
}

/// One UDP packet for each frame. Nobody who listens is no error: it may come later.
void send_frame(int stream, const Bytes& frame) {
  static_cast<void>(::send(stream, frame.data(), frame.size(), 0));
}

/// A line: longitude, latitude, σ of each axis in metres, height above the ellipsoid or "nan"; or "none".
struct Position {
  pilotage::MatchResult result;
  pilotage::FixAltitude altitude;
};

double number_of(const std::string& word) {
  std::size_t end = 0;
  const double number = std::stod(word, &end);
  if (end != word.size()) throw std::invalid_argument(word);
  return number;
}

std::optional<Position> read_position(const std::string& line) {
  std::istringstream words(line);
  const std::vector<std::string> parts{std::istream_iterator<std::string>(words), {}};
  Position position;
  if (parts.size() == 1 && parts[0] == "none") return position;  // no fix: the sensor lives and knows nothing
  if (parts.size() != 4) return std::nullopt;
  try {
    // In an aircraft match() makes this.
    pilotage::Fix fix;
    fix.position = {number_of(parts[0]), number_of(parts[1])};
    fix.covariance_en_m2 = pilotage::isotropic_covariance_m2(number_of(parts[2]));
    position.result.status = pilotage::MatchStatus::kFix;
    position.result.fix = fix;
    position.altitude.ellipsoid_m = number_of(parts[3]);
    position.altitude.sigma_m = 5;
  } catch (const std::logic_error&) {
    return std::nullopt;
  }
  return position;
}

std::uint64_t now_us() {
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  return static_cast<std::uint64_t>(std::chrono::duration_cast<std::chrono::microseconds>(now).count());
}

int run(int stream) {
  mavlink_example::Sender sender;
  int number = 0;
  for (std::string line; std::getline(std::cin, line);) {
    ++number;
    const std::optional<Position> position = read_position(line);
    if (!position) {
      std::fprintf(stderr, "mavlink_example: line %d is neither LON LAT SIGMA_M ELLIPSOID_M|nan nor none: %s\n", number,
                   line.c_str());
      return 1;
    }
    pilotage::MavlinkSending sending;
    sending.exposure_time_us = sending.sending_time_us = now_us();
    const auto message = pilotage::mavlink_global_position_sensor(position->result, position->altitude, sending);
    send_frame(stream, mavlink_example::heartbeat(sender));
    send_frame(stream, mavlink_example::position_frame(sender, message));
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc == 2 && std::string(argv[1]) == "--check") {
    const std::string digits = "123456789";
    const Bytes bytes(digits.begin(), digits.end());
    std::printf("%04X\n", static_cast<unsigned>(mavlink_example::crc_x25(bytes)));
    return 0;
  }
  if (argc != 3) {
    std::fprintf(stderr, "usage: %s HOST PORT < POSITIONS\n", argv[0]);
    return 2;
  }
  const int stream = open_udp(argv[1], argv[2]);
  if (stream < 0) {
    std::fprintf(stderr, "mavlink_example: %s %s is no place to send to\n", argv[1], argv[2]);
    return 1;
  }
  const int code = run(stream);
  ::close(stream);
  return code;
}
