#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <utility>

#include "pilotage/airsim/rpc_value.h"

namespace pilotage {

/// A peer, or the address to listen on.
struct HostPort {
  std::string host;
  int port = 0;

  std::string text() const;  ///< "127.0.0.1:41451", "[::1]:41451".
};

/// "HOST:PORT", "[IPV6]:PORT" or "HOST" with `default_port`. Throws UsageError, naming `what` and the text, when it is
/// none of them or the port is not in [0, 65535].
HostPort parse_host_port(const std::string& what, const std::string& text, int default_port);

/// A file descriptor that closes itself.
class Descriptor {
 public:
  Descriptor() = default;
  explicit Descriptor(int number) : number_(number) {}
  ~Descriptor();
  Descriptor(Descriptor&& other) noexcept : number_(std::exchange(other.number_, -1)) {}
  Descriptor& operator=(Descriptor&& other) noexcept {
    std::swap(number_, other.number_);
    return *this;
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;

  int number() const { return number_; }
  bool is_open() const { return number_ >= 0; }

 private:
  int number_ = -1;
};

using Deadline = std::chrono::steady_clock::time_point;

/// How long something is waited for. `go_on`, where there is one, is asked ten times a second; once it says no,
/// Interrupted is thrown.
struct Wait {
  Wait(Deadline until, std::function<bool()> still = {})
      : deadline(until), go_on(std::move(still)) {}  // NOLINT: a time is one

  Deadline deadline;
  std::function<bool()> go_on;
};

/// Connects by TCP; the descriptor does not block. Throws DataError that names the peer and the system's reason.
/// What stands behind a name is asked of the system, which takes the time that it takes.
Descriptor connect_to(const HostPort& peer, const Wait& wait);

/// Listens; port 0 takes a free one. The descriptor does not block. Throws DataError with the system's reason.
Descriptor listen_on(const HostPort& address);

/// The port that a listening descriptor has.
int port_of(const Descriptor& listener);

/// What became of a transfer.
enum class Transfer { kDone, kClosed, kTimedOut };

/// Sends all of `bytes`.
Transfer send_all(const Descriptor& stream, std::span<const std::uint8_t> bytes, const Wait& wait);

/// Waits for bytes and appends those that are there, at most `most`.
Transfer receive_some(const Descriptor& stream, RpcBytes& buffer, std::size_t most, const Wait& wait);

/// Only this machine reaches the address that a listening descriptor is bound to (127.0.0.0/8, ::1), whatever name it
/// was asked for by.
bool is_loopback(const Descriptor& listener);

}  // namespace pilotage
