#include "pilotage/airsim/rpc_server.h"

#include <algorithm>
#include <cerrno>
#include <map>

#include <poll.h>
#include <sys/socket.h>

#include "pilotage/base/error.h"

namespace pilotage {
namespace {

constexpr int kStepMs = 20;
constexpr std::size_t kReadBytes = std::size_t{64} << 10;

struct RpcConnection {
  Descriptor stream;
  RpcMessageScanner scanner;
  RpcBytes received;
  RpcBytes unsent;
  std::size_t sent = 0;  ///< Of `unsent`.
  bool ended = false;    ///< The peer sends no more.
  bool broken = false;

  std::size_t backlog() const { return unsent.size() - sent; }
};

struct RpcCallMessage {
  std::optional<std::uint32_t> number;  ///< Nothing: a notification, which nobody answers.
  std::string method;
  RpcArray arguments;
};

/// [0, number, method, arguments] or [2, method, arguments]. Throws DataError.
RpcCallMessage call_of(const RpcValue& message) {
  const auto* parts = std::get_if<RpcArray>(&message.data);
  if (parts == nullptr || parts->size() < 3 || parts->size() > 4) throw DataError("is no call");
  const bool notifies = parts->size() == 3;
  const auto* kind = std::get_if<std::uint64_t>(&parts->front().data);
  const auto* method = std::get_if<std::string>(&parts->at(parts->size() - 2).data);
  const auto* arguments = std::get_if<RpcArray>(&parts->back().data);
  if (kind == nullptr || *kind != (notifies ? 2U : 0U) || method == nullptr || arguments == nullptr) {
    throw DataError("is no call");
  }
  RpcCallMessage call{std::nullopt, *method, *arguments};
  if (notifies) return call;
  const auto* number = std::get_if<std::uint64_t>(&parts->at(1).data);
  if (number == nullptr || *number > 0xFFFFFFFFU) throw DataError("is no call");
  call.number = static_cast<std::uint32_t>(*number);
  return call;
}

void push_answer(RpcConnection& connection, std::uint32_t call, const RpcAnswer& answer) {
  const RpcValue message = RpcArray{std::uint64_t{1}, std::uint64_t{call}, answer.error, answer.result};
  const RpcBytes bytes = encode_rpc(message);
  connection.unsent.insert(connection.unsent.end(), bytes.begin(), bytes.end());
}

bool waits_for_nothing(int error_number) {
  return error_number == EAGAIN || error_number == EWOULDBLOCK || error_number == EINTR;
}

void read_from(RpcConnection& connection) {
  const std::size_t before = connection.received.size();
  connection.received.resize(before + kReadBytes);
  const ssize_t count = ::recv(connection.stream.number(), connection.received.data() + before, kReadBytes, 0);
  const int error_number = errno;
  connection.received.resize(before + static_cast<std::size_t>(std::max<ssize_t>(count, 0)));
  if (count == 0) connection.ended = true;
  if (count < 0 && !waits_for_nothing(error_number)) connection.broken = true;
}

void write_to(RpcConnection& connection) {
  while (connection.backlog() > 0) {
    const ssize_t count = ::send(connection.stream.number(), connection.unsent.data() + connection.sent,
                                 connection.backlog(), MSG_NOSIGNAL);
    if (count < 0) {
      if (!waits_for_nothing(errno)) connection.broken = true;
      return;
    }
    connection.sent += static_cast<std::size_t>(count);
  }
  connection.unsent.clear();
  connection.sent = 0;
}

/// One run of serve_rpc.
class RpcServing {
 public:
  RpcServing(const Descriptor& listener, const RpcService& service, const RpcServerLimits& limits)
      : listener_(listener), service_(service), limits_(limits) {}

  const RpcServed& served() const { return served_; }

  void turn() {
    wait();
    for (auto& [number, connection] : connections_) answer_calls(number, connection);
    const auto now = std::chrono::steady_clock::now();
    const std::vector<RpcTicketAnswer> late = service_.step(std::chrono::duration<double>(now - stepped_).count());
    stepped_ = now;
    for (const RpcTicketAnswer& answer : late) {
      count_refusal(answer.answer);
      const auto found = connections_.find(answer.ticket.connection);
      if (found != connections_.end()) push_answer(found->second, answer.ticket.call, answer.answer);
    }
    for (auto& [number, connection] : connections_) write_to(connection);
    std::erase_if(connections_, [](const auto& entry) {
      const RpcConnection& connection = entry.second;
      return connection.broken || (connection.ended && connection.backlog() == 0);
    });
  }

 private:
  void wait() {
    std::vector<pollfd> watched;
    std::vector<RpcConnection*> of;
    const bool has_room = connections_.size() < limits_.connections;
    watched.push_back({has_room ? listener_.number() : -1, POLLIN, 0});
    for (auto& [number, connection] : connections_) {
      const bool takes = connection.backlog() < limits_.unsent_bytes && !connection.ended;
      const int events = (takes ? POLLIN : 0) | (connection.backlog() > 0 ? POLLOUT : 0);
      watched.push_back({connection.stream.number(), static_cast<short>(events), 0});
      of.push_back(&connection);
    }
    if (::poll(watched.data(), watched.size(), kStepMs) <= 0) return;
    for (std::size_t i = 0; i < of.size(); ++i) {
      const short happened = watched[i + 1].revents;
      if ((happened & POLLIN) != 0) read_from(*of[i]);
      if ((happened & (POLLERR | POLLNVAL)) != 0 || happened == POLLHUP) of[i]->broken = true;
    }
    if ((watched[0].revents & POLLIN) != 0) accept_one();
  }

  void accept_one() {
    Descriptor stream(::accept4(listener_.number(), nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC));
    if (!stream.is_open()) return;
    ++served_.connections;
    connections_.emplace(next_connection_++,
                         RpcConnection{std::move(stream), RpcMessageScanner(limits_.request), {}, {}});
  }

  void answer_calls(std::uint64_t number, RpcConnection& connection) {
    try {
      while (connection.backlog() < limits_.unsent_bytes && !connection.broken) {
        const std::optional<std::size_t> size = connection.scanner.scan(connection.received);
        if (!size) return;
        const RpcCallMessage call = call_of(decode_rpc(std::span(connection.received).first(*size), limits_.request));
        connection.received.erase(connection.received.begin(),
                                  connection.received.begin() + static_cast<std::ptrdiff_t>(*size));
        ++served_.calls;
        const RpcTicket ticket{number, call.number.value_or(0)};
        const std::optional<RpcAnswer> answer = service_.call(ticket, call.method, call.arguments);
        if (answer) count_refusal(*answer);
        if (answer && call.number) push_answer(connection, *call.number, *answer);
      }
    } catch (const DataError&) {  // not of the service, which answers its errors
      connection.broken = true;
      ++served_.dropped;
    }
  }

  void count_refusal(const RpcAnswer& answer) {
    const auto* text = std::get_if<std::string>(&answer.error.data);
    if (text == nullptr) return;
    const bool known = served_.refused.contains(*text);
    ++served_.refused[known || served_.refused.size() < kMostRefusals ? *text : "other errors"];
  }

  const Descriptor& listener_;
  const RpcService& service_;
  RpcServerLimits limits_;
  std::map<std::uint64_t, RpcConnection> connections_;
  std::uint64_t next_connection_ = 1;
  std::chrono::steady_clock::time_point stepped_ = std::chrono::steady_clock::now();
  RpcServed served_;
};

}  // namespace

RpcServed serve_rpc(const Descriptor& listener, const RpcService& service,
                    const std::function<bool(const RpcServed&)>& stop, const RpcServerLimits& limits) {
  RpcServing serving(listener, service, limits);
  while (!stop(serving.served())) serving.turn();
  return serving.served();
}

}  // namespace pilotage
