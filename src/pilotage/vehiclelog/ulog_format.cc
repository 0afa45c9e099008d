#include "pilotage/vehiclelog/ulog_format.h"

#include <algorithm>
#include <charconv>

#include "pilotage/vehiclelog/log_bytes.h"

namespace pilotage {
namespace {

constexpr std::size_t kLargestMessage = 65535;  // a record's size has 16 bits
constexpr int kDeepestFormat = 32;              // real logs nest once or twice

struct NumberType {
  std::string_view name;
  std::size_t size;
};
constexpr NumberType kNumberTypes[] = {{"int8_t", 1},  {"uint8_t", 1},  {"int16_t", 2}, {"uint16_t", 2},
                                       {"int32_t", 4}, {"uint32_t", 4}, {"int64_t", 8}, {"uint64_t", 8},
                                       {"float", 4},   {"double", 8},   {"bool", 1},    {"char", 1}};

std::optional<std::size_t> number_size(std::string_view type) {
  for (const NumberType& known : kNumberTypes) {
    if (known.name == type) return known.size;
  }
  return std::nullopt;
}

/// The digits of "[12]", 1 without brackets.
std::optional<std::size_t> count_of(std::string_view type) {
  const std::size_t bracket = type.find('[');
  if (bracket == std::string_view::npos) return 1;
  const std::string_view digits = type.substr(bracket + 1);
  std::size_t count = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), count);
  const bool closed = end + 1 == digits.data() + digits.size() && *end == ']';
  if (error != std::errc() || !closed || count > kLargestMessage) return std::nullopt;
  return count;
}

}  // namespace

bool UlogFormats::add(std::string_view text) {
  const std::size_t colon = text.find(':');
  if (colon == std::string_view::npos || colon == 0) return false;
  std::vector<Field> fields;
  for (std::string_view rest = text.substr(colon + 1); !rest.empty();) {
    const std::size_t end = std::min(rest.find(';'), rest.size());
    const std::string_view part = rest.substr(0, end);
    rest.remove_prefix(std::min(end + 1, rest.size()));
    if (part.empty()) continue;
    const std::size_t blank = part.find(' ');
    if (blank == std::string_view::npos) return false;
    const std::string_view type = part.substr(0, blank);
    const std::optional<std::size_t> count = count_of(type);
    if (!count) return false;
    fields.push_back({std::string(type.substr(0, type.find('['))), *count, std::string(part.substr(blank + 1))});
  }
  const std::size_t added = fields.size() + 1;  // a format without fields takes memory, too
  if (added > kMostFields - field_count_) return false;
  field_count_ += added;
  sizes_.clear();
  formats_[std::string(text.substr(0, colon))] = std::move(fields);
  return true;
}

std::optional<std::size_t> UlogFormats::size_of(const std::string& type, int depth) const {
  if (const auto size = number_size(type)) return size;
  if (depth > kDeepestFormat) return std::nullopt;
  // What is asked for while it is being computed holds itself, and has no size.
  const auto [entry, is_new] = sizes_.try_emplace(type, std::nullopt);
  if (!is_new) return entry->second;
  const std::optional<std::size_t> size = compute_size(type, depth);
  sizes_[type] = size;
  return size;
}

std::optional<std::size_t> UlogFormats::compute_size(const std::string& type, int depth) const {
  const auto format = formats_.find(type);
  if (format == formats_.end()) return std::nullopt;
  std::size_t total = 0;
  for (const Field& field : format->second) {
    const std::optional<std::size_t> size = size_of(field.type, depth + 1);
    if (!size) return std::nullopt;
    total += *size * field.count;
    if (total > kLargestMessage) return std::nullopt;
  }
  return total;
}

std::optional<UlogNumbers> UlogFormats::find(const std::string& message, std::string_view field) const {
  std::size_t offset = 0;
  std::string inside = message;
  for (;;) {
    const std::size_t dot = std::min(field.find('.'), field.size());
    const std::string_view name = field.substr(0, dot);
    const auto format = formats_.find(inside);
    if (format == formats_.end()) return std::nullopt;
    const Field* found = nullptr;
    for (const Field& candidate : format->second) {
      if (candidate.name == name) {
        found = &candidate;
        break;
      }
      const std::optional<std::size_t> size = size_of(candidate.type, 0);
      if (!size || (offset += *size * candidate.count) > kLargestMessage) return std::nullopt;
    }
    if (found == nullptr) return std::nullopt;
    if (dot == field.size()) {
      if (!number_size(found->type)) return std::nullopt;
      return UlogNumbers{offset, found->type, found->count};
    }
    field.remove_prefix(dot + 1);
    inside = found->type;
  }
}

std::optional<double> ulog_number(const UlogNumbers& numbers, std::string_view record, std::size_t index) {
  const std::size_t size = number_size(numbers.type).value_or(0);
  const std::size_t offset = numbers.offset + index * size;
  if (index >= numbers.count || offset + size > record.size()) return std::nullopt;
  if (numbers.type == "float") return float_at(record, offset);
  if (numbers.type == "double") return double_at(record, offset);
  if (numbers.type.starts_with("int")) return static_cast<double>(signed_at(record, offset, size));
  return static_cast<double>(unsigned_at(record, offset, size));
}

}  // namespace pilotage
