// Any bytes as what a server of the AirSim family, or a client of ours, sends: DataError, or messages that mean the
// same when they are encoded again, and that are read as every struct of the protocol without harm.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>

#include "fuzz/fuzz_targets.h"

#include "pilotage/airsim/airsim_fields.h"
#include "pilotage/airsim/rpc_codec.h"
#include "pilotage/base/error.h"

namespace pilotage {
namespace {

constexpr RpcLimits kLimits{std::size_t{1} << 16, 5000, 16};

template <class T>
void read_as(AirsimDialect dialect, const RpcValue& value) {
  try {
    static_cast<void>(to_rpc(dialect, from_rpc<T>(dialect, value, "fuzz")));
  } catch (const DataError&) {
  }
}

void read_as_everything(const RpcValue& value) {
  for (const AirsimDialect dialect : {AirsimDialect::kAirsim, AirsimDialect::kColosseum, AirsimDialect::kCosys}) {
    read_as<AirsimPose>(dialect, value);
    read_as<AirsimMultirotorState>(dialect, value);
    read_as<AirsimCameraInfo>(dialect, value);
    read_as<AirsimGps>(dialect, value);
    read_as<AirsimImu>(dialect, value);
    read_as<std::vector<AirsimImage>>(dialect, value);
    read_as<std::vector<AirsimImageRequest>>(dialect, value);
    read_as<std::vector<std::string>>(dialect, value);
  }
}

}  // namespace

void fuzz_airsim(const std::uint8_t* data, std::size_t size) {
  std::span<const std::uint8_t> bytes(data, size);
  try {
    RpcMessageScanner scanner(kLimits);
    while (const auto message = scanner.scan(bytes)) {
      const RpcValue value = decode_rpc(bytes.first(*message), kLimits);
      const RpcBytes again = encode_rpc(value);
      if (encode_rpc(decode_rpc(again, kLimits)) != again) std::abort();
      const auto* parts = std::get_if<RpcArray>(&value.data);
      for (const RpcValue& part : parts == nullptr ? RpcArray{value} : *parts) read_as_everything(part);
      bytes = bytes.subspan(*message);
    }
  } catch (const DataError&) {
  }
}

}  // namespace pilotage
