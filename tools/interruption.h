#pragma once

namespace pilotage {

/// From now on SIGINT, SIGTERM, SIGHUP (unless it is ignored, as under nohup), SIGQUIT, SIGXCPU and SIGPIPE are
/// remembered instead of ending the process, so that it removes what is unfinished; a second one of the same kind, but
/// SIGPIPE, ends it at once.
void watch_for_interruption();

/// A signal has arrived since watch_for_interruption().
bool interruption_requested();

}  // namespace pilotage
