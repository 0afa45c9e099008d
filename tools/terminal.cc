#include "terminal.h"

#include <cstdlib>
#include <iostream>
#include <string_view>

#include <sys/ioctl.h>
#include <unistd.h>

namespace pilotage {
namespace {

bool is_terminal(const std::ostream& stream) {
  return &stream == &std::cerr && ::isatty(STDERR_FILENO) == 1;
}

bool understands_escapes() {
  const char* terminal = std::getenv("TERM");
  return terminal != nullptr && std::string_view(terminal) != "dumb" && *terminal != '\0';
}

int terminal_width() {
  winsize size{};
  if (::ioctl(STDERR_FILENO, TIOCGWINSZ, &size) != 0 || size.ws_col == 0) return 80;
  return size.ws_col;
}

}  // namespace

ProgressMeter make_progress_meter(ProgressMode mode, std::ostream& stream) {
  ProgressStyle style = ProgressStyle::kNone;
  if (mode == ProgressMode::kJson) style = ProgressStyle::kJson;
  if (mode == ProgressMode::kAuto && is_terminal(stream)) style = ProgressStyle::kBar;
  return ProgressMeter(stream, style, terminal_width(), understands_escapes());
}

bool wants_colour(const std::ostream& stream) {
  const char* no_colour = std::getenv("NO_COLOR");
  return is_terminal(stream) && understands_escapes() && (no_colour == nullptr || *no_colour == '\0');
}

}  // namespace pilotage
