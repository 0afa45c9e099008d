// Any bytes as each of minisign's three files: DataError, UsageError for a key that wants a passphrase, or a value that
// its own file gives again.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>

#include "pilotage/base/error.h"
#include "pilotage/mapdb/minisign_files.h"

namespace {

template <class Read, class Write>
void read_twice(const std::string& text, const Read& read, const Write& write) {
  std::string written;
  try {
    written = write(read(text));
  } catch (const pilotage::DataError&) {
    return;
  } catch (const pilotage::UsageError&) {
    return;
  }
  if (write(read(written)) != written) std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  read_twice(
      text, [](const std::string& file) { return pilotage::parse_public_key(file, "fuzz"); },
      pilotage::format_public_key_file);
  read_twice(
      text, [](const std::string& file) { return pilotage::parse_signature(file, "fuzz"); },
      pilotage::format_signature_file);
  read_twice(
      text, [](const std::string& file) { return pilotage::parse_secret_key(file, {}, "fuzz"); },
      [](const pilotage::MinisignSecretKey& key) { return pilotage::format_secret_key_file(key, {}); });
  return 0;
}
