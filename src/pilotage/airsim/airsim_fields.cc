#include "pilotage/airsim/airsim_fields.h"

namespace pilotage {
namespace {

[[noreturn]] void refuse(const RpcValue& value, const std::string& where, const char* wanted) {
  throw DataError(where + " is " + rpc_kind(value) + ", not " + wanted);
}

}  // namespace

AirsimFieldReader::AirsimFieldReader(AirsimDialect dialect, const RpcValue& value, const std::string& where)
    : dialect_(dialect), value_(value), where_(where) {
  const bool positional = dialect == AirsimDialect::kColosseum;
  if (positional && !std::holds_alternative<RpcArray>(value.data)) refuse(value, where, "an array of members");
  if (!positional && !std::holds_alternative<RpcMap>(value.data)) refuse(value, where, "a map of members");
}

const RpcValue* AirsimFieldReader::find(const char* name) {
  if (dialect_ != AirsimDialect::kColosseum) return rpc_member(value_, name);
  const RpcArray& array = std::get<RpcArray>(value_.data);
  const std::size_t index = next_++;
  return index < array.size() ? &array[index] : nullptr;
}

bool rpc_to_bool(const RpcValue& value, const std::string& where) {
  if (const auto* truth = std::get_if<bool>(&value.data)) return *truth;
  refuse(value, where, "a bool");
}

std::int64_t rpc_to_integer(const RpcValue& value, const std::string& where) {
  if (const auto* number = std::get_if<std::int64_t>(&value.data)) return *number;
  if (const auto* number = std::get_if<std::uint64_t>(&value.data)) {
    if (*number <= static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max())) {
      return static_cast<std::int64_t>(*number);
    }
  }
  refuse(value, where, "an integer below 2^63");
}

double rpc_to_number(const RpcValue& value, const std::string& where) {
  if (const auto* number = std::get_if<float>(&value.data)) return static_cast<double>(*number);
  if (const auto* number = std::get_if<double>(&value.data)) return *number;
  if (const auto* number = std::get_if<std::int64_t>(&value.data)) return static_cast<double>(*number);
  if (const auto* number = std::get_if<std::uint64_t>(&value.data)) return static_cast<double>(*number);
  refuse(value, where, "a number");
}

std::string rpc_to_string(const RpcValue& value, const std::string& where) {
  if (const auto* text = std::get_if<std::string>(&value.data)) return *text;
  refuse(value, where, "a string");
}

RpcBytes rpc_to_bytes(const RpcValue& value, const std::string& where) {
  if (const auto* bytes = std::get_if<RpcBytes>(&value.data)) return *bytes;
  // Older packers know no bytes and send text.
  if (const auto* text = std::get_if<std::string>(&value.data)) return {text->begin(), text->end()};
  refuse(value, where, "bytes");
}

const RpcArray& rpc_to_array(const RpcValue& value, const std::string& where) {
  if (const auto* array = std::get_if<RpcArray>(&value.data)) return *array;
  refuse(value, where, "an array");
}

}  // namespace pilotage
