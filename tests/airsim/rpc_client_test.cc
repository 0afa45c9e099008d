#include "pilotage/airsim/rpc_client.h"

#include "airsim/serving.h"
#include "testing/error_of.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pilotage/base/error.h"

namespace pilotage {
namespace {

using ::testing::AllOf;
using testing::error_of;
using ::testing::HasSubstr;
using testing::kWaitS;
using testing::OneConnection;
using ::testing::StartsWith;

std::uint32_t number_of(const RpcValue& call) {
  return static_cast<std::uint32_t>(std::get<std::uint64_t>(std::get<RpcArray>(call.data).at(1).data));
}

RpcBytes reply(std::uint32_t number, const RpcValue& error, const RpcValue& result) {
  return encode_rpc(RpcArray{std::uint64_t{1}, std::uint64_t{number}, error, result});
}

/// What a call says when the server answers with `bytes` and closes.
std::string error_when_answered(const RpcBytes& bytes, const RpcLimits& limits = {}) {
  const OneConnection server([&bytes](const Descriptor& connection) {
    testing::take_call(connection);
    testing::send_bytes(connection, bytes);
  });
  RpcClient client(server.address(), kWaitS, limits);
  const std::string error = error_of<DataError>([&] { client.call("ping", {}); });
  EXPECT_THAT(error, StartsWith(server.address().text() + ": ping: "));
  EXPECT_THAT(error_of<DataError>([&] { client.call("getServerVersion", {}); }),
              HasSubstr(": getServerVersion: the connection was closed after an earlier error"));
  return error;
}

TEST(RpcClient, TellsWhatIsWrongWithAReply) {
  EXPECT_THAT(error_when_answered({}), HasSubstr("closed the connection before it replied"));
  EXPECT_THAT(error_when_answered({0x94, 0x01}), HasSubstr("closed the connection in the middle of a reply"));
  EXPECT_THAT(error_when_answered({'H', 'T', 'T', 'P'}), HasSubstr("is an integer, not [1, number, error, result]"));
  EXPECT_THAT(error_when_answered({0xC1}), HasSubstr("the reply is no msgpack"));
  EXPECT_THAT(error_when_answered(reply(99, {}, true)), HasSubstr("to call 99, which is not waited for"));
  EXPECT_THAT(error_when_answered({0x94, 0x01, 0x01, 0xC0, 0xC6, 0xFF, 0xFF, 0xFF, 0xFF}),
              HasSubstr("announces more than 67108864 bytes"));
  EXPECT_THAT(error_when_answered({0x94, 0x01, 0x01, 0xC0, 0xDD, 0xFF, 0xFF, 0xFF, 0xFF}),
              HasSubstr("announces more than 100000 values"));
  EXPECT_THAT(error_when_answered(encode_rpc(RpcArray{std::uint64_t{0}, std::uint64_t{1}, {}, {}})),
              HasSubstr("not [1, number, error, result]"));
  EXPECT_THAT(error_when_answered(encode_rpc(RpcMap{{"error", "x"}})), HasSubstr("is a map of 1"));
  EXPECT_THAT(error_when_answered(reply(1, {}, RpcBytes(2000, 0)), RpcLimits{1000, 100, 16}),
              HasSubstr("announces more than 1000 bytes"));
}

TEST(RpcClient, GivesUpWhenNoReplyComes) {
  const OneConnection server([](const Descriptor& connection) { testing::wait_for_end(connection); });
  RpcClient client(server.address(), kWaitS);
  const std::uint32_t call = client.send("ping", {});
  EXPECT_THAT(error_of<DataError>([&] { client.wait(call, 0.01); }), HasSubstr(": ping: no reply within 0.01 s"));
  EXPECT_THAT(error_of<DataError>([&] { client.call("ping", {}); }), HasSubstr("closed after an earlier error"));
}

TEST(RpcClient, MatchesRepliesThatComeInAnotherOrder) {
  const OneConnection server([](const Descriptor& connection) {
    const std::uint32_t first = number_of(testing::take_call(connection));
    RpcBytes both = reply(first + 1, {}, "second");
    const RpcBytes other = reply(first, {}, "first");
    both.insert(both.end(), other.begin(), other.end());
    testing::send_bytes(connection, both);
    testing::wait_for_end(connection);
  });
  RpcClient client(server.address(), kWaitS);
  const std::uint32_t first = client.send("moveToPosition", {});
  const std::uint32_t second = client.send("ping", {});
  EXPECT_EQ(std::get<std::string>(client.wait(first).data), "first");
  EXPECT_EQ(std::get<std::string>(client.wait(second).data), "second");
  EXPECT_THROW(client.wait(second), UsageError);
}

TEST(RpcClient, RefusesASecondReplyToACall) {
  const OneConnection server([](const Descriptor& connection) {
    const std::uint32_t first = number_of(testing::take_call(connection));
    RpcBytes twice = reply(first, {}, true);
    twice.insert(twice.end(), twice.begin(), twice.end());
    testing::send_bytes(connection, twice);
    testing::wait_for_end(connection);
  });
  RpcClient client(server.address(), kWaitS);
  const std::uint32_t first = client.send("ping", {});
  const std::uint32_t second = client.send("ping", {});
  EXPECT_THAT(error_of<DataError>([&] { client.wait(second); }), HasSubstr("which is not waited for"));
  EXPECT_THAT(error_of<DataError>([&] {
                client.wait(first);
                client.wait(second);
              }),
              HasSubstr("earlier error"));
}

TEST(RpcClient, HandsOnErrorsOfTheServerAndGoesOn) {
  const OneConnection server([](const Descriptor& connection) {
    testing::send_bytes(connection, reply(number_of(testing::take_call(connection)), "no such camera", {}));
    testing::send_bytes(connection, reply(number_of(testing::take_call(connection)), RpcArray{true}, {}));
    testing::send_bytes(connection, reply(number_of(testing::take_call(connection)), {}, true));
  });
  RpcClient client(server.address(), kWaitS);
  EXPECT_THAT(error_of<DataError>([&] { client.call("simGetImages", {}); }),
              AllOf(StartsWith("127.0.0.1:"), HasSubstr(": simGetImages: the server says: no such camera")));
  EXPECT_THAT(error_of<DataError>([&] { client.call("reset", {}); }), HasSubstr("the server says: an array of 1"));
  EXPECT_TRUE(std::get<bool>(client.call("ping", {}).data));
}

TEST(RpcClient, SaysWhoDoesNotListen) {
  HostPort nobody;
  {
    const Descriptor listener = listen_on({"127.0.0.1", 0});
    nobody = {"127.0.0.1", port_of(listener)};
  }
  EXPECT_THAT(error_of<DataError>([&] { RpcClient(nobody, kWaitS); }), HasSubstr(nobody.text() + ": "));
  EXPECT_THAT(error_of<DataError>([&] { RpcClient({"no such host", 1}, kWaitS); }), HasSubstr("no such host:1: "));
}

TEST(HostPort, IsReadFromText) {
  const auto read = [](const std::string& text) { return parse_host_port("--airsim", text, 41451).text(); };
  EXPECT_EQ(read("127.0.0.1:5"), "127.0.0.1:5");
  EXPECT_EQ(read("localhost"), "localhost:41451");
  EXPECT_EQ(read("[::1]:80"), "[::1]:80");
  EXPECT_EQ(read("[::1]"), "[::1]:41451");
  for (const char* wrong : {"", ":5", "host:", "host:65536", "host:-1", "host:x", "[::1", "[::1]x", "host:1e3"}) {
    EXPECT_THAT(error_of<UsageError>([&] { read(wrong); }), HasSubstr("--airsim = \"" + std::string(wrong) + "\""));
  }
}

}  // namespace
}  // namespace pilotage
