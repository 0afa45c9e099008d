#pragma once

#include <cstdint>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

namespace pilotage {

struct RpcValue;
using RpcBytes = std::vector<std::uint8_t>;
using RpcArray = std::vector<RpcValue>;
/// Members in their order. Keys are text; of the same key the first counts.
using RpcMap = std::vector<std::pair<std::string, RpcValue>>;

/// One value of msgpack, but for its extension types.
struct RpcValue {
  using Data = std::variant<std::monostate, bool, std::int64_t, std::uint64_t, float, double, std::string, RpcBytes,
                            RpcArray, RpcMap>;
  Data data;

  RpcValue() = default;
  template <class T>
  requires(!std::is_same_v<T, RpcValue>) RpcValue(T value) : data(std::move(value)) {}

  bool is_nil() const { return std::holds_alternative<std::monostate>(data); }
};

/// "nil", "a bool", "an integer", "a number", "a string", "bytes", "an array of 3" or "a map of 3": what an error says
/// stands there.
std::string rpc_kind(const RpcValue& value);

/// The member of a map, or nullptr where `value` is no map or has none of that name.
const RpcValue* rpc_member(const RpcValue& value, const std::string& name);

}  // namespace pilotage
