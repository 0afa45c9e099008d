#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>

#include "pilotage/airsim/rpc_codec.h"
#include "pilotage/airsim/tcp_stream.h"

namespace pilotage {

/// A client of msgpack-rpc over TCP: requests are [0, number, method, arguments], replies [1, number, error, result],
/// one after the other in both directions, without frames. Replies may come in any order.
///
/// What goes wrong is a DataError that begins with peer and method: no connection, a connection that ends, a time that
/// passes, bytes that are no reply, a reply to no call, an error that the server answers. But for the last, the
/// connection is then closed, and every later call says so.
class RpcClient {
 public:
  /// Connects. `timeout_s`: for connecting, and from a call to its reply. While it waits it asks `go_on`, where there
  /// is one, ten times a second, and throws Interrupted once that says no.
  RpcClient(const HostPort& peer, double timeout_s, const RpcLimits& limits = {}, std::function<bool()> go_on = {});

  const HostPort& peer() const { return peer_; }

  /// Sends a call, whose reply wait() takes.
  std::uint32_t send(const std::string& method, RpcArray arguments);

  /// The result of a call that was sent. `timeout_s` instead of that of the client.
  RpcValue wait(std::uint32_t call);
  RpcValue wait(std::uint32_t call, double timeout_s);

  /// Both.
  RpcValue call(const std::string& method, RpcArray arguments);

 private:
  struct Reply {
    RpcValue error;  ///< nil when there is none.
    RpcValue result;
  };
  struct Call {
    std::string method;
    std::optional<Reply> reply;
  };

  std::string where(const std::string& method) const;
  [[noreturn]] void fail(const std::string& method, const std::string& problem);
  void receive(const std::string& method, Deadline deadline, double timeout_s);
  void take_reply(const RpcValue& message, const std::string& method);

  HostPort peer_;
  double timeout_s_;
  RpcLimits limits_;
  std::function<bool()> go_on_;
  Descriptor stream_;
  RpcMessageScanner scanner_;
  RpcBytes buffer_;
  std::uint32_t next_call_ = 1;
  std::map<std::uint32_t, Call> calls_;  ///< Those that wait() was not asked for yet.
};

}  // namespace pilotage
