#include "pilotage/base/parallel.h"

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <deque>
#include <exception>
#include <limits>
#include <mutex>
#include <system_error>
#include <thread>
#include <vector>

namespace pilotage {
namespace {

/// The indices of one call of parallel_for, taken one after the other by whoever works on it.
class Loop {
 public:
  Loop(std::size_t count, const std::function<void(std::size_t, int)>& body) : count_(count), body_(body) {}

  void work(int worker) {
    while (!failed_) {
      const std::size_t index = next_++;
      if (index >= count_) return;
      try {
        body_(index, worker);
      } catch (...) {
        const std::lock_guard lock(mutex_);
        if (index < error_index_) {
          error_index_ = index;
          error_ = std::current_exception();
        }
        failed_ = true;
      }
    }
  }

  /// When nobody works on it any more.
  void rethrow() const {
    if (error_) std::rethrow_exception(error_);
  }

 private:
  const std::size_t count_;
  const std::function<void(std::size_t, int)>& body_;
  std::atomic<std::size_t> next_{0};
  std::atomic<bool> failed_{false};
  std::mutex mutex_;
  std::exception_ptr error_;
  std::size_t error_index_ = std::numeric_limits<std::size_t>::max();
};

/// The threads that help the callers of parallel_for; they stay for the next loop. A caller never waits for a helper to
/// be free, and while it waits for one to end it takes up no other work, so a loop may run inside another, and under a
/// lock.
class Helpers {
 public:
  ~Helpers() {
    {
      const std::lock_guard lock(mutex_);
      ending_ = true;
    }
    offered_.notify_all();
    threads_.clear();  // joins
  }

  /// Runs `loop` on this thread as worker 0 and on up to `helpers` others.
  void run(Loop& loop, int helpers) {
    {
      const std::lock_guard lock(mutex_);
      start_threads(static_cast<std::size_t>(helpers));
      for (int worker = 1; worker <= helpers; ++worker) places_.push_back({&loop, worker});
    }
    for (int i = 0; i < helpers; ++i) offered_.notify_one();
    loop.work(0);
    std::unique_lock lock(mutex_);
    std::erase_if(places_, [&](const Place& place) { return place.loop == &loop; });
    left_.wait(lock, [&] { return std::ranges::find(taken_, &loop) == taken_.end(); });
  }

 private:
  /// A helper may work on `loop` as `worker`.
  struct Place {
    Loop* loop = nullptr;
    int worker = 0;
  };

  void start_threads(std::size_t count) {
    try {
      while (threads_.size() < count) threads_.emplace_back([this] { help(); });
    } catch (const std::system_error&) {
      // The machine gives no more: the loop is worked off by those that are there, or by its caller alone.
    }
  }

  void help() {
    std::unique_lock lock(mutex_);
    while (true) {
      offered_.wait(lock, [&] { return ending_ || !places_.empty(); });
      if (ending_) return;
      const Place place = places_.front();
      places_.pop_front();
      taken_.push_back(place.loop);
      lock.unlock();
      place.loop->work(place.worker);
      lock.lock();
      taken_.erase(std::ranges::find(taken_, place.loop));
      left_.notify_all();
    }
  }

  std::mutex mutex_;
  std::condition_variable offered_;
  std::condition_variable left_;
  std::deque<Place> places_;  ///< Not taken yet.
  std::vector<Loop*> taken_;  ///< One entry for each helper at work.
  std::vector<std::jthread> threads_;
  bool ending_ = false;
};

}  // namespace

int thread_count(int requested) {
  if (requested > 0) return requested;
  return std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

void parallel_for(std::size_t count, int threads, const std::function<void(std::size_t, int)>& body) {
  static Helpers helpers;
  const auto workers = static_cast<int>(std::min<std::size_t>(static_cast<std::size_t>(thread_count(threads)), count));
  Loop loop(count, body);
  if (workers > 1) {
    helpers.run(loop, workers - 1);
  } else if (workers == 1) {
    loop.work(0);
  }
  loop.rethrow();
}

}  // namespace pilotage
