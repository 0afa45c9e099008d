#include "interruption.h"

#include <atomic>
#include <csignal>

namespace pilotage {
namespace {

std::atomic<bool> requested{false};
static_assert(std::atomic<bool>::is_always_lock_free, "a signal handler may only touch lock-free atomics");

void remember(int /*signal*/) {
  requested = true;
}

}  // namespace

void watch_for_interruption() {
  struct sigaction action {};
  action.sa_handler = remember;
  ::sigemptyset(&action.sa_mask);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGXCPU, SIGPIPE}) {
    struct sigaction before {};
    const bool ignored = ::sigaction(signal, nullptr, &before) == 0 && before.sa_handler == SIG_IGN;
    if (ignored && signal == SIGHUP) continue;  // nohup: the work outlives the terminal
    // Every line that is written into a closed pipe sends one more: not a wish to end without cleaning up.
    action.sa_flags = signal == SIGPIPE ? 0 : static_cast<int>(SA_RESETHAND);
    ::sigaction(signal, &action, nullptr);
  }
  ::signal(SIGXFSZ, SIG_IGN);  // a file size limit fails the write, which is told like a full disk
}

bool interruption_requested() {
  return requested;
}

}  // namespace pilotage
