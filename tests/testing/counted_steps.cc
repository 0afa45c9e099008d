#include "testing/counted_steps.h"

#include <cstddef>

/// Of the sanitizers' runtime; g++ 12 brings the function and not its header.
extern "C" int __sanitizer_install_malloc_and_free_hooks(void (*taken)(const volatile void* at, std::size_t size),
                                                         void (*released)(const volatile void* at));

namespace {

thread_local std::uint64_t blocks = 0;
thread_local std::uint64_t allocations = 0;

__attribute__((no_sanitize_coverage)) void count_allocation(const volatile void* /*at*/, std::size_t /*size*/) {
  ++allocations;
}

__attribute__((no_sanitize_coverage)) void ignore_release(const volatile void* /*at*/) {}

const int hooks = __sanitizer_install_malloc_and_free_hooks(count_allocation, ignore_release);

}  // namespace

/// What -fsanitize-coverage=trace-pc calls at each block (gcc.gnu.org/onlinedocs, Instrumentation Options).
extern "C" __attribute__((no_sanitize_coverage, visibility("default"))) void __sanitizer_cov_trace_pc() {
  ++blocks;
}

namespace pilotage::testing {

CountedSteps counted_steps() {
  static_cast<void>(hooks);
  return {blocks, allocations};
}

}  // namespace pilotage::testing
