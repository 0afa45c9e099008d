// The way to an autopilot: UDP, a serial line, or the recording of a flight.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

/// `udp:HOST:PORT` sends there, `udpin:PORT` listens there and answers who spoke last, `serial:DEVICE:BAUD`.
class Link {
 public:
  /// Throws std::runtime_error for a link that is none of these or cannot be opened.
  explicit Link(const std::string& name);
  ~Link();
  Link(const Link&) = delete;
  Link& operator=(const Link&) = delete;

  int descriptor() const { return descriptor_; }
  /// What has come; empty where nothing has.
  std::vector<std::uint8_t> receive();
  /// A serial line whose device went and may be back: tries to open it again. Whether it is open.
  bool mend();
  /// Nobody who listens is no error: it may come later.
  void send(std::span<const std::uint8_t> bytes);

 private:
  void open_udp(const std::string& host, const std::string& port);
  void listen_udp(const std::string& port);
  void open_serial();

  std::string device_, baud_;  ///< Of a serial line.
  int descriptor_ = -1;
  bool listens_ = false;
  std::vector<std::uint8_t> peer_;  ///< Its address, where this side listens.
};
