#include "pilotage/base/shard.h"

#include <charconv>
#include <cstdlib>
#include <string_view>

#include "pilotage/base/error.h"
#include "pilotage/base/text.h"

namespace pilotage {
namespace {

constexpr const char* kGrammar = "NUMBER/COUNT (3/16 is the third of 16) or auto/COUNT";

std::optional<std::int64_t> parse_count(std::string_view text) {
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return value;
}

/// A variable that schedulers set in each task of an array, and the number it gives to the first one.
struct TaskIndex {
  const char* variable;
  std::int64_t first;
};
constexpr TaskIndex kTaskIndices[] = {
    {"SLURM_ARRAY_TASK_ID", 1}, {"JOB_COMPLETION_INDEX", 0}, {"AWS_BATCH_JOB_ARRAY_INDEX", 0}};

std::int64_t number_from_scheduler(std::int64_t count, const Environment& environment) {
  std::vector<std::string> found;
  std::int64_t number = 0;
  for (const TaskIndex& index : kTaskIndices) {
    const std::optional<std::string> text = environment(index.variable);
    if (!text) continue;
    found.emplace_back(index.variable);
    const std::optional<std::int64_t> value = parse_count(*text);
    if (!value || *value < index.first || *value - index.first >= count) {
      throw UsageError(std::string(index.variable) + " = \"" + *text + "\" is outside [" + std::to_string(index.first) +
                       ", " + std::to_string(count - 1 + index.first) + "], the numbers of " + std::to_string(count) +
                       " shards");
    }
    number = *value - index.first + 1;
  }
  if (found.empty()) {
    throw UsageError("shard = \"auto/" + std::to_string(count) +
                     "\": no scheduler says which: none of SLURM_ARRAY_TASK_ID, JOB_COMPLETION_INDEX and "
                     "AWS_BATCH_JOB_ARRAY_INDEX is set");
  }
  if (found.size() > 1) throw UsageError("shard = \"auto\": " + join(found, " and ") + " are set; give the number");
  return number;
}

}  // namespace

std::optional<std::string> environment_of_process(const std::string& name) {
  const char* value = std::getenv(name.c_str());
  return value == nullptr ? std::optional<std::string>() : std::optional<std::string>(value);
}

Shard parse_shard(const std::string& text, const Environment& environment) {
  const std::size_t slash = text.find('/');
  const std::string_view before = std::string_view(text).substr(0, slash);
  const std::optional<std::int64_t> count =
      slash == std::string::npos ? std::nullopt : parse_count(std::string_view(text).substr(slash + 1));
  if (!count) throw UsageError("shard = \"" + text + "\" is not " + kGrammar);
  if (*count < 1 || *count > kMostShards) {
    throw UsageError("shard = \"" + text + "\": a count of " + std::to_string(*count) + " is outside [1, " +
                     std::to_string(kMostShards) + "]");
  }
  if (before == "auto") return {number_from_scheduler(*count, environment), *count};
  const std::optional<std::int64_t> number = parse_count(before);
  if (!number) throw UsageError("shard = \"" + text + "\" is not " + kGrammar);
  if (*number < 1 || *number > *count) {
    throw UsageError("shard = \"" + text + "\": " + std::to_string(*number) + " is outside [1, " +
                     std::to_string(*count) + "]");
  }
  return {*number, *count};
}

std::pair<std::int64_t, std::int64_t> shard_ranks(std::int64_t count, const Shard& shard, const std::string& what) {
  if (shard.count < 1 || shard.count > kMostShards || shard.number < 1 || shard.number > shard.count) {
    throw UsageError("shard " + std::to_string(shard.number) + "/" + std::to_string(shard.count) + " is not 1 … " +
                     std::to_string(shard.count));
  }
  if (shard.count > count) {
    throw UsageError(std::to_string(shard.count) + " shards of " + std::to_string(count) + " " + what +
                     "s: at most one shard for each " + what);
  }
  // Whole ones and the rest apart, so that no product overflows.
  const std::int64_t whole = count / shard.count;
  const std::int64_t rest = count % shard.count;
  const auto begin = [&](std::int64_t number) { return whole * number + rest * number / shard.count; };
  return {begin(shard.number - 1), begin(shard.number)};
}

std::string number_list(const std::vector<std::int64_t>& numbers) {
  std::vector<std::string> parts;
  for (std::size_t first = 0; first < numbers.size();) {
    std::size_t last = first;
    while (last + 1 < numbers.size() && numbers[last + 1] == numbers[last] + 1) ++last;
    parts.push_back(std::to_string(numbers[first]) + (last > first ? "-" + std::to_string(numbers[last]) : ""));
    first = last + 1;
  }
  return join(parts, ",");
}

}  // namespace pilotage
