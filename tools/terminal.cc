#include "terminal.h"

#include <cstdlib>
#include <iostream>
#include <string_view>

#include <sys/ioctl.h>
#include <unistd.h>

namespace pilotage {
namespace {

bool is_set(const char* variable) {
  const char* value = std::getenv(variable);
  return value != nullptr && *value != '\0';
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

bool is_terminal(const std::ostream& stream) {
  if (&stream == &std::cerr) return ::isatty(STDERR_FILENO) == 1;
  return &stream == &std::cout && ::isatty(STDOUT_FILENO) == 1;
}

ProgressMeter make_progress_meter(ProgressMode mode, std::ostream& stream) {
  ProgressStyle style = ProgressStyle::kNone;
  if (mode == ProgressMode::kJson) style = ProgressStyle::kJson;
  if (mode == ProgressMode::kAuto && &stream == &std::cerr && is_terminal(stream)) style = ProgressStyle::kBar;
  return ProgressMeter(stream, style, terminal_width(), understands_escapes());
}

bool wants_colour(const std::ostream& stream) {
  if (is_set("NO_COLOR")) return false;
  if (is_set("CLICOLOR_FORCE") && std::string_view(std::getenv("CLICOLOR_FORCE")) != "0") return true;
  return is_terminal(stream) && understands_escapes();
}

}  // namespace pilotage
