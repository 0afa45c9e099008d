// Any bytes as a list of chunks, and the same bytes as the file that it is of: nothing but DataError may come out.
#include <cstddef>
#include <cstdint>
#include <string>

#include "fuzz/fuzz_targets.h"
#include "fuzz/input_file.h"

#include "pilotage/base/error.h"
#include "pilotage/mapdb/chunked_file.h"

namespace pilotage {

void fuzz_chunks(const std::uint8_t* data, std::size_t size) {
  const std::string bytes(reinterpret_cast<const char*>(data), size);
  const FuzzFile input(data, size, ".chunks");
  try {
    const ChunkedFile file(input.path(), "fuzz", bytes);
    for (std::uint64_t i = 0; i < chunk_count(file.size()); ++i) static_cast<void>(file.read_chunk(i));
  } catch (const DataError&) {
  }
}

}  // namespace pilotage
