// Any bytes as a matchability model: DataError, or a value that its own file gives again.
#include <cstddef>
#include <cstdint>

#include "fuzz/json_file.h"

#include "pilotage/matchability/matchability_model.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  pilotage::read_json_file_twice(data, size, pilotage::read_matchability_model, pilotage::matchability_model_to_json);
  return 0;
}
