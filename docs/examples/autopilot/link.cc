#include "link.h"

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <map>
#include <stdexcept>

#include <fcntl.h>
#include <netdb.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <termios.h>
#include <unistd.h>

namespace {

[[noreturn]] void refuse(const std::string& name, const std::string& why) {
  throw std::runtime_error(name + ": " + why);
}

std::vector<std::string> parts_of(const std::string& name) {
  std::vector<std::string> parts(1);
  for (const char letter : name) letter == ':' ? void(parts.emplace_back()) : parts.back().push_back(letter);
  return parts;
}

const std::map<std::string, speed_t> kSpeeds = {{"57600", B57600},     {"115200", B115200},   {"230400", B230400},
                                                {"460800", B460800},   {"500000", B500000},   {"921600", B921600},
                                                {"1000000", B1000000}, {"1500000", B1500000}, {"2000000", B2000000}};

}  // namespace

Link::Link(const std::string& name) {
  const std::vector<std::string> parts = parts_of(name);
  if (parts[0] == "udp" && parts.size() == 3) {
    open_udp(parts[1], parts[2]);
  } else if (parts[0] == "udpin" && parts.size() == 2) {
    listen_udp(parts[1]);
  } else if (parts[0] == "serial" && parts.size() == 3) {
    device_ = parts[1];
    baud_ = parts[2];
    open_serial();
  } else {
    refuse(name, "a link is udp:HOST:PORT, udpin:PORT or serial:DEVICE:BAUD");
  }
}

Link::~Link() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

void Link::open_udp(const std::string& host, const std::string& port) {
  addrinfo hints{};
  hints.ai_socktype = SOCK_DGRAM;
  addrinfo* addresses = nullptr;
  if (::getaddrinfo(host.c_str(), port.c_str(), &hints, &addresses) != 0) refuse(host + ":" + port, "no such place");
  for (const addrinfo* address = addresses; address != nullptr && descriptor_ < 0; address = address->ai_next) {
    const int stream = ::socket(address->ai_family, SOCK_DGRAM | SOCK_NONBLOCK, 0);
    if (stream >= 0 && ::connect(stream, address->ai_addr, address->ai_addrlen) == 0) descriptor_ = stream;
    if (stream >= 0 && descriptor_ < 0) ::close(stream);
  }
  ::freeaddrinfo(addresses);
  if (descriptor_ < 0) refuse(host + ":" + port, "cannot be sent to");
}

void Link::listen_udp(const std::string& port) {
  listens_ = true;
  descriptor_ = ::socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  std::uint16_t number = 0;
  const auto read = std::from_chars(port.data(), port.data() + port.size(), number);
  if (read.ec != std::errc{} || read.ptr != port.data() + port.size() || number == 0)
    refuse("udpin:" + port, "no port");
  address.sin_port = htons(number);
  if (descriptor_ < 0 || ::bind(descriptor_, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) != 0) {
    refuse("udpin:" + port, std::strerror(errno));
  }
}

void Link::open_serial() {
  const auto speed = kSpeeds.find(baud_);
  if (speed == kSpeeds.end()) {
    std::string known;
    for (const auto& [name, _] : kSpeeds) known += " " + name;
    refuse(device_ + ":" + baud_, "no such baud rate; there are" + known);
  }
  descriptor_ = ::open(device_.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
  termios line{};
  if (descriptor_ < 0 || ::tcgetattr(descriptor_, &line) != 0) refuse(device_, std::strerror(errno));
  ::cfmakeraw(&line);
  line.c_cflag |= CLOCAL | CREAD;
  ::cfsetspeed(&line, speed->second);
  if (::tcsetattr(descriptor_, TCSANOW, &line) != 0) refuse(device_, std::strerror(errno));
}

bool Link::mend() {
  if (device_.empty()) return true;  // a network comes back by itself
  if (descriptor_ >= 0) ::close(descriptor_);
  descriptor_ = -1;
  try {
    open_serial();
  } catch (const std::runtime_error&) {
    if (descriptor_ >= 0) ::close(descriptor_);
    descriptor_ = -1;
  }
  return descriptor_ >= 0;
}

std::vector<std::uint8_t> Link::receive() {
  std::vector<std::uint8_t> bytes(65536);
  ssize_t count = 0;
  if (listens_) {
    sockaddr_storage from{};
    socklen_t size = sizeof(from);
    count = ::recvfrom(descriptor_, bytes.data(), bytes.size(), 0, reinterpret_cast<sockaddr*>(&from), &size);
    const auto* begin = reinterpret_cast<const std::uint8_t*>(&from);
    if (count > 0) peer_.assign(begin, begin + size);
  } else {
    count = ::read(descriptor_, bytes.data(), bytes.size());
  }
  bytes.resize(static_cast<std::size_t>(std::max<ssize_t>(0, count)));
  return bytes;
}

void Link::send(std::span<const std::uint8_t> bytes) {
  if (!listens_) {
    // A serial line may take a part: the rest follows, unless the line stands.
    constexpr int kPatience_ms = 20;
    for (pollfd line{descriptor_, POLLOUT, 0}; !bytes.empty() && ::poll(&line, 1, kPatience_ms) > 0;) {
      const ssize_t count = ::write(descriptor_, bytes.data(), bytes.size());
      if (count <= 0) break;
      bytes = bytes.subspan(static_cast<std::size_t>(count));
    }
  } else if (!peer_.empty()) {
    static_cast<void>(::sendto(descriptor_, bytes.data(), bytes.size(), 0,
                               reinterpret_cast<const sockaddr*>(peer_.data()), static_cast<socklen_t>(peer_.size())));
  }
}
