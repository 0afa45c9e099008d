// From frames of a camera to positions for an autopilot, over MAVLink: match, navigation filter, messages. README.md
// beside this file says how to run it and what the autopilot is to be told.
#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <exception>
#include <future>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "arguments.h"
#include "flight.h"
#include "link.h"
#include "mavlink.h"
#include "pgm_stream.h"
#include "recording.h"
#include <opencv2/core.hpp>
#include <pilotage/onboard.h>
#include <poll.h>
#include <unistd.h>

namespace {

std::atomic<bool> is_to_end = false;

std::int64_t now_us() {
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  return std::chrono::duration_cast<std::chrono::microseconds>(now).count();
}

pilotage::MapReader open_map(const Arguments& arguments) {
  if (arguments.unverified) return pilotage::MapReader::open_unverified(arguments.map);
  pilotage::MapReader map = pilotage::MapReader::open(arguments.map, {arguments.public_key});
  pilotage::MapRequirements required;
  required.now = std::chrono::floor<std::chrono::seconds>(std::chrono::system_clock::now());
  pilotage::check_purpose(map, required);
  return map;
}

/// The matcher, with the camera that the map was prepared for.
class Matcher {
 public:
  explicit Matcher(pilotage::MapReader& map) : map_(map) {
    if (!map.camera()) throw std::runtime_error("the map does not say for which camera it was prepared");
  }
  pilotage::MatchResult operator()(const cv::Mat& frame, const MatchTask& task) const {
    const pilotage::Camera camera = pilotage::camera_for_size("picture", *map_.camera(), frame.cols, frame.rows);
    return pilotage::match(frame, task.prior, camera, map_, task.options);
  }

 private:
  pilotage::MapReader& map_;
};

/// Pictures from standard input. Without a wait where `blocks` is false.
class Pictures {
 public:
  Pictures(bool blocks, double latency_s) : blocks_(blocks), latency_us_(static_cast<std::int64_t>(latency_s * 1e6)) {}

  bool have_ended() const { return have_ended_; }

  /// The next one, whose exposure is known then.
  std::optional<TimedFrame> next() {
    while (true) {
      auto frame = stream_.next();
      if (frame) {
        if (!frame->exposure_us) frame->exposure_us = begun_us_ - latency_us_;
        begun_us_ = now_us();  // of what has come with it already
        return frame;
      }
      if (have_ended_ || !(blocks_ || has_come())) return std::nullopt;
      std::array<std::uint8_t, 65536> bytes{};
      const ssize_t count = ::read(STDIN_FILENO, bytes.data(), bytes.size());
      if (!stream_.within()) begun_us_ = now_us();
      if (count > 0) stream_.push(std::span(bytes).first(static_cast<std::size_t>(count)));
      have_ended_ = count == 0;
      if (have_ended_ && stream_.within()) std::fprintf(stderr, "autopilot_example: the last picture is not whole\n");
    }
  }

 private:
  static bool has_come() {
    pollfd input{STDIN_FILENO, POLLIN, 0};
    return ::poll(&input, 1, 0) > 0;
  }

  bool blocks_;
  std::int64_t latency_us_;
  PgmStream stream_;
  std::int64_t begun_us_ = 0;
  bool have_ended_ = false;
};

/// What an autopilot that takes positions for new when they arrive has to be told (PX4's EKF2_AGPn_DELAY).
void say_latency(std::vector<std::int64_t> latencies_us) {
  if (latencies_us.empty()) return;
  std::sort(latencies_us.begin(), latencies_us.end());
  std::fprintf(stderr, "autopilot_example: from exposure to answer %.0f ms in the middle, at most %.0f ms\n",
               static_cast<double>(latencies_us[latencies_us.size() / 2]) / 1e3,
               static_cast<double>(latencies_us.back()) / 1e3);
}

/// In the air: until a signal ends it.
void fly(const Arguments& arguments, Flight& flight, Link& link, RecordingWriter* record, const Matcher& match) {
  struct Waiting {
    MatchTask task;
    cv::Mat pixels;
  };
  mavlink::Reader reader;
  Pictures pictures(false, arguments.flight.camera_latency_s);
  std::optional<TimedFrame> arrived;
  std::optional<Waiting> waiting;
  MatchTask asked;
  std::future<pilotage::MatchResult> answer;
  std::vector<std::int64_t> latencies_us;
  while (!is_to_end) {
    std::array<pollfd, 2> inputs = {{{link.descriptor(), POLLIN, 0}, {STDIN_FILENO, POLLIN, 0}}};
    ::poll(inputs.data(), pictures.have_ended() ? 1 : 2, 5);
    for (auto bytes = link.receive(); !bytes.empty(); bytes = link.receive()) {
      reader.push(bytes);
      while (const auto message = reader.next()) {
        const std::int64_t heard_us = now_us();
        if (record != nullptr) record->write(heard_us, message->frame);
        flight.hear(*message, heard_us);
      }
    }
    while (auto frame = pictures.next()) {
      if (arrived) flight.skip_frame();
      arrived = std::move(frame);
    }
    if (arrived && !waiting && flight.may_begin(*arrived->exposure_us, now_us())) {
      if (const auto task = flight.begin(*arrived->exposure_us)) waiting = {*task, arrived->pixels};
      arrived.reset();
    }
    if (answer.valid() && answer.wait_for(std::chrono::seconds(0)) == std::future_status::ready) {
      flight.end(asked, answer.get(), now_us());
      latencies_us.push_back(now_us() - asked.exposure_us);
    }
    if (waiting && !answer.valid()) {
      asked = waiting->task;
      answer = std::async(std::launch::async, [&match, now = *std::exchange(waiting, std::nullopt)] {
        return match(now.pixels, now.task);
      });
    }
    flight.go_on(now_us());
  }
  say_latency(std::move(latencies_us));
}

/// On the ground: a recorded flight again, every frame matched in no time.
void fly_again(const Arguments& arguments, Flight& flight, std::int64_t& clock_us, RecordingWriter* record,
               const Matcher& match) {
  RecordingReader recording(arguments.recording);
  mavlink::Reader reader;
  Pictures pictures(true, 0);
  std::optional<TimedFrame> frame = pictures.next();
  while (const auto entry = recording.next()) {
    if (is_to_end) return;
    clock_us = entry->time_us;
    reader.push(entry->frame);
    while (const auto message = reader.next()) {
      if (record != nullptr) record->write(clock_us, message->frame);
      flight.hear(*message, clock_us);
    }
    while (frame && *frame->exposure_us <= clock_us && flight.may_begin(*frame->exposure_us, clock_us)) {
      if (const auto task = flight.begin(*frame->exposure_us)) {
        flight.end(*task, match(frame->pixels, *task), clock_us);
      }
      frame = pictures.next();
    }
    flight.go_on(clock_us);
  }
}

void run(const Arguments& arguments) {
  pilotage::MapReader map = open_map(arguments);
  const Matcher match(map);
  std::unique_ptr<RecordingWriter> record;
  if (!arguments.record.empty()) record = std::make_unique<RecordingWriter>(arguments.record);
  std::unique_ptr<Link> link;
  if (!arguments.link.empty()) link = std::make_unique<Link>(arguments.link);
  std::int64_t recorded_us = 0;
  const auto send = [&](const mavlink::Bytes& frame) {
    if (record) record->write(link ? now_us() : recorded_us, frame);
    if (link) link->send(frame);
  };
  Flight flight(arguments.flight, map.largest_map_sigma_m(), send);
  if (link) {
    fly(arguments, flight, *link, record.get(), match);
  } else {
    fly_again(arguments, flight, recorded_us, record.get(), match);
  }
  std::fprintf(stderr, "autopilot_example: %s\n", flight.summary().c_str());
}

}  // namespace

int main(int argc, char** argv) {
  if (argc == 2 && std::string(argv[1]) == "--help") {
    std::fputs(kUsage, stdout);
    return 0;
  }
  const auto end = [](int) { is_to_end = true; };
  std::signal(SIGINT, end);
  std::signal(SIGTERM, end);
  std::signal(SIGPIPE, SIG_IGN);
  try {
    run(read_arguments(argc, argv));
    return 0;
  } catch (const std::invalid_argument& error) {
    std::fprintf(stderr, "autopilot_example: %s\n%s", error.what(), kUsage);
    return 2;
  } catch (const std::exception& error) {  // a map, a link or a recording that cannot be used
    std::fprintf(stderr, "autopilot_example: %s\n", error.what());
    return 1;
  }
}
