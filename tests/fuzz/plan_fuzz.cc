// Any bytes as plan.json: DataError, or a value that its own file gives again.
#include <cstddef>
#include <cstdint>

#include "fuzz/json_file.h"

#include "pilotage/mission/plan_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  pilotage::read_json_file_twice(data, size, pilotage::read_plan, pilotage::plan_to_json);
  return 0;
}
