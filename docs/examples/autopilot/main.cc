// From frames of a camera to positions for an autopilot, over MAVLink: match, navigation filter, messages. README.md
// beside this file says how to run it and what the autopilot is to be told.
#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <ctime>
#include <exception>
#include <future>
#include <memory>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <thread>
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

std::int64_t microseconds_of(clockid_t clock) {
  timespec time{};
  ::clock_gettime(clock, &time);
  return std::int64_t{time.tv_sec} * 1'000'000 + time.tv_nsec / 1000;
}

/// Since 1970, as this computer's clock had it when the program began: it neither steps nor changes its pace when that
/// is set.
std::int64_t now_us() {
  static const std::int64_t since_1970_us = microseconds_of(CLOCK_REALTIME) - microseconds_of(CLOCK_MONOTONIC_RAW);
  return microseconds_of(CLOCK_MONOTONIC_RAW) + since_1970_us;
}

/// Each for the camera that the first was prepared for.
std::vector<pilotage::MapReader> open_maps(const Arguments& arguments) {
  std::vector<std::string> paths = arguments.also_map;
  paths.insert(paths.begin(), arguments.map);
  pilotage::MapRequirements required;
  if (!arguments.unverified) {
    required.now = std::chrono::floor<std::chrono::seconds>(std::chrono::system_clock::now());
  }
  std::vector<pilotage::MapReader> maps;
  for (const std::string& path : paths) {
    maps.push_back(arguments.unverified ? pilotage::MapReader::open_unverified(path)
                                        : pilotage::MapReader::open(path, {arguments.public_key}));
    pilotage::check_purpose(maps.back(), required);
    required.camera = maps.front().camera();
  }
  return maps;
}

/// Of where they lie: of the worst of them, and of one that does not say it what match() takes; nothing where none
/// says it.
std::optional<double> largest_map_sigma_m(std::vector<pilotage::MapReader>& maps) {
  std::optional<double> largest_m;
  bool all_say = true;
  for (pilotage::MapReader& map : maps) {
    const std::optional<double> sigma_m = map.largest_map_sigma_m();
    largest_m = std::max(largest_m, sigma_m);
    all_say = all_say && sigma_m;
  }
  return largest_m && !all_say ? std::max(*largest_m, pilotage::kUnknownMapSigma_m) : largest_m;
}

/// The matcher, with the camera that the maps were prepared for.
class Matcher {
 public:
  explicit Matcher(std::vector<pilotage::MapReader>& maps) : camera_(maps.front().camera()) {
    if (!camera_) throw std::runtime_error("the map does not say for which camera it was prepared");
    for (pilotage::MapReader& map : maps) maps_.push_back(&map);
  }
  /// A picture of another shape than the camera's has a status, as match() gives it.
  pilotage::MatchResult operator()(const cv::Mat& frame, const MatchTask& task) const {
    pilotage::Camera camera = *camera_;
    try {
      camera = pilotage::camera_for_size("picture", camera, frame.cols, frame.rows);
    } catch (const pilotage::DataError&) {
    }
    return pilotage::match(frame, task.prior, camera, maps_, task.options);
  }

 private:
  std::optional<pilotage::Camera> camera_;
  std::vector<pilotage::MapReader*> maps_;
};

/// Pictures from standard input. Without a wait where `blocks` is false.
class Pictures {
 public:
  Pictures(bool blocks, double latency_s) : blocks_(blocks), latency_us_(static_cast<std::int64_t>(latency_s * 1e6)) {}

  bool have_ended() const { return have_ended_; }

  /// The next one. Of one that does not say when it was exposed, that is known by its first byte; not where `blocks`.
  /// Throws std::runtime_error for what is no picture.
  std::optional<TimedFrame> next() {
    while (true) {
      auto frame = stream_.next();
      if (frame) {
        if (!blocks_) {
          const std::int64_t set_us = now_us() - microseconds_of(CLOCK_REALTIME);  // what that clock was set by
          frame->exposure_us = frame->exposure_us ? *frame->exposure_us + set_us : begun_us_ - latency_us_;
        }
        begun_us_ = now_us();  // of what has come with it already
        return frame;
      }
      if (have_ended_ || is_to_end || !(blocks_ || has_come())) return std::nullopt;
      std::array<std::uint8_t, 65536> bytes{};
      const ssize_t count = ::read(STDIN_FILENO, bytes.data(), bytes.size());
      if (!stream_.within()) begun_us_ = now_us();
      if (count > 0) stream_.push(std::span(bytes).first(static_cast<std::size_t>(count)));
      have_ended_ = count == 0 || (count < 0 && errno != EINTR && errno != EAGAIN);
      if (have_ended_ && stream_.within()) std::fprintf(stderr, "autopilot_example: the last picture is not whole\n");
    }
  }
  void end() { have_ended_ = true; }

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

/// What is heard and said, as long as the disk takes it.
class Record {
 public:
  explicit Record(const std::string& path) {
    if (!path.empty()) writer_.emplace(path);
  }
  void operator()(std::int64_t time_us, std::span<const std::uint8_t> frame) {
    try {
      if (writer_) writer_->write(time_us, frame);
    } catch (const std::runtime_error& error) {  // the aircraft flies on without
      std::fprintf(stderr, "autopilot_example: %s\n", error.what());
      writer_.reset();
    }
  }

 private:
  std::optional<RecordingWriter> writer_;
};

/// One frame in the matcher and one that waits for it. A later one takes the place of that: the filter remembers four.
class FramesAtWork {
 public:
  FramesAtWork(Flight& flight, const Matcher& match) : flight_(flight), match_(match) {}

  bool takes(std::int64_t exposure_us) const {
    constexpr std::int64_t kApart_us = 200'000;
    constexpr int kMost = 3;  // begun while one is in the matcher
    return !waiting_ || (begun_meanwhile_ < kMost && exposure_us - waiting_->task.exposure_us >= kApart_us);
  }

  void take(const MatchTask& task, const cv::Mat& pixels) {
    if (waiting_) flight_.drop(waiting_->task);
    waiting_ = {task, pixels};
    ++begun_meanwhile_;
  }

  void go_on() {
    if (answer_.valid() && answer_.wait_for(std::chrono::seconds(0)) == std::future_status::ready) {
      flight_.end(asked_, answer_.get(), now_us());
      latencies_us_.push_back(now_us() - asked_.exposure_us);
    }
    if (!waiting_ || answer_.valid()) return;
    asked_ = waiting_->task;
    begun_meanwhile_ = 0;
    answer_ = std::async(std::launch::async,
                         [this, now = *std::exchange(waiting_, std::nullopt)] { return match_(now.pixels, now.task); });
  }

  std::vector<std::int64_t> latencies_us() const { return latencies_us_; }

 private:
  struct Waiting {
    MatchTask task;
    cv::Mat pixels;
  };

  Flight& flight_;
  const Matcher& match_;
  std::optional<Waiting> waiting_;
  int begun_meanwhile_ = 0;
  MatchTask asked_;
  std::vector<std::int64_t> latencies_us_;
  std::future<pilotage::MatchResult> answer_;  // last: its end is waited for while the others are there
};

/// A picture that has come; those that come while it waits for the IMU are skipped, and those of the future.
void take_pictures(Pictures& pictures, std::optional<TimedFrame>& arrived, Flight& flight) {
  try {
    while (auto frame = pictures.next()) {
      if (*frame->exposure_us > now_us()) {
        flight.skip("of the future");
        flight.warn("pictures of the future", now_us());
      } else if (arrived) {
        flight.skip("while another waited");
      } else {
        arrived = std::move(frame);
      }
    }
  } catch (const std::runtime_error& error) {
    std::fprintf(stderr, "autopilot_example: %s\n", error.what());
    pictures.end();
  }
  if (pictures.have_ended()) flight.warn("no more pictures", now_us());
}

/// In the air: until a signal ends it.
void fly(const Arguments& arguments, Flight& flight, Link& link, Record& record, const Matcher& match) {
  mavlink::Reader reader;
  Pictures pictures(false, arguments.flight.camera_latency_s);
  std::optional<TimedFrame> arrived;
  FramesAtWork at_work(flight, match);
  std::int64_t mend_us = 0;
  while (!is_to_end) {
    std::array<pollfd, 2> inputs = {{{link.descriptor(), POLLIN, 0}, {STDIN_FILENO, POLLIN, 0}}};
    constexpr int kWait_ms = 5;
    ::poll(inputs.data(), pictures.have_ended() ? 1 : 2, kWait_ms);
    if (link.descriptor() < 0 || (inputs[0].revents & (POLLERR | POLLHUP | POLLNVAL)) != 0) {
      std::this_thread::sleep_for(std::chrono::milliseconds(kWait_ms));
      if (now_us() >= mend_us) {
        mend_us = now_us() + 1'000'000;
        if (!link.mend()) std::fprintf(stderr, "autopilot_example: the line is gone\n");
      }
    }
    for (auto bytes = link.receive(); !bytes.empty(); bytes = link.receive()) {
      reader.push(bytes);
      while (const auto message = reader.next()) {
        record(now_us(), message->frame);
        flight.hear(*message, now_us());
      }
    }
    if (!pictures.have_ended()) take_pictures(pictures, arrived, flight);
    if (arrived && flight.may_begin(*arrived->exposure_us, now_us())) {
      if (!at_work.takes(*arrived->exposure_us)) {
        flight.skip("while another waited");
      } else if (const auto task = flight.begin(*arrived->exposure_us, now_us())) {
        at_work.take(*task, arrived->pixels);
      }
      arrived.reset();
    }
    at_work.go_on();
    flight.go_on(now_us());
  }
  say_latency(at_work.latencies_us());
}

/// On the ground: a recorded flight again, every frame matched in no time.
void fly_again(const Arguments& arguments, Flight& flight, std::int64_t& clock_us, Record& record,
               const Matcher& match) {
  RecordingReader recording(arguments.recording);
  mavlink::Reader reader;
  Pictures pictures(true, 0);
  const auto next_picture = [&pictures] {
    auto frame = pictures.next();
    if (frame && !frame->exposure_us) {
      throw std::runtime_error("a picture has no \"# exposure_us N\" in its header: nobody knows when it was taken");
    }
    return frame;
  };
  std::optional<TimedFrame> frame = next_picture();
  while (const auto entry = recording.next()) {
    if (is_to_end) return;
    clock_us = entry->time_us;
    reader.push(entry->frame);
    while (const auto message = reader.next()) {
      record(clock_us, message->frame);
      flight.hear(*message, clock_us);
    }
    while (frame && *frame->exposure_us <= clock_us && flight.may_begin(*frame->exposure_us, clock_us)) {
      if (auto task = flight.begin(*frame->exposure_us, clock_us)) {
        task->options.deadline_ms.reset();  // of this computer's time
        flight.end(*task, match(frame->pixels, *task), clock_us);
      }
      frame = next_picture();
    }
    flight.go_on(clock_us);
  }
}

void run(const Arguments& arguments) {
  std::vector<pilotage::MapReader> maps = open_maps(arguments);
  const Matcher match(maps);
  Record record(arguments.record);
  std::unique_ptr<Link> link;
  if (!arguments.link.empty()) link = std::make_unique<Link>(arguments.link);
  std::int64_t recorded_us = 0;
  const auto send = [&](const mavlink::Bytes& frame) {
    record(link ? now_us() : recorded_us, frame);
    if (link) link->send(frame);
  };
  Flight flight(arguments.flight, largest_map_sigma_m(maps), send);
  if (link) {
    fly(arguments, flight, *link, record, match);
  } else {
    fly_again(arguments, flight, recorded_us, record, match);
  }
  std::fprintf(stderr, "autopilot_example: %s\n", flight.summary().c_str());
}

}  // namespace

int main(int argc, char** argv) {
  if (argc == 2 && std::string(argv[1]) == "--help") {
    std::fputs(kUsage, stdout);
    return 0;
  }
  struct sigaction end = {};  // without SA_RESTART: a read that waits for pictures ends, too
  end.sa_handler = [](int) { is_to_end = true; };
  ::sigaction(SIGINT, &end, nullptr);
  ::sigaction(SIGTERM, &end, nullptr);
  std::signal(SIGPIPE, SIG_IGN);
  cv::setNumThreads(1);  // the other cores have other work
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
