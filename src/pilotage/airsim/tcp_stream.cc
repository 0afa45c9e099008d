#include "pilotage/airsim/tcp_stream.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <memory>
#include <optional>

#include <fcntl.h>
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include "pilotage/base/error.h"
#include "pilotage/base/progress.h"
#include "pilotage/base/text.h"

namespace pilotage {
namespace {

constexpr int kQueuedConnections = 64;

sockaddr_storage address_of(const Descriptor& listener) {
  sockaddr_storage address{};
  socklen_t size = sizeof(address);
  ::getsockname(listener.number(), reinterpret_cast<sockaddr*>(&address), &size);
  return address;
}

std::string reason(int error_number) {
  return std::strerror(error_number);  // NOLINT(concurrency-mt-unsafe)
}

struct FreeAddresses {
  void operator()(addrinfo* list) const { ::freeaddrinfo(list); }
};
using Addresses = std::unique_ptr<addrinfo, FreeAddresses>;

Addresses addresses_of(const HostPort& peer, bool listening) {
  addrinfo hints{};
  hints.ai_family = AF_UNSPEC;
  hints.ai_socktype = SOCK_STREAM;
  hints.ai_flags = AI_NUMERICSERV | (listening ? AI_PASSIVE : 0);
  addrinfo* list = nullptr;
  const int failed = ::getaddrinfo(peer.host.c_str(), std::to_string(peer.port).c_str(), &hints, &list);
  if (failed != 0) throw DataError(peer.text() + ": " + ::gai_strerror(failed));
  return Addresses(list);
}

Descriptor open_socket(const addrinfo& address) {
  Descriptor socket(::socket(address.ai_family, address.ai_socktype | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
  const int on = 1;
  if (socket.is_open()) ::setsockopt(socket.number(), IPPROTO_TCP, TCP_NODELAY, &on, sizeof(on));
  return socket;
}

/// Until the descriptor is ready for `events` or the deadline has passed.
bool wait_until_ready(const Descriptor& stream, short events, const Wait& wait) {
  constexpr long long kAskMs = 100;
  while (true) {
    if (wait.go_on && !wait.go_on()) throw Interrupted{};
    const auto left =
        std::chrono::duration_cast<std::chrono::milliseconds>(wait.deadline - std::chrono::steady_clock::now()).count();
    if (left < 0) return false;
    pollfd watched{stream.number(), events, 0};
    const int ready = ::poll(&watched, 1, static_cast<int>(std::min<long long>(left + 1, kAskMs)));
    if (ready > 0) return true;
    if (ready < 0 && errno != EINTR) return true;  // the transfer itself says what is wrong
  }
}

bool would_block(int error_number) {
  return error_number == EAGAIN || error_number == EWOULDBLOCK || error_number == EINTR;
}

/// Nothing when connected, or why not.
std::optional<std::string> connect_one(const Descriptor& socket, const addrinfo& address, const Wait& wait) {
  if (!socket.is_open()) return reason(errno);
  if (::connect(socket.number(), address.ai_addr, address.ai_addrlen) == 0) return std::nullopt;
  if (errno != EINPROGRESS && errno != EINTR) return reason(errno);
  if (!wait_until_ready(socket, POLLOUT, wait)) return "no connection in the time that is given";
  int failed = 0;
  socklen_t size = sizeof(failed);
  ::getsockopt(socket.number(), SOL_SOCKET, SO_ERROR, &failed, &size);
  if (failed != 0) return reason(failed);
  return std::nullopt;
}

}  // namespace

std::string HostPort::text() const {
  const bool is_ipv6 = host.find(':') != std::string::npos;
  return (is_ipv6 ? "[" + host + "]" : host) + ":" + std::to_string(port);
}

HostPort parse_host_port(const std::string& what, const std::string& text, int default_port) {
  const auto refuse = [&]() -> UsageError {
    return UsageError(what + " = \"" + text +
                      "\" is not HOST:PORT with a port in [0, 65535], like 127.0.0.1:" + std::to_string(default_port));
  };
  HostPort result{text, default_port};
  const bool bracketed = text.starts_with("[");
  const std::size_t end = bracketed ? text.find(']') : std::string::npos;
  if (bracketed && end == std::string::npos) throw refuse();
  const std::size_t colon = bracketed ? end + 1 : text.find(':');
  if (bracketed && colon < text.size() && text[colon] != ':') throw refuse();
  if (colon < text.size()) {
    const std::string port_text = text.substr(colon + 1);
    const std::optional<double> port = parse_number(port_text);
    const bool digits = port_text.find_first_not_of("0123456789") == std::string::npos;
    if (!port || !digits || *port > 65535) throw refuse();
    result.port = static_cast<int>(*port);
    result.host = text.substr(0, colon);
  }
  if (bracketed) result.host = text.substr(1, end - 1);
  if (result.host.empty()) throw refuse();
  return result;
}

Descriptor::~Descriptor() {
  if (number_ >= 0) ::close(number_);
}

Descriptor connect_to(const HostPort& peer, const Wait& wait) {
  const Addresses list = addresses_of(peer, false);
  std::string why = "has no address";
  for (const addrinfo* address = list.get(); address != nullptr; address = address->ai_next) {
    Descriptor socket = open_socket(*address);
    const std::optional<std::string> problem = connect_one(socket, *address, wait);
    if (!problem) return socket;
    why = *problem;
  }
  throw DataError(peer.text() + ": " + why);
}

Descriptor listen_on(const HostPort& address) {
  const Addresses list = addresses_of(address, true);
  Descriptor socket = open_socket(*list);
  const int on = 1;
  if (!socket.is_open() || ::setsockopt(socket.number(), SOL_SOCKET, SO_REUSEADDR, &on, sizeof(on)) != 0 ||
      ::bind(socket.number(), list->ai_addr, list->ai_addrlen) != 0 ||
      ::listen(socket.number(), kQueuedConnections) != 0) {
    throw DataError(address.text() + ": " + reason(errno));
  }
  return socket;
}

int port_of(const Descriptor& listener) {
  const sockaddr_storage address = address_of(listener);
  if (address.ss_family == AF_INET6) return ntohs(reinterpret_cast<const sockaddr_in6&>(address).sin6_port);
  return ntohs(reinterpret_cast<const sockaddr_in&>(address).sin_port);
}

Transfer send_all(const Descriptor& stream, std::span<const std::uint8_t> bytes, const Wait& wait) {
  while (!bytes.empty()) {
    const ssize_t sent = ::send(stream.number(), bytes.data(), bytes.size(), MSG_NOSIGNAL);
    if (sent > 0) {
      bytes = bytes.subspan(static_cast<std::size_t>(sent));
      continue;
    }
    if (sent < 0 && !would_block(errno)) return Transfer::kClosed;
    if (!wait_until_ready(stream, POLLOUT, wait)) return Transfer::kTimedOut;
  }
  return Transfer::kDone;
}

Transfer receive_some(const Descriptor& stream, RpcBytes& buffer, std::size_t most, const Wait& wait) {
  const std::size_t before = buffer.size();
  buffer.resize(before + most);
  while (true) {
    const ssize_t received = ::recv(stream.number(), buffer.data() + before, most, 0);
    if (received > 0) {
      buffer.resize(before + static_cast<std::size_t>(received));
      return Transfer::kDone;
    }
    const bool waits = received < 0 && would_block(errno);
    if (waits && wait_until_ready(stream, POLLIN, wait)) continue;
    buffer.resize(before);
    return waits ? Transfer::kTimedOut : Transfer::kClosed;
  }
}

bool is_loopback(const Descriptor& listener) {
  const sockaddr_storage address = address_of(listener);
  if (address.ss_family == AF_INET) {
    return ntohl(reinterpret_cast<const sockaddr_in&>(address).sin_addr.s_addr) >> 24 == 127;
  }
  if (address.ss_family != AF_INET6) return false;
  const in6_addr& ipv6 = reinterpret_cast<const sockaddr_in6&>(address).sin6_addr;
  return IN6_IS_ADDR_LOOPBACK(&ipv6) || (IN6_IS_ADDR_V4MAPPED(&ipv6) && ipv6.s6_addr[12] == 127);
}

}  // namespace pilotage
