// What a server does with peers that ask for too much, too slowly or not at all.

#include "pilotage/airsim/rpc_server.h"

#include <atomic>
#include <chrono>
#include <thread>

#include "airsim/serving.h"
#include "testing/error_of.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include "pilotage/airsim/airsim_fields.h"
#include "pilotage/airsim/rpc_client.h"
#include "pilotage/base/error.h"
#include "pilotage/base/progress.h"

namespace pilotage {
namespace {

using testing::error_of;
using ::testing::HasSubstr;
using testing::kWaitS;
using testing::painted_scene;
using testing::Served;

constexpr AirsimDialect kServedDialect = AirsimDialect::kAirsim;

RpcArray images(std::size_t count) {
  RpcArray requests;
  for (std::size_t i = 0; i < count; ++i) {
    AirsimImageRequest request;
    request.camera_name = "bottom_center";
    requests.push_back(to_rpc(kServedDialect, request));
  }
  return {RpcValue(std::move(requests)), std::string(), false};
}

RpcBytes call_bytes(std::uint64_t number, const std::string& method, RpcArray arguments) {
  return encode_rpc(RpcArray{std::uint64_t{0}, number, method, RpcValue(std::move(arguments))});
}

/// Puts the vehicle where its camera sees something.
void raise_vehicle(const Served& server) {
  RpcClient client(server.address(), kWaitS);
  client.call("simPause", {true});
  client.call("simSetVehiclePose", {to_rpc(kServedDialect, AirsimPose{{0, 0, -50}, {}}), true, std::string()});
}

/// A connection that has asked for more images than the system's buffers hold.
Descriptor asks_and_fetches_nothing(const Served& server) {
  Descriptor connection = connect_to(server.address(), testing::soon());
  RpcBytes calls;
  for (std::uint64_t number = 0; number < 400; ++number) {
    const RpcBytes call = call_bytes(number, "simGetImages", images(16));
    calls.insert(calls.end(), call.begin(), call.end());
  }
  testing::send_bytes(connection, calls);
  return connection;
}

/// A scene that counts the frames it draws, each of which takes a while.
struct SlowScene {
  std::atomic<int> drawn{0};

  AirsimScene scene() {
    AirsimScene made = painted_scene();
    made.frame = [this, draw = made.frame](const AirsimView& view) {
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
      ++drawn;
      return draw(view);
    };
    return made;
  }
};

TEST(RpcServer, AnswersOthersBetweenTheImagesOfACall) {
  SlowScene slow;
  AirsimSimulation simulation(kServedDialect, slow.scene());
  const Served server(simulation.service());
  raise_vehicle(server);
  RpcClient greedy(server.address(), kWaitS);
  RpcClient greedy_too(server.address(), kWaitS);
  RpcClient honest(server.address(), kWaitS);
  std::vector<std::uint32_t> calls;
  for (int i = 0; i < 8; ++i) calls.push_back(greedy.send("simGetImages", images(16)));
  for (int i = 0; i < 8; ++i) greedy_too.send("simGetImages", images(16));
  while (slow.drawn == 0) std::this_thread::yield();
  for (int i = 0; i < 3; ++i) {
    const int before = slow.drawn;
    honest.call("ping", {});
    honest.call("simGetImages", images(1));
    EXPECT_LE(slow.drawn - before, 12) << "of the 256 that others asked for: some of each in turn";
  }
  const auto answered = from_rpc<std::vector<AirsimImage>>(kServedDialect, greedy.wait(calls.front()), "");
  EXPECT_EQ(answered.size(), 16U);
  EXPECT_FALSE(answered.back().image_data_uint8.empty());
}

TEST(RpcServer, DrawsWhatWasAskedForAsItWasThen) {
  AirsimSimulation simulation(kServedDialect, painted_scene());
  const Served server(simulation.service());
  RpcClient client(server.address(), kWaitS);
  client.call("simPause", {true});
  const auto put = [&](float north_m) {
    return client.send("simSetVehiclePose",
                       {to_rpc(kServedDialect, AirsimPose{{north_m, 0, -50}, {}}), true, std::string()});
  };
  client.wait(put(0));
  const auto here = from_rpc<std::vector<AirsimImage>>(kServedDialect, client.call("simGetImages", images(1)), "");
  const std::uint32_t two = client.send("simGetImages", images(2));
  put(40);
  const auto before = from_rpc<std::vector<AirsimImage>>(kServedDialect, client.wait(two), "");
  EXPECT_EQ(before[1].image_data_uint8, here[0].image_data_uint8);
  const auto after = from_rpc<std::vector<AirsimImage>>(kServedDialect, client.call("simGetImages", images(1)), "");
  EXPECT_NE(after[0].image_data_uint8, here[0].image_data_uint8);
}

TEST(RpcServer, StopsBetweenTheImagesOfACall) {
  SlowScene slow;
  AirsimSimulation simulation(kServedDialect, slow.scene());
  Served server(simulation.service());
  raise_vehicle(server);
  RpcClient greedy(server.address(), kWaitS);
  for (int i = 0; i < 10; ++i) greedy.send("simGetImages", images(16));
  while (slow.drawn < 3) std::this_thread::yield();
  server.finish();
  EXPECT_LT(slow.drawn, 100);
}

TEST(RpcServer, DoesNothingMoreForWhoIsGone) {
  SlowScene slow;
  AirsimSimulation simulation(kServedDialect, slow.scene());
  const Served server(simulation.service());
  raise_vehicle(server);
  {
    RpcClient gone(server.address(), kWaitS);
    for (int i = 0; i < 16; ++i) gone.send("simGetImages", images(16));
    while (slow.drawn == 0) std::this_thread::yield();
  }
  RpcClient honest(server.address(), kWaitS);
  for (int i = 0; i < 20; ++i) honest.call("simGetImages", images(1));  // its 16 calls are taken, one in each turn
  const int so_far = slow.drawn;
  for (int i = 0; i < 5; ++i) honest.call("simGetImages", images(1));
  EXPECT_EQ(slow.drawn - so_far, 5) << "nobody is left to draw others for";
}

// Each image is 64 × 48 × 3 bytes; peers that fetch none of them keep nobody else from theirs.
TEST(RpcServer, BoundsWhatPeersDoNotFetch) {
  AirsimSimulation simulation(kServedDialect, painted_scene());
  RpcServerLimits limits;
  limits.unsent_bytes = 1000;
  limits.all_unsent_bytes = 3'000'000;
  Served server(simulation.service(), limits);
  raise_vehicle(server);
  std::vector<Descriptor> slow;
  for (int i = 0; i < 4; ++i) slow.push_back(asks_and_fetches_nothing(server));
  RpcClient honest(server.address(), kWaitS);
  for (int i = 0; i < 20; ++i) {
    EXPECT_EQ(from_rpc<std::vector<AirsimImage>>(kServedDialect, honest.call("simGetImages", images(16)), "").size(),
              16U);
  }
}

TEST(RpcServer, ClosesWhoOwesMostWhenNoWorkCanBeDone) {
  AirsimSimulation simulation(kServedDialect, painted_scene());
  RpcServerLimits limits;
  limits.all_unsent_bytes = 1;  // any answer that its peer does not fetch
  Served server(simulation.service(), limits);
  raise_vehicle(server);
  const Descriptor slow = asks_and_fetches_nothing(server);
  RpcClient honest(server.address(), kWaitS);
  // What the system's own buffers take is not owed yet; then the slow one is closed, and the honest one goes on.
  while (server.idle() == 0) honest.call("simGetImages", images(1));
  for (int i = 0; i < 5; ++i) honest.call("simGetImages", images(1));
}

// It waits for answers, but those that it has it does not fetch: that is as quiet as saying nothing.
TEST(RpcServer, ClosesWhoAsksAndFetchesNothing) {
  AirsimSimulation simulation(kServedDialect, painted_scene());
  RpcServerLimits limits;
  limits.unsent_bytes = 1000;
  limits.idle_s = 0.3;
  Served server(simulation.service(), limits);
  raise_vehicle(server);
  const Descriptor slow = asks_and_fetches_nothing(server);
  const auto end = testing::soon();
  while (server.idle() == 0 && std::chrono::steady_clock::now() < end) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  EXPECT_EQ(server.finish().idle, 1);
}

TEST(RpcServer, TakesSoManyCallsThatAreAnsweredLater) {
  SlowScene slow;
  AirsimSimulation simulation(kServedDialect, slow.scene());
  RpcServerLimits limits;
  limits.waiting_calls = 2;
  Served server(simulation.service(), limits);
  raise_vehicle(server);
  RpcClient client(server.address(), kWaitS);
  std::uint32_t last = 0;
  for (int i = 0; i < 10; ++i) last = client.send("simGetImages", images(4));
  while (slow.drawn < 5) std::this_thread::yield();
  EXPECT_EQ(from_rpc<std::vector<AirsimImage>>(kServedDialect, client.wait(last), "").size(), 4U);
  EXPECT_EQ(server.finish().calls, 12) << "two put the vehicle up";
}

TEST(RpcServer, ClosesConnectionsThatAreQuiet) {
  AirsimSimulation simulation(kServedDialect, painted_scene());
  RpcServerLimits limits;
  limits.idle_s = 0.2;
  Served server(simulation.service(), limits);
  const Descriptor silent = connect_to(server.address(), testing::soon());
  const Descriptor half = connect_to(server.address(), testing::soon());
  testing::send_bytes(half, {0x94, 0x00});
  RpcClient waits(server.address(), kWaitS);
  waits.call("simPause", {true});
  const std::uint32_t moved =
      waits.send("moveToPosition", {0.0, 0.0, -9.0, 1.0, 100.0, std::int64_t{0},
                                    to_rpc(kServedDialect, AirsimYawMode{true, 0}), -1.0, 1.0, std::string()});
  testing::wait_for_end(silent);
  testing::wait_for_end(half);
  RpcClient other(server.address(), kWaitS);
  other.call("simContinueForTime", {20.0});
  EXPECT_TRUE(std::get<bool>(waits.wait(moved).data)) << "it waits for an answer: that is not quiet";
  EXPECT_EQ(server.finish().idle, 2);
}

TEST(RpcServer, ThirtyTwoQuietConnectionsKeepNobodyOut) {
  AirsimSimulation simulation(kServedDialect, painted_scene());
  RpcServerLimits limits;
  limits.may_give_way_s = 0.1;
  Served server(simulation.service(), limits);
  std::vector<Descriptor> quiet;
  for (std::size_t i = 0; i < limits.connections; ++i) quiet.push_back(connect_to(server.address(), testing::soon()));
  RpcClient late(server.address(), kWaitS);
  EXPECT_TRUE(std::get<bool>(late.call("ping", {}).data));
  testing::wait_for_end(quiet.front());
  EXPECT_EQ(server.finish().idle, 1);
}

// Without a descriptor left the listener stays ready: who asks it again at once spins.
TEST(RpcServer, RestsWhenThereAreNoDescriptorsLeft) {
  AirsimSimulation simulation(kServedDialect, painted_scene());
  const RpcService service = simulation.service();
  const Descriptor listener = listen_on({"127.0.0.1", 0});
  const Descriptor waiting = connect_to({"127.0.0.1", port_of(listener)}, testing::soon());
  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_NOFILE, &before), 0);
  rlimit none = before;
  none.rlim_cur = static_cast<rlim_t>(waiting.number());
  ASSERT_EQ(setrlimit(RLIMIT_NOFILE, &none), 0);
  int turns = 0;
  const auto end = std::chrono::steady_clock::now() + std::chrono::milliseconds(300);
  const RpcServed served = serve_rpc(listener, service, [&](const RpcServed&) {
    ++turns;
    return std::chrono::steady_clock::now() > end;
  });
  ASSERT_EQ(setrlimit(RLIMIT_NOFILE, &before), 0);
  EXPECT_EQ(served.connections, 0);
  EXPECT_LE(turns, 30) << "some fifty a second";
}

TEST(RpcServer, AsksTheBoundAddressWhoMayConnect) {
  EXPECT_TRUE(is_loopback(listen_on({"127.0.0.1", 0})));
  EXPECT_TRUE(is_loopback(listen_on({"127.3.2.1", 0})));
  EXPECT_TRUE(is_loopback(listen_on({"localhost", 0})));
  EXPECT_FALSE(is_loopback(listen_on({"0.0.0.0", 0})));
}

TEST(AirsimServing, RefusesMoreImagesThanAnAnswerHolds) {
  AirsimScene scene = painted_scene();
  scene.camera.width_px = 4000;
  scene.camera.height_px = 3000;
  scene.camera.cx_px = 2000;
  scene.camera.cy_px = 1500;
  scene.frame = [](const AirsimView&) { return cv::Mat(3000, 4000, CV_8UC3, cv::Scalar(1, 2, 3)); };
  AirsimSimulation simulation(kServedDialect, scene);
  const Served server(simulation.service());
  raise_vehicle(server);
  RpcClient client(server.address(), kWaitS);
  EXPECT_THAT(error_of<DataError>([&] { client.call("simGetImages", images(2)); }),
              HasSubstr("2 images of 4000 x 3000 px are 69 MiB; 64 are given at once at most"));
  EXPECT_EQ(from_rpc<std::vector<AirsimImage>>(kServedDialect, client.call("simGetImages", images(1)), "").size(), 1U);
}

TEST(AirsimServing, MatchesNamesWithoutTryingEverything) {
  AirsimScene scene = painted_scene();
  scene.objects = {{"Ground_1", {}}, {"Ground_2", {}}, {"a.b", {}}};
  AirsimSimulation simulation(kServedDialect, scene);
  const Served server(simulation.service());
  RpcClient client(server.address(), kWaitS);
  const auto names = [&](const std::string& pattern) {
    return from_rpc<std::vector<std::string>>(kServedDialect, client.call("simListSceneObjects", {pattern}), "");
  };
  using Names = std::vector<std::string>;
  EXPECT_EQ(names(".*"), (Names{"SimpleFlight", "Ground_1", "Ground_2", "a.b"}));
  EXPECT_EQ(names("Ground.*"), (Names{"Ground_1", "Ground_2"}));
  EXPECT_EQ(names("Ground"), Names());
  EXPECT_EQ(names(".*_2"), Names{"Ground_2"});
  EXPECT_EQ(names("a\\.b"), Names{"a.b"});
  EXPECT_EQ(names(".r.*d_."), (Names{"Ground_1", "Ground_2"}));
  EXPECT_EQ(names(""), Names());
  EXPECT_EQ(names(".*.*.*.*.*.*.*.*.*.*.*.*.*.*.*.*.*.*.*.*.*.*.*.*.*.*.*.*.*.*x"), Names());
  for (const char* pattern : {"(.?.?.?.?.?.?.?.?.?.?.?.?)*x", "(a*)*b", "[", "a{9}", "a|b", "\\", "a*"}) {
    EXPECT_THAT(error_of<DataError>([&] { names(pattern); }), HasSubstr("are understood alone")) << pattern;
  }
}

TEST(RpcClient, HearsTheWishToStopWhileItWaits) {
  const testing::OneConnection silent([](const Descriptor& connection) { testing::wait_for_end(connection); });
  int asked = 0;
  RpcClient client(silent.address(), kWaitS, {}, [&] { return ++asked < 4; });
  EXPECT_THROW(client.call("ping", {}), Interrupted);
}

}  // namespace
}  // namespace pilotage
