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
  std::uint32_t call = 0;
};

struct RpcAnswer {
  RpcValue error;  ///< nil: none.
  RpcValue result;
};

struct RpcTicketAnswer {
  RpcTicket ticket;
  RpcAnswer answer;
};

/// What a server does. Both are called from the thread of serve_rpc alone.
struct RpcService {
  /// Nothing: the answer comes from `step`.
  std::function<std::optional<RpcAnswer>(const RpcTicket& ticket, const std::string& method, const RpcArray& arguments)>
      call;
  /// Called between calls, some fifty times a second, with the seconds since it was called last.
  std::function<std::vector<RpcTicketAnswer>(double elapsed_s)> step;
};

struct RpcServerLimits {
  RpcLimits request{std::size_t{1} << 20, 10'000, 16};
  std::size_t connections = 32;  ///< More wait until one of them ends.
  /// Of answers that a peer does not fetch: no more of its calls are taken until it has.
  std::size_t unsent_bytes = std::size_t{64} << 20;
};

struct RpcServed {
  std::int64_t connections = 0;
  std::int64_t calls = 0;
  std::int64_t dropped = 0;  ///< Connections that were closed because they sent no calls.
  /// Calls that were answered with an error, by its text, which names method, number of arguments and reason; beyond
  /// kMostRefusals texts under "other errors".
  std::map<std::string, std::int64_t> refused;
};
inline constexpr std::size_t kMostRefusals = 50;

/// Answers msgpack-rpc (rpc_client.h) on all connections that `listener` gets, until `stop`, which is told what has
/// been served and asked some fifty times a second. A connection that sends what is no call within the limits is
/// closed.
RpcServed serve_rpc(const Descriptor& listener, const RpcService& service,
                    const std::function<bool(const RpcServed&)>& stop, const RpcServerLimits& limits = {});

}  // namespace pilotage
