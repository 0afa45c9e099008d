#pragma once

#include <concepts>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#pragma GCC visibility push(default)

namespace pilotage {

/// Described options: an options struct lists its fields once, and command-line flags, strict JSON, JSON Schema, range
/// checks and the documentation all derive from that list.
///
///   struct ScoreOptions {
///     int tile_size_px = 256;
///     CameraOptions camera;
///
///     template <class Self, class Fields>
///     static void describe(Self& self, Fields& fields) {
///       fields.field("tile_size_px", self.tile_size_px, "Side of a square tile.", Range{16, 4096});
///       fields.group("camera", self.camera, "How the aircraft sees the ground.");
///     }
///   };
///
/// Field names are snake_case with the unit as suffix; the flag of `camera.hfov_deg` is `--camera-hfov-deg`. A group
/// described with FlagPrefix::kNone keeps its place in JSON but lends its flags no prefix. A field `file` of a group is
/// the group's own flag: `camera.file` is `--camera`. `fields.path(…)` instead of `fields.field(…)` says that strings
/// are files or GDAL dataset strings: in a configuration file they are looked for beside that file
/// (base/config_file.h), and lists of them are not split at commas, which dataset strings may hold.

/// Closed interval of allowed values; NaN is never inside.
struct Range {
  double min;
  double max;
};

enum class FlagPrefix { kGroupName, kNone };

/// An enum becomes an option type by a function `constexpr EnumNames<E> enum_names(E)` beside it.
template <class E>
struct EnumName {
  E value;
  std::string_view name;
};
template <class E>
using EnumNames = std::vector<EnumName<E>>;

/// The value of one option, whatever its type; std::monostate means "not given" and is allowed for std::optional
/// fields.
using OptionValue = std::variant<std::monostate, bool, std::int64_t, double, std::string, std::vector<std::string>,
                                 std::vector<double>>;

enum class OptionType { kBool, kInteger, kNumber, kString, kStringList, kNumberList };

/// One field of an options struct, bound to a live object: `set` checks type and range and writes through.
struct OptionField {
  std::string path;  ///< Dotted JSON path, "camera.hfov_deg".
  std::string flag;  ///< Command-line flag without the dashes, "camera-hfov-deg"; "" for what only files may hold.
  std::string help;
  OptionType type = OptionType::kString;
  bool optional = false;             ///< The field is a std::optional: it may be left unset.
  bool is_path = false;              ///< Its strings are files or GDAL dataset strings.
  std::optional<Range> range;        ///< Inclusive; for lists it holds for each element.
  std::vector<std::string> choices;  ///< Allowed strings of an enum; empty when any string will do.
  OptionValue default_value;         ///< The value the object had when the list was made.
  std::function<OptionValue()> get;
  /// Throws UsageError naming the path, the value and what is allowed.
  std::function<void(const OptionValue&)> set;
};

/// One nested struct, for documentation and JSON Schema.
struct OptionGroup {
  std::string path;
  std::string help;
};

struct OptionList {
  std::vector<OptionField> fields;  ///< In the order of description.
  std::vector<OptionGroup> groups;

  /// The field of a dotted path, or nullptr.
  const OptionField* find(std::string_view path) const;
};

namespace options_detail {

/// Each throws UsageError when `value` is of another type or outside `range`.
bool to_bool(const std::string& path, const OptionValue& value);
std::int64_t to_integer(const std::string& path, const OptionValue& value, const std::optional<Range>& range,
                        std::int64_t type_min, std::int64_t type_max);
double to_number(const std::string& path, const OptionValue& value, const std::optional<Range>& range);
std::string to_string(const std::string& path, const OptionValue& value, const std::vector<std::string>& choices);
std::vector<std::string> to_strings(const std::string& path, const OptionValue& value,
                                    const std::vector<std::string>& choices);
std::vector<double> to_numbers(const std::string& path, const OptionValue& value, const std::optional<Range>& range);
std::string flag_of(std::string_view prefix, std::string_view name);

template <class T>
concept Enum = std::is_enum_v<T>;

template <class T>
struct Unwrap {
  using type = T;
  static constexpr bool optional = false;
};
template <class T>
struct Unwrap<std::optional<T>> {
  using type = T;
  static constexpr bool optional = true;
};

template <class T>
struct ListElement {};
template <class T>
struct ListElement<std::vector<T>> {
  using type = T;
};

template <class E>
std::vector<std::string> choice_names() {
  std::vector<std::string> names;
  for (const auto& entry : enum_names(E{})) names.emplace_back(entry.name);
  return names;
}

template <class E>
std::string enum_to_name(E value) {
  for (const auto& entry : enum_names(E{})) {
    if (entry.value == value) return std::string(entry.name);
  }
  return {};
}

template <class E>
E name_to_enum(std::string_view name) {
  for (const auto& entry : enum_names(E{})) {
    if (entry.name == name) return entry.value;
  }
  return E{};
}

/// How a C++ type appears as an option: its OptionType, and both conversions.
template <class T>
struct OptionTraits;

template <>
struct OptionTraits<bool> {
  static constexpr OptionType kType = OptionType::kBool;
  static OptionValue get(bool value) { return value; }
  static bool set(const OptionField& field, const OptionValue& value) { return to_bool(field.path, value); }
};

template <std::integral T>
requires(!std::same_as<T, bool>) struct OptionTraits<T> {
  static constexpr OptionType kType = OptionType::kInteger;
  static OptionValue get(T value) { return static_cast<std::int64_t>(value); }
  static T set(const OptionField& field, const OptionValue& value) {
    constexpr auto kMin = std::is_unsigned_v<T> ? 0 : static_cast<std::int64_t>(std::numeric_limits<T>::min());
    constexpr auto kMax = sizeof(T) == 8 ? std::numeric_limits<std::int64_t>::max()
                                         : static_cast<std::int64_t>(std::numeric_limits<T>::max());
    return static_cast<T>(to_integer(field.path, value, field.range, kMin, kMax));
  }
};

template <>
struct OptionTraits<double> {
  static constexpr OptionType kType = OptionType::kNumber;
  static OptionValue get(double value) { return value; }
  static double set(const OptionField& field, const OptionValue& value) {
    return to_number(field.path, value, field.range);
  }
};

template <>
struct OptionTraits<std::string> {
  static constexpr OptionType kType = OptionType::kString;
  static OptionValue get(const std::string& value) { return value; }
  static std::string set(const OptionField& field, const OptionValue& value) {
    return to_string(field.path, value, field.choices);
  }
};

template <Enum E>
struct OptionTraits<E> {
  static constexpr OptionType kType = OptionType::kString;
  static OptionValue get(E value) { return enum_to_name(value); }
  static E set(const OptionField& field, const OptionValue& value) {
    return name_to_enum<E>(to_string(field.path, value, field.choices));
  }
};

template <>
struct OptionTraits<std::vector<std::string>> {
  static constexpr OptionType kType = OptionType::kStringList;
  static OptionValue get(const std::vector<std::string>& value) { return value; }
  static std::vector<std::string> set(const OptionField& field, const OptionValue& value) {
    return to_strings(field.path, value, field.choices);
  }
};

template <>
struct OptionTraits<std::vector<double>> {
  static constexpr OptionType kType = OptionType::kNumberList;
  static OptionValue get(const std::vector<double>& value) { return value; }
  static std::vector<double> set(const OptionField& field, const OptionValue& value) {
    return to_numbers(field.path, value, field.range);
  }
};

template <Enum E>
struct OptionTraits<std::vector<E>> {
  static constexpr OptionType kType = OptionType::kStringList;
  static OptionValue get(const std::vector<E>& value) {
    std::vector<std::string> names;
    for (const E e : value) names.push_back(enum_to_name(e));
    return names;
  }
  static std::vector<E> set(const OptionField& field, const OptionValue& value) {
    std::vector<E> result;
    for (const auto& name : to_strings(field.path, value, field.choices)) result.push_back(name_to_enum<E>(name));
    return result;
  }
};

/// Collects the described fields of a live object into an OptionList.
class FieldCollector {
 public:
  explicit FieldCollector(OptionList& list) : list_(list) {}

  template <class T>
  void field(std::string_view name, T& member, std::string_view help, std::optional<Range> range = std::nullopt) {
    using Value = typename Unwrap<T>::type;
    using Traits = OptionTraits<Value>;
    OptionField field;
    field.path = path_prefix_.empty() ? std::string(name) : path_prefix_ + "." + std::string(name);
    field.flag = flag_of(flag_prefix_, name);
    field.help = help;
    field.type = Traits::kType;
    field.optional = Unwrap<T>::optional;
    field.range = range;
    if constexpr (Enum<Value>) field.choices = choice_names<Value>();
    if constexpr (requires { requires Enum<typename ListElement<Value>::type>; }) {
      field.choices = choice_names<typename ListElement<Value>::type>();
    }
    field.get = [&member]() -> OptionValue {
      if constexpr (Unwrap<T>::optional) {
        return member ? Traits::get(*member) : OptionValue{};
      } else {
        return Traits::get(member);
      }
    };
    field.default_value = field.get();
    // The closure keeps its own description: `list_` may move.
    field.set = [&member, description = field](const OptionValue& value) {
      if constexpr (Unwrap<T>::optional) {
        if (std::holds_alternative<std::monostate>(value)) {
          member.reset();
          return;
        }
      }
      member = Traits::set(description, value);
    };
    list_.fields.push_back(std::move(field));
  }

  /// A std::string, std::optional of one, or a list of them, that holds files or GDAL dataset strings.
  template <class T>
  void path(std::string_view name, T& member, std::string_view help) {
    field(name, member, help);
    list_.fields.back().is_path = true;
  }

  template <class Options>
  void group(std::string_view name, Options& options, std::string_view help,
             FlagPrefix prefix = FlagPrefix::kGroupName) {
    const auto outer_path = path_prefix_;
    const auto outer_flag = flag_prefix_;
    path_prefix_ = outer_path.empty() ? std::string(name) : outer_path + "." + std::string(name);
    if (prefix == FlagPrefix::kGroupName) flag_prefix_ = flag_of(outer_flag, name);
    list_.groups.push_back({path_prefix_, std::string(help)});
    Options::describe(options, *this);
    path_prefix_ = outer_path;
    flag_prefix_ = outer_flag;
  }

 private:
  OptionList& list_;
  std::string path_prefix_;
  std::string flag_prefix_;
};

}  // namespace options_detail

/// The fields of `options`, bound to it: the list must not outlive the object.
template <class Options>
OptionList list_options(Options& options) {
  OptionList list;
  options_detail::FieldCollector collector(list);
  Options::describe(options, collector);
  return list;
}

/// Throws UsageError when a value set directly in code lies outside its described range or choices.
/// Library entry points call it, so that the command line and a program are held to the same limits.
template <class Options>
void check_options(const Options& options) {
  Options copy = options;
  const OptionList list = list_options(copy);
  for (const OptionField& field : list.fields) field.set(field.get());
}

/// Writes `text` (as typed on a command line or found in an environment variable) into `field`; lists are split at
/// commas, except lists of paths. Throws UsageError when the text is not a value of the field's type or is outside its
/// range.
void set_from_text(const OptionField& field, const std::vector<std::string>& texts);

/// The value as a person would type it; lists joined by commas, unset as "".
std::string option_to_text(const OptionValue& value);

}  // namespace pilotage

#pragma GCC visibility pop
