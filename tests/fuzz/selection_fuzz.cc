// Any bytes as selection.json: DataError, or a value that its own file gives again.
#include <cstddef>
#include <cstdint>

#include "fuzz/fuzz_targets.h"
#include "fuzz/json_file.h"

#include "pilotage/mission/selection_file.h"

namespace pilotage {

void fuzz_selection(const std::uint8_t* data, std::size_t size) {
  read_json_file_twice(data, size, read_selection, selection_to_json);
}

}  // namespace pilotage
