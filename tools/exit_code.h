#pragma once

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

}  // namespace pilotage
