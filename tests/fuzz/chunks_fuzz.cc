// Any bytes as a list of chunks, and the same bytes as the file that it is of: nothing but DataError may come out.
#include <cstddef>
#include <cstdint>
#include <string>

#include "fuzz/input_file.h"

#include "pilotage/base/error.h"
#include "pilotage/mapdb/chunked_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string bytes(reinterpret_cast<const char*>(data), size);
  const pilotage::InputFile input(data, size, ".chunks");
  try {
    const pilotage::ChunkedFile file(input.path(), "fuzz", bytes);
    for (std::uint64_t i = 0; i < pilotage::chunk_count(file.size()); ++i) static_cast<void>(file.read_chunk(i));
  } catch (const pilotage::DataError&) {
  }
  return 0;
}
