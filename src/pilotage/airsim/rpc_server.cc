#include "pilotage/airsim/rpc_server.h"

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <iterator>
#include <map>
#include <span>
#include <utility>

#include <poll.h>
#include <sys/socket.h>

#include "pilotage/base/error.h"

namespace pilotage {
namespace {

constexpr int kStepMs = 20;
constexpr std::size_t kReadBytes = std::size_t{64} << 10;

using Clock = std::chrono::steady_clock;

/// After a failure to accept: without descriptors the listener stays ready, and waiting for it would not wait.
constexpr double kAcceptAgainS = 0.5;
/// So long all_unsent_bytes may keep work from being done.
constexpr double kMostBlockedS = 1;

double seconds_between(Clock::time_point from, Clock::time_point to) {
  return std::chrono::duration<double>(to - from).count();
}

struct RpcConnection {
  Descriptor stream;
  RpcMessageScanner scanner;
  Clock::time_point quiet_since;  ///< The last call that was taken, or bytes of an answer that it fetched.
  RpcBytes received = {};
  std::size_t taken = 0;  ///< Of `received`.
  RpcBytes unsent = {};
  std::size_t sent = 0;     ///< Of `unsent`.
  std::size_t waiting = 0;  ///< Calls that are answered later.
  bool has_call = false;    ///< It may be that `received` has a whole one that was not taken.
  bool ended = false;       ///< The peer sends no more.
  bool broken = false;

  std::size_t backlog() const { return unsent.size() - sent; }
  std::size_t untaken() const { return received.size() - taken; }
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

/// Answers may be large: as few copies as can be.
void push_answer(RpcConnection& connection, std::uint32_t call, RpcAnswer answer) {
  RpcArray parts(4);
  parts[0] = std::uint64_t{1};
  parts[1] = std::uint64_t{call};
  parts[2] = std::move(answer.error);
  parts[3] = std::move(answer.result);
  const RpcValue message(std::move(parts));
  if (connection.backlog() == 0) {
    connection.unsent = encode_rpc(message);
    connection.sent = 0;
    return;
  }
  const RpcBytes bytes = encode_rpc(message);
  connection.unsent.erase(connection.unsent.begin(),
                          connection.unsent.begin() + static_cast<std::ptrdiff_t>(connection.sent));
  connection.sent = 0;
  connection.unsent.insert(connection.unsent.end(), bytes.begin(), bytes.end());
}

/// Forgets the calls that were taken, when that is worth moving what is behind them.
void forget_taken(RpcConnection& connection) {
  if (connection.taken < kReadBytes && connection.untaken() > 0) return;
  connection.received.erase(connection.received.begin(),
                            connection.received.begin() + static_cast<std::ptrdiff_t>(connection.taken));
  connection.taken = 0;
}

bool waits_for_nothing(int error_number) {
  return error_number == EAGAIN || error_number == EWOULDBLOCK || error_number == EINTR;
}

void read_from(RpcConnection& connection) {
  forget_taken(connection);
  const std::size_t before = connection.received.size();
  connection.received.resize(before + kReadBytes);
  const ssize_t count = ::recv(connection.stream.number(), connection.received.data() + before, kReadBytes, 0);
  const int error_number = errno;
  connection.received.resize(before + static_cast<std::size_t>(std::max<ssize_t>(count, 0)));
  if (count > 0) connection.has_call = true;
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
    connection.quiet_since = Clock::now();
  }
  connection.unsent = {};  // an answer may have been large
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
    more_to_do_ = false;
    for (auto& [number, connection] : connections_) answer_call(number, connection);
    const auto now = Clock::now();
    for (RpcTicketAnswer& late : service_.step(seconds_between(stepped_, now))) answer_late(std::move(late));
    stepped_ = now;
    work();
    for (auto& [number, connection] : connections_) write_to(connection);
    close_some();
  }

 private:
  std::size_t unsent_bytes() const {
    std::size_t bytes = 0;
    for (const auto& [number, connection] : connections_) bytes += connection.backlog();
    return bytes;
  }

  void wait() {
    std::vector<pollfd> watched;
    std::vector<RpcConnection*> of;
    const auto now = Clock::now();
    const bool accepts = now >= accept_from_ && (connections_.size() < limits_.connections || quietest(now));
    watched.push_back({accepts ? listener_.number() : -1, POLLIN, 0});
    for (auto& [number, connection] : connections_) {
      // A whole call, and what is read at once: of what lies behind it the peer keeps what does not fit.
      const bool takes = !connection.ended && connection.untaken() < limits_.request.message_bytes;
      const int events = (takes ? POLLIN : 0) | (connection.backlog() > 0 ? POLLOUT : 0);
      watched.push_back({connection.stream.number(), static_cast<short>(events), 0});
      of.push_back(&connection);
    }
    if (::poll(watched.data(), watched.size(), more_to_do_ ? 0 : kStepMs) <= 0) return;
    for (std::size_t i = 0; i < of.size(); ++i) {
      const short happened = watched[i + 1].revents;
      if ((happened & POLLIN) != 0) read_from(*of[i]);
      if ((happened & (POLLERR | POLLNVAL)) != 0 || happened == POLLHUP) of[i]->broken = true;
    }
    if ((watched[0].revents & POLLIN) != 0) accept_some();
  }

  /// It waits for an answer that it will get; what is not fetched keeps it from being given more.
  bool waits(const RpcConnection& connection) const {
    return connection.backlog() < limits_.unsent_bytes && (connection.has_call || connection.waiting > 0);
  }

  /// The connection that has been without a call or an answer for longest, for so long that it may give way; or 0.
  std::uint64_t quietest(Clock::time_point now) const {
    std::uint64_t found = 0;
    double longest_s = limits_.may_give_way_s;
    for (const auto& [number, connection] : connections_) {
      const double quiet_s = seconds_between(connection.quiet_since, now);
      if (waits(connection) || quiet_s < longest_s) continue;
      longest_s = quiet_s;
      found = number;
    }
    return found;
  }

  void accept_some() {
    while (true) {
      const auto now = Clock::now();
      const bool full = connections_.size() >= limits_.connections;
      const std::uint64_t gives_way = full ? quietest(now) : 0;
      if (full && gives_way == 0) return;
      Descriptor stream(::accept4(listener_.number(), nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC));
      if (!stream.is_open()) {
        if (!waits_for_nothing(errno) && errno != ECONNABORTED) {
          accept_from_ =
              now + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(kAcceptAgainS));
        }
        return;
      }
      if (full) {
        close(connections_.find(gives_way));
        ++served_.idle;
      }
      ++served_.connections;
      connections_.emplace(next_connection_++,
                           RpcConnection{std::move(stream), RpcMessageScanner(limits_.request), now});
    }
  }

  void answer_call(std::uint64_t number, RpcConnection& connection) {
    if (connection.broken || connection.backlog() >= limits_.unsent_bytes ||
        connection.waiting >= limits_.waiting_calls) {
      return;
    }
    try {
      const auto untaken = std::span(connection.received).subspan(connection.taken);
      const std::optional<std::size_t> size = connection.scanner.scan(untaken);
      connection.has_call = size.has_value();
      if (!size) return;
      const RpcCallMessage call = call_of(decode_rpc(untaken.first(*size), limits_.request));
      connection.taken += *size;
      more_to_do_ = more_to_do_ || connection.untaken() > 0;
      forget_taken(connection);
      ++served_.calls;
      connection.quiet_since = Clock::now();
      std::optional<RpcAnswer> answer = service_.call({number, call.number}, call.method, call.arguments);
      if (answer) count_refusal(*answer);
      if (!answer && call.number) ++connection.waiting;
      if (answer && call.number) push_answer(connection, *call.number, *std::move(answer));
    } catch (const DataError&) {  // not of the service, which answers its errors
      connection.broken = true;
      ++served_.dropped;
    }
  }

  void answer_late(RpcTicketAnswer late) {
    count_refusal(late.answer);
    const auto found = connections_.find(late.ticket.connection);
    if (found == connections_.end() || !late.ticket.call) return;
    push_answer(found->second, *late.ticket.call, std::move(late.answer));
    if (found->second.waiting > 0) --found->second.waiting;
    found->second.quiet_since = Clock::now();
  }

  /// One piece, of a peer that fetches what it asks for. When others do not, so that no work is done for anybody, of
  /// those that have fetched nothing meanwhile the one that owes most gives way.
  void work() {
    if (!service_.work) return;
    const auto now = Clock::now();
    if (unsent_bytes() >= limits_.all_unsent_bytes) {
      if (seconds_between(free_at_, now) < kMostBlockedS) return;
      auto slowest = connections_.end();
      for (auto it = connections_.begin(); it != connections_.end(); ++it) {
        const bool fetches = seconds_between(it->second.quiet_since, now) < kMostBlockedS;
        if (fetches || it->second.backlog() == 0) continue;
        if (slowest == connections_.end() || it->second.backlog() > slowest->second.backlog()) slowest = it;
      }
      if (slowest == connections_.end()) return;
      close(slowest);
      ++served_.idle;
    }
    free_at_ = now;
    RpcWork done = service_.work([this](std::uint64_t number) {
      const auto found = connections_.find(number);
      return found != connections_.end() && found->second.backlog() < limits_.unsent_bytes;
    });
    if (done.answer) answer_late(*std::move(done.answer));
    more_to_do_ = more_to_do_ || done.done;
  }

  using Connections = std::map<std::uint64_t, RpcConnection>;

  Connections::iterator close(Connections::iterator connection) {
    if (service_.ended) service_.ended(connection->first);
    return connections_.erase(connection);
  }

  void close_some() {
    const auto now = Clock::now();
    for (auto it = connections_.begin(); it != connections_.end();) {
      const RpcConnection& connection = it->second;
      // Who has ended gets what is answered at once, and is not there for later answers.
      const bool answered =
          connection.ended && connection.backlog() == 0 && (!connection.has_call || connection.waiting > 0);
      const bool idle = !waits(connection) && seconds_between(connection.quiet_since, now) > limits_.idle_s;
      const bool gone = connection.broken || answered || idle;
      if (idle && !connection.broken && !answered) ++served_.idle;
      it = gone ? close(it) : std::next(it);
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
  Connections connections_;
  std::uint64_t next_connection_ = 1;
  bool more_to_do_ = false;  ///< Without waiting for anybody.
  Clock::time_point stepped_ = Clock::now();
  Clock::time_point free_at_ = Clock::now();  ///< When work was not kept from being done.
  Clock::time_point accept_from_ = Clock::now();
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
