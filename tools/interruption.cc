#include "interruption.h"

#include <atomic>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <mutex>
#include <system_error>
#include <thread>
#include <utility>

#include "exit_code.h"
#include <poll.h>
#include <pthread.h>
#include <semaphore.h>
#include <unistd.h>

#include "pilotage/base/work_folder.h"

namespace pilotage {
namespace {

constexpr auto kPatience = std::chrono::milliseconds(800);

std::atomic<bool> requested{false};
static_assert(std::atomic<bool>::is_always_lock_free, "a signal handler may only touch lock-free atomics");

/// What the thread that keeps deadlines knows. Never destroyed: it outlives main().
struct Keeper {
  sem_t signals{};
  std::mutex access;
  bool keeps_deadlines = false;
  std::function<void()> last_words;
};

Keeper& keeper() {
  static auto* const one = [] {
    auto* const made = new Keeper;
    ::sem_init(&made->signals, 0, 0);
    return made;
  }();
  return *one;
}

std::atomic<sem_t*> signals{nullptr};  // for the handler

void remember(int /*signal*/) {
  const int error = errno;
  requested = true;
  if (sem_t* const arrived = signals.load()) ::sem_post(arrived);
  errno = error;
}

/// A thread that hangs in writing there would hold up the last words, too.
bool takes_words() {
  pollfd streams[] = {{STDOUT_FILENO, POLLOUT, 0}, {STDERR_FILENO, POLLOUT, 0}};
  return ::poll(streams, 2, 0) == 2;
}

void keep_deadlines() {
  Keeper& all = keeper();
  for (;;) {
    if (::sem_wait(&all.signals) != 0) continue;
    std::this_thread::sleep_for(kPatience);
    const std::lock_guard lock(all.access);
    if (!all.keeps_deadlines) continue;
    try {
      abandon_work_folders();
      if (all.last_words && takes_words()) all.last_words();
    } catch (...) {  // as where memory is out: it ends all the same
    }
    ::_exit(kExitInterrupted);
  }
}

/// The thread gets no signals: those that arrive end the waiting of the others. Where no thread can be had there is no
/// deadline.
void start_keeper() {
  sigset_t all_signals;
  sigset_t before;
  ::sigfillset(&all_signals);
  ::pthread_sigmask(SIG_SETMASK, &all_signals, &before);
  try {
    std::thread(keep_deadlines).detach();
  } catch (const std::system_error&) {
  }
  ::pthread_sigmask(SIG_SETMASK, &before, nullptr);
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

InterruptionDeadline::InterruptionDeadline(std::function<void()> last_words) {
  Keeper& all = keeper();
  static std::once_flag started;
  std::call_once(started, start_keeper);
  signals = &all.signals;
  const std::lock_guard lock(all.access);
  all.keeps_deadlines = true;
  all.last_words = std::move(last_words);
}

InterruptionDeadline::~InterruptionDeadline() {
  const std::lock_guard lock(keeper().access);
  keeper().keeps_deadlines = false;
  keeper().last_words = nullptr;
}

void InterruptionDeadline::fall_silent() {
  const std::lock_guard lock(keeper().access);
  keeper().last_words = nullptr;
}

}  // namespace pilotage
