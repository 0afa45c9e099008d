#pragma once

#include <atomic>
#include <functional>
#include <thread>
#include <utility>

#include "testing/pinhole_camera.h"
#include <opencv2/core.hpp>
#include <poll.h>
#include <sys/socket.h>

#include "pilotage/airsim/airsim_simulation.h"
#include "pilotage/airsim/rpc_server.h"
#include "pilotage/camera/render_frame.h"
#include "pilotage/raster/gray_source.h"

namespace pilotage::testing {

inline constexpr double kWaitS = 60;  ///< For what comes at once, even on a machine that is busy.

/// A service on a free port of this machine, in a thread of its own, until the object dies.
class Served {
 public:
  explicit Served(RpcService service, RpcServerLimits limits = {})
      : listener_(listen_on({"127.0.0.1", 0})), thread_([this, service = std::move(service), limits] {
          served_ = serve_rpc(
              listener_, service,
              [this](const RpcServed& so_far) {
                idle_ = so_far.idle;
                return stop_.load();
              },
              limits);
        }) {}
  ~Served() { finish(); }
  Served(const Served&) = delete;
  Served& operator=(const Served&) = delete;

  HostPort address() const { return {"127.0.0.1", port_of(listener_)}; }

  std::int64_t idle() const { return idle_; }  ///< RpcServed::idle so far.

  RpcServed finish() {
    stop_ = true;
    if (thread_.joinable()) thread_.join();
    return served_;
  }

 private:
  Descriptor listener_;
  std::atomic<bool> stop_{false};
  std::atomic<std::int64_t> idle_{0};
  RpcServed served_;
  std::thread thread_;
};

/// A server that does with its only connection what a test says.
class OneConnection {
 public:
  explicit OneConnection(std::function<void(const Descriptor&)> script)
      : listener_(listen_on({"127.0.0.1", 0})), thread_([this, script = std::move(script)] {
          pollfd watched{listener_.number(), POLLIN, 0};
          if (::poll(&watched, 1, static_cast<int>(kWaitS * 1000)) != 1) return;
          const Descriptor connection(::accept(listener_.number(), nullptr, nullptr));
          script(connection);
        }) {}
  ~OneConnection() { thread_.join(); }
  OneConnection(const OneConnection&) = delete;
  OneConnection& operator=(const OneConnection&) = delete;

  HostPort address() const { return {"127.0.0.1", port_of(listener_)}; }

 private:
  Descriptor listener_;
  std::thread thread_;
};

inline Deadline soon() {
  return std::chrono::steady_clock::now() + std::chrono::seconds(static_cast<int>(kWaitS));
}

inline void send_bytes(const Descriptor& connection, const RpcBytes& bytes) {
  static_cast<void>(send_all(connection, bytes, soon()));
}

/// Reads until a call has come, and returns it.
inline RpcValue take_call(const Descriptor& connection) {
  const RpcLimits limits;
  RpcMessageScanner scanner(limits);
  RpcBytes bytes;
  while (true) {
    if (const auto size = scanner.scan(bytes)) return decode_rpc(std::span(bytes).first(*size), limits);
    if (receive_some(connection, bytes, 1000, soon()) != Transfer::kDone) return {};
  }
}

/// Reads until the peer has closed.
inline void wait_for_end(const Descriptor& connection) {
  RpcBytes bytes;
  while (receive_some(connection, bytes, 1000, soon()) == Transfer::kDone) {
  }
}

/// Ground that looks different everywhere, 1 m a pixel, 400 × 400 m: its middle is the home.
inline GraySource painted_ground() {
  cv::Mat gray(400, 400, CV_8UC1);
  for (int y = 0; y < gray.rows; ++y) {
    for (int x = 0; x < gray.cols; ++x) {
      gray.at<std::uint8_t>(y, x) = static_cast<std::uint8_t>((x * x + 7 * y * x) % 251);
    }
  }
  return gray_source_from({gray, cv::Mat(gray.size(), CV_8UC1, cv::Scalar(255)), {}});
}

/// What a camera sees of painted_ground() from a place near the home, which lies on the equator at longitude 0.
inline cv::Mat painted_frame(const AirsimView& view) {
  static const GraySource ground = painted_ground();
  const Eigen::Vector3d ned = ned_from_place({{0, 0}, 100}, view.place);
  GroundPlace place;
  place.pixel_from_enu_m << 1, 0, 0, -1;
  place.nadir_px = {200 + ned.y(), 200 - ned.x()};
  return render_frame(ground, place, view.camera, view.attitude, -ned.z()).gray;
}

inline AirsimScene painted_scene() {
  AirsimScene scene;
  scene.home = {{0, 0}, 100};
  scene.camera = pinhole_camera(64, 48, 60);
  scene.objects["Gate1"] = {{10, 20, -5}, {1, 0, 0, 0}};
  scene.frame = painted_frame;
  return scene;
}

}  // namespace pilotage::testing
