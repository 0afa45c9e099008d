#include "pilotage/base/options.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <sstream>

#include "pilotage/base/error.h"
#include "pilotage/base/text.h"

namespace pilotage {
namespace {

std::string describe_type(const OptionValue& value) {
  static constexpr const char* kNames[] = {"nothing",  "a boolean",         "an integer",       "a number",
                                           "a string", "a list of strings", "a list of numbers"};
  return kNames[value.index()];
}

[[noreturn]] void throw_wrong_type(const std::string& path, const OptionValue& value, const char* wanted) {
  throw UsageError(path + " is " + describe_type(value) + ", expected " + wanted);
}

std::string allowed_list(const std::vector<std::string>& choices) {
  return join(choices, ", ");
}

void check_choice(const std::string& path, const std::string& text, const std::vector<std::string>& choices) {
  if (choices.empty() || std::find(choices.begin(), choices.end(), text) != choices.end()) return;
  const std::string nearest = nearest_word(text, choices);
  throw UsageError(path + " = \"" + text + "\" is not one of: " + allowed_list(choices) +
                   (nearest.empty() ? "" : "; did you mean \"" + nearest + "\"?"));
}

void check_range(const std::string& path, double number, const std::string& shown, const std::optional<Range>& range) {
  if (!std::isfinite(number)) throw UsageError(path + " = " + shown + " is not a finite number");
  if (!range || (number >= range->min && number <= range->max)) return;
  throw UsageError(path + " = " + shown + " is outside [" + format_number(range->min) + ", " +
                   format_number(range->max) + "]");
}

std::optional<std::int64_t> parse_integer(std::string_view text) {
  std::int64_t number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return number;
}

std::vector<std::string> split_lists(const std::vector<std::string>& texts) {
  std::vector<std::string> parts;
  for (const auto& text : texts) {
    std::istringstream stream(text);
    for (std::string part; std::getline(stream, part, ',');) parts.push_back(part);
  }
  return parts;
}

double number_from_text(const OptionField& field, const std::string& text) {
  const auto number = parse_number(text);
  if (!number) throw UsageError(field.path + " = \"" + text + "\" is not a number");
  return *number;
}

}  // namespace

const OptionField* OptionList::find(std::string_view path) const {
  const auto it = std::find_if(fields.begin(), fields.end(), [&](const auto& field) { return field.path == path; });
  return it == fields.end() ? nullptr : &*it;
}

namespace options_detail {

bool to_bool(const std::string& path, const OptionValue& value) {
  if (const auto* flag = std::get_if<bool>(&value)) return *flag;
  throw_wrong_type(path, value, "true or false");
}

std::int64_t to_integer(const std::string& path, const OptionValue& value, const std::optional<Range>& range,
                        std::int64_t type_min, std::int64_t type_max) {
  const auto* integer = std::get_if<std::int64_t>(&value);
  if (integer == nullptr) throw_wrong_type(path, value, "an integer");
  check_range(path, static_cast<double>(*integer), std::to_string(*integer), range);
  if (*integer < type_min || *integer > type_max) {
    throw UsageError(path + " = " + std::to_string(*integer) + " is outside [" + std::to_string(type_min) + ", " +
                     std::to_string(type_max) + "]");
  }
  return *integer;
}

double to_number(const std::string& path, const OptionValue& value, const std::optional<Range>& range) {
  double number = 0;
  if (const auto* real = std::get_if<double>(&value)) {
    number = *real;
  } else if (const auto* integer = std::get_if<std::int64_t>(&value)) {
    number = static_cast<double>(*integer);
  } else {
    throw_wrong_type(path, value, "a number");
  }
  check_range(path, number, format_number(number), range);
  return number;
}

std::string to_string(const std::string& path, const OptionValue& value, const std::vector<std::string>& choices) {
  const auto* text = std::get_if<std::string>(&value);
  if (text == nullptr) throw_wrong_type(path, value, "a string");
  check_choice(path, *text, choices);
  return *text;
}

std::vector<std::string> to_strings(const std::string& path, const OptionValue& value,
                                    const std::vector<std::string>& choices) {
  const auto* texts = std::get_if<std::vector<std::string>>(&value);
  if (texts == nullptr) throw_wrong_type(path, value, "a list of strings");
  for (const auto& text : *texts) check_choice(path, text, choices);
  return *texts;
}

std::vector<double> to_numbers(const std::string& path, const OptionValue& value, const std::optional<Range>& range) {
  const auto* numbers = std::get_if<std::vector<double>>(&value);
  if (numbers == nullptr) throw_wrong_type(path, value, "a list of numbers");
  for (const double number : *numbers) check_range(path, number, format_number(number), range);
  return *numbers;
}

std::string flag_of(std::string_view prefix, std::string_view name) {
  if (name == "file" && !prefix.empty()) return std::string(prefix);
  std::string flag = prefix.empty() ? std::string(name) : std::string(prefix) + "-" + std::string(name);
  std::replace(flag.begin(), flag.end(), '_', '-');
  return flag;
}

}  // namespace options_detail

void set_from_text(const OptionField& field, const std::vector<std::string>& texts) {
  if (field.type == OptionType::kStringList) return field.set(field.is_path ? texts : split_lists(texts));
  if (field.type == OptionType::kNumberList) {
    std::vector<double> numbers;
    for (const auto& part : split_lists(texts)) numbers.push_back(number_from_text(field, part));
    return field.set(numbers);
  }
  if (texts.size() != 1) throw UsageError(field.path + " takes one value, " + std::to_string(texts.size()) + " given");
  const std::string& text = texts.front();
  switch (field.type) {
    case OptionType::kBool:
      if (text == "true" || text == "1") return field.set(true);
      if (text == "false" || text == "0") return field.set(false);
      throw UsageError(field.path + " = \"" + text + "\" is not true or false");
    case OptionType::kInteger: {
      const auto number = parse_integer(text);
      if (!number) throw UsageError(field.path + " = \"" + text + "\" is not an integer");
      return field.set(*number);
    }
    case OptionType::kNumber:
      return field.set(number_from_text(field, text));
    default:
      return field.set(text);
  }
}

std::string option_to_text(const OptionValue& value) {
  struct Visitor {
    std::string operator()(std::monostate) const { return ""; }
    std::string operator()(bool flag) const { return flag ? "true" : "false"; }
    std::string operator()(std::int64_t integer) const { return std::to_string(integer); }
    std::string operator()(double number) const { return format_number(number); }
    std::string operator()(const std::string& text) const { return text; }
    std::string operator()(const std::vector<std::string>& texts) const { return join(texts, ","); }
    std::string operator()(const std::vector<double>& numbers) const {
      std::vector<std::string> texts;
      for (const double number : numbers) texts.push_back(format_number(number));
      return join(texts, ",");
    }
  };
  return std::visit(Visitor{}, value);
}

}  // namespace pilotage
