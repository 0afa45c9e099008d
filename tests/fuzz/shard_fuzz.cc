// Any bytes as a shard of scores: a sound shard, or one of our own errors. Each input is also tried with a right digest
// behind it, so that what lies behind the digest is reached.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>

#include "pilotage/base/error.h"
#include "pilotage/base/file_digest.h"
#include "pilotage/score/score_shard.h"

namespace {

void read(const std::string& bytes) {
  try {
    const pilotage::ScoreShard shard = pilotage::score_shard_from_bytes("fuzz", bytes);
    const std::string again = pilotage::score_shard_to_bytes(shard);
    if (pilotage::score_shard_from_bytes("again", again).rows.size() != shard.rows.size()) std::abort();
  } catch (const pilotage::DataError&) {
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string bytes(reinterpret_cast<const char*>(data), size);
  read(bytes);
  const std::string content = bytes.substr(0, size < 64 ? 0 : size - 64);
  read(content + pilotage::bytes_digest(content));
  return 0;
}
