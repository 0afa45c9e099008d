#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "pilotage/airsim/rpc_codec.h"
#include "pilotage/airsim/tcp_stream.h"

namespace pilotage {

/// A call of a connection, so that it can be answered later.
struct RpcTicket {
  std::uint64_t connection = 0;
  std::optional<std::uint32_t> call;  ///< Nothing: a notification, which nobody waits for.
};

struct RpcAnswer {
  RpcValue error;  ///< nil: none.
  RpcValue result;
};

struct RpcTicketAnswer {
  RpcTicket ticket;
  RpcAnswer answer;
};

/// What a piece of work came to.
struct RpcWork {
  std::optional<RpcTicketAnswer> answer;
  bool done = false;  ///< A piece was done: there may be more.
};

/// What a server does. All are called from the thread of serve_rpc alone.
struct RpcService {
  /// Nothing: the answer comes from `step` or `work`.
  std::function<std::optional<RpcAnswer>(const RpcTicket& ticket, const std::string& method, const RpcArray& arguments)>
      call;
  /// Called between calls, some fifty times a second, with the seconds since it was called last.
  std::function<std::vector<RpcTicketAnswer>(double elapsed_s)> step;
  /// A piece of what takes long, of a connection that `may_work` allows; nobody is answered meanwhile. May be empty.
  std::function<RpcWork(const std::function<bool(std::uint64_t connection)>& may_work)> work = {};
  /// The connection is gone: nothing more needs to be done for it. May be empty.
  std::function<void(std::uint64_t connection)> ended = {};
};

struct RpcServerLimits {
  RpcLimits request{std::size_t{1} << 20, 10'000, 16};
  std::size_t connections = 32;  ///< One more takes the place of the one that has been quiet for longest.
  /// Of answers that a peer does not fetch: no more of its calls are taken, and no work is done for it, until it has.
  std::size_t unsent_bytes = std::size_t{1} << 20;
  /// Of all connections: no work is done meanwhile; of those that fetch nothing for a second who owes most is closed.
  std::size_t all_unsent_bytes = std::size_t{64} << 20;
  std::size_t waiting_calls = 16;  ///< Of one connection, that are answered later.
  double may_give_way_s = 10;      ///< So long a connection has been quiet that gives way to a new one.
  double idle_s = 600;             ///< A connection without a call and without an answer to wait for is closed.
};

struct RpcServed {
  std::int64_t connections = 0;
  std::int64_t calls = 0;
  std::int64_t dropped = 0;  ///< Connections that were closed because they sent no calls.
  std::int64_t idle = 0;     ///< Connections that were closed because they were quiet, or did not fetch their answers.
  /// Calls that were answered with an error, by its text, which names method, number of arguments and reason; beyond
  /// kMostRefusals texts under "other errors".
  std::map<std::string, std::int64_t> refused;
};
inline constexpr std::size_t kMostRefusals = 50;

/// Answers msgpack-rpc (rpc_client.h) on all connections that `listener` gets, one call of each in turn, until `stop`,
/// which is told what has been served and asked after each turn, some fifty times a second when there is little to do.
/// A connection that sends what is no call within the limits is closed.
RpcServed serve_rpc(const Descriptor& listener, const RpcService& service,
                    const std::function<bool(const RpcServed&)>& stop, const RpcServerLimits& limits = {});

}  // namespace pilotage
