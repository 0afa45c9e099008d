#include "pilotage/airsim/rpc_codec.h"

#define MSGPACK_NO_BOOST
#include <msgpack.hpp>

#include "pilotage/base/error.h"

namespace pilotage {
namespace {

/// What the header at the beginning of a value says: how long it is itself, what follows it, and how many values.
struct RpcHeader {
  std::size_t header_bytes = 1;
  std::uint64_t payload_bytes = 0;
  std::uint64_t values = 0;
};

std::uint64_t big_endian(std::span<const std::uint8_t> bytes) {
  std::uint64_t number = 0;
  for (const std::uint8_t byte : bytes) number = number << 8 | byte;
  return number;
}

/// Bytes of the length that stands behind the first byte of a value, by the msgpack specification.
std::size_t length_bytes(std::uint8_t first) {
  switch (first) {
    case 0xC4:
    case 0xC7:
    case 0xD9:
      return 1;
    case 0xC5:
    case 0xC8:
    case 0xDA:
    case 0xDC:
    case 0xDE:
      return 2;
    case 0xC6:
    case 0xC9:
    case 0xDB:
    case 0xDD:
    case 0xDF:
      return 4;
    default:
      return 0;
  }
}

/// Nothing when not all of the header is there.
std::optional<RpcHeader> read_header(std::span<const std::uint8_t> bytes) {
  if (bytes.empty()) return std::nullopt;
  const std::uint8_t first = bytes[0];
  RpcHeader header;
  if (first <= 0x7F || first >= 0xE0) return header;
  if (first <= 0x8F) return RpcHeader{1, 0, 2U * (first & 0x0FU)};
  if (first <= 0x9F) return RpcHeader{1, 0, first & 0x0FU};
  if (first <= 0xBF) return RpcHeader{1, first & 0x1FU, 0};
  if (first >= 0xCA && first <= 0xD3) {  // float32, float64, uint8 … uint64, int8 … int64
    static constexpr std::uint8_t kSizes[] = {4, 8, 1, 2, 4, 8, 1, 2, 4, 8};
    header.payload_bytes = kSizes[first - 0xCA];
    return header;
  }
  if (first >= 0xD4 && first <= 0xD8) return RpcHeader{2, std::uint64_t{1} << (first - 0xD4), 0};
  const std::size_t wide = length_bytes(first);
  if (wide == 0) return header;  // nil, false, true; 0xC1, which decode_rpc refuses
  if (bytes.size() < 1 + wide) return std::nullopt;
  const std::uint64_t length = big_endian(bytes.subspan(1, wide));
  header.header_bytes = 1 + wide;
  if (first >= 0xDC) {
    header.values = first >= 0xDE ? 2 * length : length;
  } else {
    header.payload_bytes = length + (first >= 0xC7 && first <= 0xC9 ? 1 : 0);  // the type of an extension
  }
  return header;
}

RpcValue value_of(const msgpack::object& object);

RpcValue map_of(const msgpack::object_map& from) {
  RpcMap map;
  map.reserve(from.size);
  for (std::uint32_t i = 0; i < from.size; ++i) {
    const msgpack::object_kv& member = from.ptr[i];
    if (member.key.type != msgpack::type::STR) throw DataError("a map has a key that is no text");
    map.emplace_back(std::string(member.key.via.str.ptr, member.key.via.str.size), value_of(member.val));
  }
  return map;
}

RpcValue array_of(const msgpack::object_array& from) {
  RpcArray array;
  array.reserve(from.size);
  for (std::uint32_t i = 0; i < from.size; ++i) array.push_back(value_of(from.ptr[i]));
  return array;
}

RpcValue value_of(const msgpack::object& object) {
  switch (object.type) {
    case msgpack::type::NIL:
      return {};
    case msgpack::type::BOOLEAN:
      return object.via.boolean;
    case msgpack::type::POSITIVE_INTEGER:
      return std::uint64_t{object.via.u64};
    case msgpack::type::NEGATIVE_INTEGER:
      return std::int64_t{object.via.i64};
    case msgpack::type::FLOAT32:
      return static_cast<float>(object.via.f64);
    case msgpack::type::FLOAT64:
      return object.via.f64;
    case msgpack::type::STR:
      return std::string(object.via.str.ptr, object.via.str.size);
    case msgpack::type::BIN:
      return RpcBytes(object.via.bin.ptr, object.via.bin.ptr + object.via.bin.size);
    case msgpack::type::ARRAY:
      return array_of(object.via.array);
    case msgpack::type::MAP:
      return map_of(object.via.map);
    default:
      throw DataError("extension types are not understood");
  }
}

using Packer = msgpack::packer<msgpack::sbuffer>;

void pack(Packer& packer, const RpcValue& value);

void pack_data(Packer& packer, std::monostate /*nil*/) {
  packer.pack_nil();
}
void pack_data(Packer& packer, bool value) {
  value ? packer.pack_true() : packer.pack_false();
}
void pack_data(Packer& packer, std::int64_t value) {
  packer.pack_int64(value);
}
void pack_data(Packer& packer, std::uint64_t value) {
  packer.pack_uint64(value);
}
void pack_data(Packer& packer, float value) {
  packer.pack_float(value);
}
void pack_data(Packer& packer, double value) {
  packer.pack_double(value);
}
void pack_data(Packer& packer, const std::string& value) {
  packer.pack_str(static_cast<std::uint32_t>(value.size()));
  packer.pack_str_body(value.data(), static_cast<std::uint32_t>(value.size()));
}
void pack_data(Packer& packer, const RpcBytes& value) {
  packer.pack_bin(static_cast<std::uint32_t>(value.size()));
  packer.pack_bin_body(reinterpret_cast<const char*>(value.data()), static_cast<std::uint32_t>(value.size()));
}
void pack_data(Packer& packer, const RpcArray& value) {
  packer.pack_array(static_cast<std::uint32_t>(value.size()));
  for (const RpcValue& element : value) pack(packer, element);
}
void pack_data(Packer& packer, const RpcMap& value) {
  packer.pack_map(static_cast<std::uint32_t>(value.size()));
  for (const auto& [key, member] : value) {
    pack_data(packer, key);
    pack(packer, member);
  }
}

void pack(Packer& packer, const RpcValue& value) {
  std::visit([&packer](const auto& data) { pack_data(packer, data); }, value.data);
}

}  // namespace

std::optional<std::size_t> RpcMessageScanner::scan(std::span<const std::uint8_t> buffer) {
  while (missing_ > 0) {
    if (at_ >= buffer.size()) return std::nullopt;
    const std::optional<RpcHeader> header = read_header(buffer.subspan(at_));
    if (!header) return std::nullopt;
    if (header->values > limits_.values || values_ + header->values > limits_.values) {
      throw DataError("announces more than " + std::to_string(limits_.values) + " values, the most that is taken");
    }
    if (header->payload_bytes > limits_.message_bytes ||
        at_ + header->header_bytes + header->payload_bytes > limits_.message_bytes) {
      throw DataError("announces more than " + std::to_string(limits_.message_bytes) +
                      " bytes, the most that is taken");
    }
    at_ += header->header_bytes + static_cast<std::size_t>(header->payload_bytes);
    values_ += static_cast<std::size_t>(header->values);
    missing_ += static_cast<std::size_t>(header->values);
    --missing_;
  }
  if (at_ > buffer.size()) return std::nullopt;
  const std::size_t size = at_;
  at_ = values_ = 0;
  missing_ = 1;
  return size;
}

RpcValue decode_rpc(std::span<const std::uint8_t> message, const RpcLimits& limits) {
  RpcMessageScanner scanner(limits);
  if (scanner.scan(message) != message.size()) throw DataError("is not one whole msgpack value");
  try {
    const msgpack::unpack_limit unpack_limits(limits.values, limits.values, limits.message_bytes, limits.message_bytes,
                                              limits.message_bytes, static_cast<std::size_t>(limits.depth));
    const msgpack::object_handle handle =
        msgpack::unpack(reinterpret_cast<const char*>(message.data()), message.size(), nullptr, nullptr, unpack_limits);
    return value_of(handle.get());
  } catch (const msgpack::depth_size_overflow&) {
    throw DataError("has more than " + std::to_string(limits.depth) + " arrays and maps in each other");
  } catch (const msgpack::unpack_error& error) {
    throw DataError(std::string("is no msgpack: ") + error.what());
  }
}

RpcBytes encode_rpc(const RpcValue& value) {
  msgpack::sbuffer buffer;
  Packer packer(buffer);
  pack(packer, value);
  return {buffer.data(), buffer.data() + buffer.size()};
}

}  // namespace pilotage
