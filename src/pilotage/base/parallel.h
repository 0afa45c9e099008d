#pragma once

#include <cstddef>
#include <functional>

namespace pilotage {

/// The number of threads that `requested` stands for: itself when positive, the machine's cores when 0.
int thread_count(int requested);

/// Calls `body(index, worker)` once for each index in [0, count), on up to `threads` threads (0 = all cores).
/// `worker` is in [0, thread_count(threads)) and never used by two calls at a time, so a body may keep scratch space
/// per worker. Which worker gets which index is not defined: a body writes its result by index, so results do not
/// depend on the number of threads. The exception of the lowest index that throws is thrown again here, after all calls
/// have ended.
///
/// The caller works as worker 0; the others are threads that all loops of the process share and that stay until it
/// ends, as many as the widest loop has asked for. A loop inside another, or beside it, gets those that are free, so
/// loops in loops never make more threads. May be called from any thread, also while holding a lock that other bodies
/// want.
void parallel_for(std::size_t count, int threads, const std::function<void(std::size_t index, int worker)>& body);

}  // namespace pilotage
