#pragma once

#include <type_traits>
#include <variant>

#include <nlohmann/json.hpp>

namespace pilotage {

/// What a variant holds; std::monostate is null.
template <class... Held>
nlohmann::ordered_json variant_to_json(const std::variant<std::monostate, Held...>& value) {
  nlohmann::ordered_json json;
  std::visit(
      [&](const auto& held) {
        if constexpr (!std::is_same_v<std::decay_t<decltype(held)>, std::monostate>) json = held;
      },
      value);
  return json;
}

}  // namespace pilotage
