#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "pilotage/airsim/rpc_value.h"

namespace pilotage {

/// What a message of a peer may be at most. A value takes 40 bytes in memory beside its text, so a message takes no
/// more than message_bytes, twice, and 40 · values.
struct RpcLimits {
  std::size_t message_bytes = std::size_t{64} << 20;  ///< A picture of 4,000 × 3,000 pixels takes 36 MB.
  std::size_t values = 100'000;                       ///< Numbers, texts, arrays, maps and keys.
  int depth = 16;                                     ///< Arrays and maps in each other.
};

/// Finds where messages end in a stream of msgpack objects, which has no frames of its own. Looks at each byte once,
/// however it arrives, and refuses what is too large by its announced sizes, before it has arrived.
class RpcMessageScanner {
 public:
  explicit RpcMessageScanner(const RpcLimits& limits) : limits_(limits) {}

  /// The size of the message that `buffer` begins with; nothing when it is not whole. To be called with the same
  /// bytes and more behind them, until it answers; then it begins anew. Throws DataError when they are no message
  /// within the limits: the rest of the stream is lost.
  std::optional<std::size_t> scan(std::span<const std::uint8_t> buffer);

 private:
  RpcLimits limits_;
  std::size_t at_ = 0;       ///< Where the next header begins.
  std::size_t missing_ = 1;  ///< Values that are still to come.
  std::size_t values_ = 0;   ///< Values in all, announced ones with them.
};

/// One message. Throws DataError when the bytes are not one value of msgpack within the limits.
RpcValue decode_rpc(std::span<const std::uint8_t> message, const RpcLimits& limits);

RpcBytes encode_rpc(const RpcValue& value);

}  // namespace pilotage
