#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace pilotage {

/// A part of a run for one machine of several (docs/scale.md).
struct Shard {
  std::int64_t number = 1;  ///< 1 … count.
  std::int64_t count = 1;

  bool operator==(const Shard&) const = default;
};

/// More shards than anybody will want; keeps arithmetic in range.
inline constexpr std::int64_t kMostShards = 1'000'000;

/// The value of an environment variable, or nothing.
using Environment = std::function<std::optional<std::string>(const std::string& name)>;

/// That of this process.
std::optional<std::string> environment_of_process(const std::string& name);

/// "3/16" is the third of 16 shards. "auto/16" takes the number from the scheduler: SLURM_ARRAY_TASK_ID as it is (an
/// array 1-16), JOB_COMPLETION_INDEX (Kubernetes) and AWS_BATCH_JOB_ARRAY_INDEX, which count from 0, plus one. Throws
/// UsageError for anything else, and for auto when none or several of them are set, or the number is not 1 … count.
Shard parse_shard(const std::string& text, const Environment& environment);

/// Of `count` things in an order those with ranks ⌊count (number − 1)/shards⌋ up to, not including,
/// ⌊count number/shards⌋, so that shards differ by at most one. `what` is one of them for messages: "tile". Throws
/// UsageError when there are more shards than things, or the number is not 1 … count.
std::pair<std::int64_t, std::int64_t> shard_ranks(std::int64_t count, const Shard& shard, const std::string& what);

/// "1,3-5,9": numbers that ascend, as `sbatch --array` takes them.
std::string number_list(const std::vector<std::int64_t>& numbers);

}  // namespace pilotage
