#include "progress_meter.h"

#include <algorithm>
#include <cmath>
#include <ostream>

#include <nlohmann/json.hpp>

#include "pilotage/base/text.h"

namespace pilotage {
namespace {

std::string format_duration(double seconds) {
  const auto whole = static_cast<std::int64_t>(std::llround(seconds));
  if (whole < 60) return std::to_string(whole) + " s";
  if (whole < 3600) return std::to_string(whole / 60) + " min " + std::to_string(whole % 60) + " s";
  return std::to_string(whole / 3600) + " h " + std::to_string(whole % 3600 / 60) + " min";
}

std::string format_rate(double per_second) {
  return format_fixed(per_second, per_second < 10 ? 1 : 0) + "/s";
}

}  // namespace

std::string progress_bar(std::string_view what, std::int64_t done, std::int64_t total, double elapsed_s, int width) {
  std::string line(what);
  const double rate = elapsed_s > 0 ? static_cast<double>(done) / elapsed_s : 0;
  std::string tail;
  if (total > 0) {
    const double fraction = std::clamp(static_cast<double>(done) / static_cast<double>(total), 0.0, 1.0);
    tail = " " + format_fixed(std::floor(100 * fraction), 0) + " %";
    if (rate > 0) {
      tail += "  " + format_rate(rate) + "  " +
              format_duration(static_cast<double>(std::max<std::int64_t>(total - done, 0)) / rate) + " left";
    }
    const int room = std::min(30, width - static_cast<int>(line.size() + tail.size()) - 3);
    if (room >= 5) {
      const auto filled = static_cast<std::size_t>(std::floor(fraction * room));
      line += " [" + std::string(filled, '#') + std::string(static_cast<std::size_t>(room) - filled, '.') + "]";
    }
  } else {
    tail = " " + std::to_string(done) + (rate > 0 ? "  " + format_rate(rate) : "");
  }
  line += tail;
  return line.substr(0, static_cast<std::size_t>(std::max(width, 0)));
}

ProgressMeter::ProgressMeter(std::ostream& stream, ProgressStyle style, int width, bool escapes)
    : stream_(stream), style_(style), width_(width), escapes_(escapes) {}

void ProgressMeter::report(std::string_view what, std::int64_t done, std::int64_t total) {
  if (style_ == ProgressStyle::kNone) return;
  const auto now = Clock::now();
  const bool first = what != what_;
  if (first) {
    what_ = what;
    began_ = now;
  }
  const auto interval = std::chrono::milliseconds(style_ == ProgressStyle::kJson ? 250 : 100);
  const bool last = total > 0 && done >= total;
  if (!first && !last && now - shown_ < interval) return;
  shown_ = now;
  const double elapsed_s = std::chrono::duration<double>(now - began_).count();
  if (style_ == ProgressStyle::kBar) return draw(progress_bar(what, done, total, elapsed_s, width_ - 1));
  const nlohmann::ordered_json line = {
      {"what", what}, {"done", done}, {"total", total}, {"elapsed_s", std::round(elapsed_s * 1000) / 1000}};
  stream_ << line.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace) << std::endl;
}

void ProgressMeter::clear() {
  if (bar_visible_) draw("");
  bar_visible_ = false;
}

void ProgressMeter::draw(const std::string& line) {
  const std::string blanks(static_cast<std::size_t>(std::max(width_ - 1, 0)), ' ');
  stream_ << '\r' << (escapes_ ? "\x1b[K" : blanks + '\r') << line << std::flush;
  bar_visible_ = true;
}

}  // namespace pilotage
