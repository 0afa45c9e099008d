#include "pilotage/airsim/rpc_value.h"

namespace pilotage {

std::string rpc_kind(const RpcValue& value) {
  static constexpr const char* kKinds[] = {"nil",      "a bool",   "an integer", "an integer", "a number",
                                           "a number", "a string", "bytes",      "an array",   "a map"};
  std::string kind = kKinds[value.data.index()];
  if (const auto* array = std::get_if<RpcArray>(&value.data)) kind += " of " + std::to_string(array->size());
  if (const auto* map = std::get_if<RpcMap>(&value.data)) kind += " of " + std::to_string(map->size());
  return kind;
}

const RpcValue* rpc_member(const RpcValue& value, const std::string& name) {
  const auto* map = std::get_if<RpcMap>(&value.data);
  if (map == nullptr) return nullptr;
  for (const auto& [key, member] : *map) {
    if (key == name) return &member;
  }
  return nullptr;
}

}  // namespace pilotage
