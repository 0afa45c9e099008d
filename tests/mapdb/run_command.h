#pragma once

#include <array>
#include <cstdio>
#include <string>

#include <sys/wait.h>

namespace pilotage::testing {

struct CommandOutcome {
  int status = -1;     ///< Exit code; -1 when it could not be run.
  std::string output;  ///< Of both streams.
};

/// Runs a shell command.
inline CommandOutcome run_command(const std::string& command) {
  CommandOutcome outcome;
  std::FILE* pipe = ::popen(("{ " + command + "\n} 2>&1").c_str(), "r");
  if (pipe == nullptr) return outcome;
  std::array<char, 4096> buffer{};
  while (const std::size_t got = std::fread(buffer.data(), 1, buffer.size(), pipe)) {
    outcome.output.append(buffer.data(), got);
  }
  const int status = ::pclose(pipe);
  outcome.status = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  return outcome;
}

}  // namespace pilotage::testing
