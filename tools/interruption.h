#pragma once

namespace pilotage {

/// From now on SIGINT and SIGTERM are remembered instead of ending the process; a second one ends it at once.
void watch_for_interruption();

/// A signal has arrived since watch_for_interruption().
bool interruption_requested();

}  // namespace pilotage
