// Any bytes as a matchability model: DataError, or a value that its own file gives again.
#include <cstddef>
#include <cstdint>

#include "fuzz/fuzz_targets.h"
#include "fuzz/json_file.h"

#include "pilotage/matchability/matchability_model.h"

namespace pilotage {

void fuzz_model(const std::uint8_t* data, std::size_t size) {
  read_json_file_twice(data, size, read_matchability_model, matchability_model_to_json);
}

}  // namespace pilotage
