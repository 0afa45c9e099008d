// Any bytes as a shard of scores: a sound shard, or one of our own errors. Each input is also tried with a right digest
// behind it, so that what lies behind the digest is reached.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>

#include "fuzz/fuzz_targets.h"

#include "pilotage/base/error.h"
#include "pilotage/base/file_digest.h"
#include "pilotage/score/score_shard.h"

namespace pilotage {
namespace {

void read_shard(const std::string& bytes) {
  try {
    const ScoreShard shard = score_shard_from_bytes("fuzz", bytes);
    const std::string again = score_shard_to_bytes(shard);
    if (score_shard_from_bytes("again", again).rows.size() != shard.rows.size()) std::abort();
  } catch (const DataError&) {
  }
}

}  // namespace

void fuzz_shard(const std::uint8_t* data, std::size_t size) {
  const std::string bytes(reinterpret_cast<const char*>(data), size);
  read_shard(bytes);
  const std::string content = bytes.substr(0, size < 64 ? 0 : size - 64);
  read_shard(content + bytes_digest(content));
}

}  // namespace pilotage
