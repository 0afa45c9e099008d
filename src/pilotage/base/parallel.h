#pragma once

#include <cstddef>
#include <functional>

namespace pilotage {

/// The number of threads that `requested` stands for: itself when positive, the machine's cores when 0.
int thread_count(int requested);

/// Calls `body(index, worker)` once for each index in [0, count), on up to `threads` threads (0 = all cores).
/// `worker` is in [0, thread_count(threads)) and never used by two calls at a time, so a body may keep scratch space
/// per worker. Which worker gets which index is not defined: a body writes its result by index, so results do not
/// depend on the number of threads. The first exception (lowest index among those thrown) is thrown again here, after
/// all threads have ended.
void parallel_for(std::size_t count, int threads, const std::function<void(std::size_t index, int worker)>& body);

}  // namespace pilotage
