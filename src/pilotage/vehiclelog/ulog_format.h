#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace pilotage {

/// Where the numbers of a field lie in a message, and of which type they are ("uint64_t", "float", …).
struct UlogNumbers {
  std::size_t offset = 0;
  std::string type;
  std::size_t count = 1;
};

/// The message formats of a ULog file: "name:type field;type field;…", where a type may be another format, and may be
/// followed by [count].
class UlogFormats {
 public:
  /// Takes the text of a format message; what is no format is left out (false), and so are formats beyond
  /// kMostFields fields in all: real logs have some thousand, and one takes twenty times its bytes in memory.
  bool add(std::string_view text);

  /// Where `field` of the format `message` lies: a name, or names of nested fields with dots ("status.q"). Nothing when
  /// there is no such field, when it holds no numbers, or when what stands before it has no size: an unknown type, a
  /// format inside itself, more than 64 KiB.
  std::optional<UlogNumbers> find(const std::string& message, std::string_view field) const;

 private:
  struct Field {
    std::string type;
    std::size_t count = 1;
    std::string name;
  };

  std::optional<std::size_t> size_of(const std::string& type, int depth) const;
  std::optional<std::size_t> compute_size(const std::string& type, int depth) const;

  static constexpr std::size_t kMostFields = 200'000;

  std::map<std::string, std::vector<Field>> formats_;
  std::size_t field_count_ = 0;
  mutable std::map<std::string, std::optional<std::size_t>> sizes_;
};

/// The number `index` of `numbers` in a record; nothing when the record is too short for it.
std::optional<double> ulog_number(const UlogNumbers& numbers, std::string_view record, std::size_t index);

}  // namespace pilotage
