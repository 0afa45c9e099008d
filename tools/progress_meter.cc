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

double remaining_s(std::int64_t done, std::int64_t total, double per_second) {
  return static_cast<double>(std::max<std::int64_t>(total - done, 0)) / per_second;
}

double to_milliseconds(double seconds) {
  return std::round(seconds * 1000) / 1000;
}

}  // namespace

std::string progress_bar(std::string_view what, std::int64_t done, std::int64_t total, double per_second, int width) {
  std::string line(what);
  std::string tail;
  if (total > 0) {
    const double fraction = std::clamp(static_cast<double>(done) / static_cast<double>(total), 0.0, 1.0);
    tail = " " + format_fixed(std::floor(100 * fraction), 0) + " %";
    if (per_second > 0) {
      tail += "  " + format_rate(per_second) + "  " + format_duration(remaining_s(done, total, per_second)) + " left";
    }
    const int room = std::min(30, width - static_cast<int>(line.size() + tail.size()) - 3);
    if (room >= 5) {
      const auto filled = static_cast<std::size_t>(std::floor(fraction * room));
      line += " [" + std::string(filled, '#') + std::string(static_cast<std::size_t>(room) - filled, '.') + "]";
    }
  } else {
    tail = done == 0 ? " ..." : " " + std::to_string(done) + (per_second > 0 ? "  " + format_rate(per_second) : "");
  }
  line += tail;
  return line.substr(0, static_cast<std::size_t>(std::max(width, 0)));
}

ProgressMeter::ProgressMeter(std::ostream& stream, ProgressStyle style, int width, bool escapes)
    : stream_(stream), style_(style), width_(width), escapes_(escapes) {}

void ProgressMeter::begin(std::string_view what, std::int64_t done) {
  finish_lines();
  what_ = what;
  first_done_ = done;
  began_ = Clock::now();
}

void ProgressMeter::report(std::string_view what, std::int64_t done, std::int64_t total) {
  if (style_ == ProgressStyle::kNone) return;
  // A count that falls is the same kind of work once more, of the next level.
  const bool first = what != what_ || done < done_;
  if (first) begin(what, done);
  const bool last = total > 0 && done >= total && (first || done > done_);  // said once, however often it is reported
  done_ = done;
  total_ = total;
  pending_ = true;
  const auto now = Clock::now();
  const auto interval = std::chrono::milliseconds(style_ == ProgressStyle::kJson ? 250 : 100);
  if (first || last || now - shown_ >= interval) show(now);
}

void ProgressMeter::say(const std::string& prefix, const std::string& words) {
  if (style_ == ProgressStyle::kJson) return report(words, 0, 0);
  clear();
  stream_ << prefix << words << std::endl;
}

void ProgressMeter::show(Clock::time_point now) {
  shown_ = now;
  pending_ = false;
  const double elapsed_s = std::chrono::duration<double>(now - began_).count();
  const double per_second =
      elapsed_s > 0 && done_ > first_done_ ? static_cast<double>(done_ - first_done_) / elapsed_s : 0;
  if (style_ == ProgressStyle::kBar) return draw(progress_bar(what_, done_, total_, per_second, width_ - 1));
  nlohmann::ordered_json line = {
      {"what", what_}, {"done", done_}, {"total", total_}, {"elapsed_s", to_milliseconds(elapsed_s)}};
  line["remaining_s"] = total_ > 0 && per_second > 0
                            ? nlohmann::ordered_json(to_milliseconds(remaining_s(done_, total_, per_second)))
                            : nlohmann::ordered_json(nullptr);
  stream_ << line.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace) << std::endl;
}

void ProgressMeter::finish_lines() {
  if (pending_ && style_ == ProgressStyle::kJson) show(Clock::now());
}

void ProgressMeter::clear() {
  finish_lines();
  if (bar_visible_) draw("");
  bar_visible_ = false;
}

void ProgressMeter::draw(const std::string& line) {
  const std::string blanks(static_cast<std::size_t>(std::max(width_ - 1, 0)), ' ');
  stream_ << '\r' << (escapes_ ? "\x1b[K" : blanks + '\r') << line << std::flush;
  bar_visible_ = true;
}

}  // namespace pilotage
