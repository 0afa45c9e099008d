// Any bytes as each of minisign's three files: DataError, UsageError for a key that wants a passphrase, or a value; a
// signature's own file gives it again.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <optional>
#include <string>

#include "fuzz/fuzz_targets.h"

#include "pilotage/base/error.h"
#include "pilotage/mapdb/minisign_secret_key.h"

namespace pilotage {
namespace {

/// What `read` makes of the text, written by `write`; nothing when it is refused.
template <class Read, class Write>
std::optional<std::string> read_and_write(const std::string& text, const Read& read, const Write& write) {
  try {
    return write(read(text));
  } catch (const DataError&) {
  } catch (const UsageError&) {
  }
  return std::nullopt;
}

std::string nothing(const auto&) {
  return {};
}

}  // namespace

void fuzz_signature(const std::uint8_t* data, std::size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  const auto as_public_key = [](const std::string& file) { return parse_public_key(file, "fuzz"); };
  const auto as_secret_key = [](const std::string& file) { return parse_secret_key(file, {}, "fuzz"); };
  const auto as_signature = [](const std::string& file) { return parse_signature(file, "fuzz"); };
  read_and_write(text, as_public_key, [](const auto& key) { return nothing(key); });
  read_and_write(text, as_secret_key, [](const auto& key) { return nothing(key); });
  const auto written = read_and_write(text, as_signature, format_signature_file);
  if (written && read_and_write(*written, as_signature, format_signature_file) != written) std::abort();
}

}  // namespace pilotage
