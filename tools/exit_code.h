#pragma once

#include <string>
#include <utility>
#include <vector>

namespace pilotage {

/// What the program says to its caller (docs/conventions.md).
enum ExitCode : int {
  kExitDone = 0,
  kExitFailed = 1,         ///< Data or runtime error: DataError, out of memory, any other exception.
  kExitUsage = 2,          ///< UsageError: unknown command or option, a value that is not allowed.
  kExitGateNotMet = 3,     ///< Done, but a gate the user asked for is not met; a command's result says it.
  kExitIntegrity = 4,      ///< IntegrityError: a digest or a signature is wrong.
  kExitTryAgain = 75,      ///< EX_TEMPFAIL of sysexits.h, for schedulers; a command's result says it.
  kExitInterrupted = 130,  ///< SIGINT or SIGTERM; outputs are removed.
};

/// The same for people: code and meaning.
inline std::vector<std::pair<int, std::string>> exit_codes() {
  return {{kExitDone, "Done."},
          {kExitFailed, "Data or runtime error."},
          {kExitUsage, "Usage: unknown command or option, a value that is not allowed."},
          {kExitGateNotMet, "Done, but a gate that was asked for is not met."},
          {kExitIntegrity, "A digest or a signature is wrong."},
          {kExitTryAgain, "Try again later (for a scheduler)."},
          {kExitInterrupted, "Interrupted by SIGINT or SIGTERM; a second signal ends the program at once."}};
}

}  // namespace pilotage
