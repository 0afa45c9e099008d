#pragma once

#include <functional>

namespace pilotage {

/// From now on SIGINT, SIGTERM, SIGHUP (unless it is ignored, as under nohup), SIGQUIT, SIGXCPU and SIGPIPE are
/// remembered instead of ending the process, so that it removes what is unfinished; a second one of the same kind, but
/// SIGPIPE, ends it at once.
void watch_for_interruption();

/// A signal has arrived since watch_for_interruption().
bool interruption_requested();

/// While one lives, a signal ends the process within a second, wherever its threads are: who has not noticed it 0.8 s
/// after it came, as inside a library's call, is ended with kExitInterrupted when unfinished outputs are removed
/// (abandon_work_folders()). Outputs that move to their places at that time are waited for, as is a disk that does not
/// answer. One at a time.
class InterruptionDeadline {
 public:
  /// `last_words`: said by another thread, before the process ends.
  explicit InterruptionDeadline(std::function<void()> last_words);
  /// A deadline that has passed by now is kept: it does not return.
  ~InterruptionDeadline();
  InterruptionDeadline(const InterruptionDeadline&) = delete;
  InterruptionDeadline& operator=(const InterruptionDeadline&) = delete;

  /// From now on the process ends without last words: others are being said.
  void fall_silent();
};

}  // namespace pilotage
