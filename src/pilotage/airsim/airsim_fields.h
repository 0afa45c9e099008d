#pragma once

#include <cmath>
#include <concepts>
#include <limits>
#include <string>
#include <type_traits>
#include <vector>

#include "pilotage/airsim/airsim_types.h"
#include "pilotage/base/error.h"

namespace pilotage {

// Between the structs of airsim_types.h and the values on the wire, by the descriptions of the structs.

template <class T>
RpcValue to_rpc(AirsimDialect dialect, const T& value);

/// Throws DataError that names `where`, what stands there and what should. Members of maps that are not known, and
/// members of arrays behind the known ones, are passed over, as newer servers have more of them.
template <class T>
T from_rpc(AirsimDialect dialect, const RpcValue& value, const std::string& where);

/// Collects the members of a struct.
class AirsimFieldWriter {
 public:
  explicit AirsimFieldWriter(AirsimDialect dialect) : dialect_(dialect) {}

  template <class T>
  void field(const char* name, const T& member) {
    if (dialect_ == AirsimDialect::kColosseum) {
      array_.push_back(to_rpc(dialect_, member));
    } else {
      map_.emplace_back(name, to_rpc(dialect_, member));
    }
  }

  /// A member that one dialect has.
  template <class T>
  void field_of(AirsimDialect dialect, const char* name, const T& member) {
    if (dialect == dialect_) field(name, member);
  }

  RpcValue value() && {
    if (dialect_ == AirsimDialect::kColosseum) return std::move(array_);
    return std::move(map_);
  }

 private:
  AirsimDialect dialect_;
  RpcArray array_;
  RpcMap map_;
};

/// Hands out the members of a struct.
class AirsimFieldReader {
 public:
  AirsimFieldReader(AirsimDialect dialect, const RpcValue& value, const std::string& where);

  template <class T>
  void field(const char* name, T& member) {
    const RpcValue* found = find(name);
    if (found == nullptr) throw DataError(where_ + " has no " + name + ": it is " + rpc_kind(value_));
    member = from_rpc<T>(dialect_, *found, where_ + "." + name);
  }

  /// A member that one dialect has, and that its older versions may lack.
  template <class T>
  void field_of(AirsimDialect dialect, const char* name, T& member) {
    if (dialect != dialect_) return;
    const RpcValue* found = find(name);
    if (found != nullptr) member = from_rpc<T>(dialect_, *found, where_ + "." + name);
  }

 private:
  const RpcValue* find(const char* name);

  AirsimDialect dialect_;
  const RpcValue& value_;
  const std::string& where_;
  std::size_t next_ = 0;
};

// What is no struct.
bool rpc_to_bool(const RpcValue& value, const std::string& where);
std::int64_t rpc_to_integer(const RpcValue& value, const std::string& where);
double rpc_to_number(const RpcValue& value, const std::string& where);
std::string rpc_to_string(const RpcValue& value, const std::string& where);
RpcBytes rpc_to_bytes(const RpcValue& value, const std::string& where);
const RpcArray& rpc_to_array(const RpcValue& value, const std::string& where);

namespace airsim_detail {

template <class T>
concept Struct = requires(T& value, AirsimFieldWriter& fields) {
  T::describe(value, fields);
};

template <class T>
struct IsVector : std::false_type {};
template <class T>
struct IsVector<std::vector<T>> : std::true_type {};

}  // namespace airsim_detail

template <class T>
RpcValue to_rpc(AirsimDialect dialect, const T& value) {
  if constexpr (airsim_detail::Struct<const T>) {
    AirsimFieldWriter fields(dialect);
    T::describe(value, fields);
    return std::move(fields).value();
  } else if constexpr (airsim_detail::IsVector<T>::value && !std::is_same_v<T, RpcBytes>) {
    RpcArray array;
    for (const auto& element : value) array.push_back(to_rpc(dialect, element));
    return array;
  } else {
    return value;  // bool, std::int64_t, std::uint64_t, float, double, std::string, RpcBytes, RpcValue
  }
}

template <class T>
T from_rpc(AirsimDialect dialect, const RpcValue& value, const std::string& where) {
  if constexpr (airsim_detail::Struct<T>) {
    T result;
    AirsimFieldReader fields(dialect, value, where);
    T::describe(result, fields);
    return result;
  } else if constexpr (std::is_same_v<T, RpcBytes>) {
    return rpc_to_bytes(value, where);
  } else if constexpr (airsim_detail::IsVector<T>::value) {
    T result;
    const RpcArray& array = rpc_to_array(value, where);
    for (std::size_t i = 0; i < array.size(); ++i) {
      result.push_back(from_rpc<typename T::value_type>(dialect, array[i], where + "[" + std::to_string(i) + "]"));
    }
    return result;
  } else if constexpr (std::is_same_v<T, bool>) {
    return rpc_to_bool(value, where);
  } else if constexpr (std::is_same_v<T, std::string>) {
    return rpc_to_string(value, where);
  } else if constexpr (std::is_same_v<T, RpcValue>) {
    return value;
  } else if constexpr (std::integral<T>) {
    return static_cast<T>(rpc_to_integer(value, where));
  } else {
    return static_cast<T>(rpc_to_number(value, where));
  }
}

}  // namespace pilotage
