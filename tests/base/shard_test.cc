#include "pilotage/base/shard.h"

#include <map>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pilotage/base/error.h"

namespace pilotage {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

Environment environment_of(std::map<std::string, std::string> variables) {
  return [variables](const std::string& name) -> std::optional<std::string> {
    const auto found = variables.find(name);
    return found == variables.end() ? std::nullopt : std::optional(found->second);
  };
}

TEST(ParseShard, ReadsNumberAndCount) {
  const Environment nothing = environment_of({});
  EXPECT_EQ(parse_shard("1/1", nothing), (Shard{1, 1}));
  EXPECT_EQ(parse_shard("16/16", nothing), (Shard{16, 16}));
  for (const char* wrong :
       {"",          "3",   "/",    "3/",    "/3",   "0/3",   "4/3",  "-1/3",   "1/0",    "1/-2",
        "1/1000001", "a/3", "3/4x", "3/4/5", " 3/4", "3.0/4", "auto", "auto/0", "AUTO/3", "99999999999999999999/3"}) {
    EXPECT_THROW(parse_shard(wrong, nothing), UsageError) << wrong;
  }
}

TEST(ParseShard, TakesTheNumberFromTheScheduler) {
  EXPECT_EQ(parse_shard("auto/4", environment_of({{"SLURM_ARRAY_TASK_ID", "1"}})), (Shard{1, 4}));
  // The number is the task's own whatever part of the array is run: --array=3,4 runs shards 3 and 4.
  EXPECT_EQ(parse_shard("auto/4", environment_of({{"SLURM_ARRAY_TASK_ID", "3"}, {"SLURM_ARRAY_TASK_MIN", "3"}})),
            (Shard{3, 4}));
  EXPECT_EQ(parse_shard("auto/4", environment_of({{"JOB_COMPLETION_INDEX", "0"}})), (Shard{1, 4}));
  EXPECT_EQ(parse_shard("auto/4", environment_of({{"AWS_BATCH_JOB_ARRAY_INDEX", "3"}})), (Shard{4, 4}));
}

TEST(ParseShard, RefusesWhatNoSchedulerOrSeveralSay) {
  EXPECT_THROW(parse_shard("auto/4", environment_of({})), UsageError);
  EXPECT_THROW(parse_shard("auto/4", environment_of({{"SLURM_ARRAY_TASK_ID", "0"}})), UsageError);
  EXPECT_THROW(parse_shard("auto/4", environment_of({{"SLURM_ARRAY_TASK_ID", "5"}})), UsageError);
  EXPECT_THROW(parse_shard("auto/4", environment_of({{"JOB_COMPLETION_INDEX", "4"}})), UsageError);
  EXPECT_THROW(parse_shard("auto/4", environment_of({{"JOB_COMPLETION_INDEX", "two"}})), UsageError);
  EXPECT_THAT(
      [] {
        parse_shard("auto/4", environment_of({{"SLURM_ARRAY_TASK_ID", "1"}, {"AWS_BATCH_JOB_ARRAY_INDEX", "1"}}));
      },
      ThrowsMessage<UsageError>(HasSubstr("SLURM_ARRAY_TASK_ID and AWS_BATCH_JOB_ARRAY_INDEX")));
}

TEST(NumberList, JoinsRuns) {
  EXPECT_EQ(number_list({}), "");
  EXPECT_EQ(number_list({4}), "4");
  EXPECT_EQ(number_list({1, 3, 4, 5, 9, 10}), "1,3-5,9-10");
}

}  // namespace
}  // namespace pilotage
