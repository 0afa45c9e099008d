#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>

#include "fuzz/input_file.h"
#include <nlohmann/json.hpp>

#include "pilotage/base/error.h"

namespace pilotage {

/// Any bytes as a JSON file of ours: DataError, or a value whose own JSON reads as the same value. `read` takes a path,
/// `to_json` what it gives.
template <class Read, class ToJson>
void read_json_file_twice(const std::uint8_t* data, std::size_t size, const Read& read, const ToJson& to_json) {
  std::string text;
  try {
    const FuzzFile file(data, size, ".json");
    text = to_json(read(file.path())).dump();
  } catch (const DataError&) {
    return;
  }
  // What was read is sound, so its own file must be: an error here ends the program.
  const FuzzFile again(reinterpret_cast<const std::uint8_t*>(text.data()), text.size(), "-again.json");
  if (to_json(read(again.path())).dump() != text) std::abort();
}

}  // namespace pilotage
