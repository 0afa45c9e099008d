#include "pilotage/airsim/rpc_codec.h"

#include "testing/error_of.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pilotage/base/error.h"

namespace pilotage {
namespace {

using testing::error_of;
using ::testing::HasSubstr;

/// A call with values of every kind.
RpcValue full_message() {
  return RpcArray{std::uint64_t{0}, std::uint64_t{70000}, "simGetImages",
                  RpcArray{RpcValue(), true, std::int64_t{-40000}, 2.5F, 0.1, std::string(300, 'x'),
                           RpcBytes(70000, 0xC1), RpcMap{{"x_val", 1.5F}, {"nested", RpcArray{std::string()}}}}};
}

TEST(RpcCodec, BytesAreThoseOfTheSpecification) {
  // [1, 5, nil, {"a": [true, -1, 1.5 (float32), bytes 7 8]}] by github.com/msgpack/msgpack/blob/master/spec.md
  const RpcBytes bytes = {0x94, 0x01, 0x05, 0xC0, 0x81, 0xA1, 'a',  0x94, 0xC3, 0xFF,
                          0xCA, 0x3F, 0xC0, 0x00, 0x00, 0xC4, 0x02, 0x07, 0x08};
  const RpcValue value = RpcArray{std::uint64_t{1}, std::uint64_t{5}, RpcValue(),
                                  RpcMap{{"a", RpcArray{true, std::int64_t{-1}, 1.5F, RpcBytes{7, 8}}}}};
  EXPECT_EQ(encode_rpc(value), bytes);
  const RpcValue decoded = decode_rpc(bytes, {});
  EXPECT_EQ(encode_rpc(decoded), bytes);
  const RpcValue* member = rpc_member(std::get<RpcArray>(decoded.data)[3], "a");
  ASSERT_NE(member, nullptr);
  EXPECT_EQ(std::get<float>(std::get<RpcArray>(member->data)[2].data), 1.5F);
}

TEST(RpcCodec, DecodesWhatItEncodes) {
  const RpcBytes bytes = encode_rpc(full_message());
  EXPECT_EQ(encode_rpc(decode_rpc(bytes, {})), bytes);
}

TEST(RpcMessageScanner, FindsTheEndsOfMessagesByteByByte) {
  const RpcBytes one = encode_rpc(full_message());
  const RpcBytes other = encode_rpc(RpcArray{std::uint64_t{2}, "notify", RpcArray{}});
  RpcBytes stream = one;
  stream.insert(stream.end(), other.begin(), other.end());
  RpcMessageScanner scanner({});
  for (std::size_t size = 0; size < one.size(); ++size) {
    ASSERT_FALSE(scanner.scan(std::span(stream).first(size))) << size;
  }
  EXPECT_EQ(scanner.scan(stream), one.size());
  EXPECT_EQ(scanner.scan(std::span(stream).subspan(one.size())), other.size());
  EXPECT_FALSE(scanner.scan({}));
}

TEST(RpcMessageScanner, RefusesSizesBeforeTheyArrive) {
  const RpcLimits limits{1000, 50, 4};
  const auto refused = [&](const RpcBytes& bytes) {
    return error_of<DataError>([&] { RpcMessageScanner(limits).scan(bytes); });
  };
  EXPECT_THAT(refused({0xC6, 0xFF, 0xFF, 0xFF, 0xFF}), HasSubstr("more than 1000 bytes"));
  EXPECT_THAT(refused({0xDB, 0x00, 0x00, 0x04, 0x00}), HasSubstr("more than 1000 bytes"));
  EXPECT_THAT(refused({0xC9, 0xFF, 0xFF, 0xFF, 0xFF, 0x01}), HasSubstr("more than 1000 bytes"));
  EXPECT_THAT(refused({0xDD, 0xFF, 0xFF, 0xFF, 0xFF}), HasSubstr("more than 50 values"));
  EXPECT_THAT(refused({0xDF, 0x00, 0x00, 0x00, 0x1A}), HasSubstr("more than 50 values"));  // 26 keys, 26 values
  EXPECT_EQ(refused({0xDF, 0x00, 0x00, 0x00, 0x19}), "");
  // Small ones that add up: arrays of 15 in each other.
  EXPECT_THAT(refused({0x9F, 0x9F, 0x9F, 0x9F}), HasSubstr("more than 50 values"));
}

TEST(RpcCodec, RefusesWhatIsNoMessage) {
  const auto refused = [](const RpcBytes& bytes) { return error_of<DataError>([&] { decode_rpc(bytes, {}); }); };
  EXPECT_THAT(refused({}), HasSubstr("not one whole"));
  EXPECT_THAT(refused({0x92, 0x01}), HasSubstr("not one whole"));
  EXPECT_THAT(refused({0x01, 0x02}), HasSubstr("not one whole"));
  EXPECT_THAT(refused({0xC1}), HasSubstr("no msgpack"));
  EXPECT_THAT(refused({0xD4, 0x01, 0x00}), HasSubstr("extension"));
  EXPECT_THAT(refused({0x81, 0x01, 0x02}), HasSubstr("key that is no text"));
  EXPECT_THAT(refused(RpcBytes(20, 0x91)), HasSubstr("not one whole"));
  RpcBytes deep(20, 0x91);
  deep.push_back(0xC0);
  EXPECT_THAT(refused(deep), HasSubstr("more than 16 arrays and maps"));
}

}  // namespace
}  // namespace pilotage
