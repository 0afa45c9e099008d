#include "pilotage/base/parallel.h"

#include <atomic>
#include <mutex>
#include <numeric>
#include <set>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

namespace pilotage {
namespace {

TEST(ParallelFor, CallsEachIndexOnce) {
  for (const std::size_t count : {0U, 1U, 2U, 7U, 1000U}) {
    for (const int threads : {0, 1, 2, 5, 32}) {
      std::vector<std::atomic<int>> calls(count);
      parallel_for(count, threads, [&](std::size_t index, int) { ++calls[index]; });
      for (const auto& times : calls) EXPECT_EQ(times, 1) << count << " " << threads;
    }
  }
}

TEST(ParallelFor, AWorkerIsInRangeAndNeverUsedTwiceAtATime) {
  constexpr int kThreads = 4;
  std::vector<std::atomic<int>> in_use(kThreads);
  parallel_for(2000, kThreads, [&](std::size_t, int worker) {
    ASSERT_GE(worker, 0);
    ASSERT_LT(worker, kThreads);
    EXPECT_EQ(in_use[static_cast<std::size_t>(worker)]++, 0);
    std::this_thread::yield();
    --in_use[static_cast<std::size_t>(worker)];
  });
}

// The loop ends only when as many threads as were asked for work on it at the same time.
TEST(ParallelFor, WorksOnAsManyThreadsAsAskedFor) {
  constexpr int kThreads = 6;
  std::atomic<int> here{0};
  std::mutex mutex;
  std::set<std::thread::id> ids;
  parallel_for(kThreads, kThreads, [&](std::size_t, int) {
    ++here;
    while (here < kThreads) std::this_thread::yield();
    const std::lock_guard lock(mutex);
    ids.insert(std::this_thread::get_id());
  });
  EXPECT_EQ(ids.size(), static_cast<std::size_t>(kThreads));
  EXPECT_TRUE(ids.contains(std::this_thread::get_id())) << "the caller works too";
}

TEST(ParallelFor, OneThreadIsTheCallersAndGoesInOrder) {
  std::vector<std::size_t> order;
  parallel_for(100, 1, [&](std::size_t index, int worker) {
    EXPECT_EQ(worker, 0);
    order.push_back(index);
  });
  std::vector<std::size_t> expected(100);
  std::iota(expected.begin(), expected.end(), 0U);
  EXPECT_EQ(order, expected);
}

// Each loop ends only when all its threads have come. When loops made threads of their own, these were 301.
TEST(ParallelFor, LoopsShareTheirThreads) {
  constexpr int kThreads = 4;
  static std::atomic<int> threads_seen{0};
  struct Arrival {
    Arrival() { ++threads_seen; }
  };
  for (int loop = 0; loop < 100; ++loop) {
    std::atomic<int> here{0};
    parallel_for(kThreads, kThreads, [&](std::size_t, int) {
      thread_local const Arrival arrival;
      ++here;
      while (here < kThreads) std::this_thread::yield();
    });
  }
  EXPECT_LE(threads_seen, 32) << "the most that a test of this program asks for";
}

TEST(ParallelFor, LoopsMayStandInsideOneAnother) {
  constexpr std::size_t kOuter = 20;
  constexpr std::size_t kInner = 30;
  std::vector<std::atomic<int>> calls(kOuter * kInner * 3);
  parallel_for(kOuter, 3, [&](std::size_t a, int) {
    parallel_for(kInner, 4, [&](std::size_t b, int) {
      parallel_for(3, 2, [&](std::size_t c, int) { ++calls[(a * kInner + b) * 3 + c]; });
    });
  });
  for (const auto& times : calls) EXPECT_EQ(times, 1);
}

// A body may hold a lock that other bodies want while it runs a loop: no other work is taken up inside it.
TEST(ParallelFor, ALoopMayRunUnderALock) {
  std::mutex mutex;
  std::size_t sum = 0;
  parallel_for(40, 4, [&](std::size_t, int) {
    const std::lock_guard lock(mutex);
    std::atomic<std::size_t> part{0};
    parallel_for(10, 4, [&](std::size_t index, int) { part += index; });
    sum += part;
  });
  EXPECT_EQ(sum, 40U * 45U);
}

TEST(ParallelFor, ManyMayCallItAtOnce) {
  std::atomic<std::size_t> calls{0};
  {
    std::vector<std::jthread> callers;
    for (int caller = 0; caller < 6; ++caller) {
      callers.emplace_back([&] {
        for (int loop = 0; loop < 20; ++loop) parallel_for(25, 3, [&](std::size_t, int) { ++calls; });
      });
    }
  }
  EXPECT_EQ(calls, 6U * 20U * 25U);
}

TEST(ParallelFor, ThrowsTheFirstOfTheErrorsAfterAllHaveEnded) {
  for (const int threads : {1, 2, 5}) {
    std::atomic<int> at_work{0};
    try {
      parallel_for(100, threads, [&](std::size_t index, int) {
        ++at_work;
        std::this_thread::yield();
        --at_work;
        if (index >= 10) throw std::runtime_error(std::to_string(index));
      });
      FAIL() << "no error";
    } catch (const std::runtime_error& error) {
      EXPECT_EQ(at_work, 0);
      // Indices are taken in order, so the lowest that throws is always among those taken.
      EXPECT_STREQ(error.what(), "10");
    }
  }
}

TEST(ParallelFor, AnErrorOfAnInnerLoopComesThroughAndTheNextLoopWorks) {
  EXPECT_THROW(parallel_for(8, 4,
                            [](std::size_t outer, int) {
                              parallel_for(8, 4, [&](std::size_t inner, int) {
                                if (outer == 5 && inner == 3) throw std::runtime_error("inner");
                              });
                            }),
               std::runtime_error);
  std::atomic<int> calls{0};
  parallel_for(64, 4, [&](std::size_t, int) { ++calls; });
  EXPECT_EQ(calls, 64);
}

}  // namespace
}  // namespace pilotage
