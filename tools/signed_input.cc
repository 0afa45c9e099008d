#include "signed_input.h"

#include <filesystem>

#include "stage_files.h"

#include "pilotage/base/error.h"

namespace pilotage {

std::optional<SignedMap> read_signed_input(const SignatureOptions& options, const std::string& path) {
  refuse_empty("--public-key", options.public_key);
  refuse_empty("--signature", options.signature);
  if (options.signature && !options.public_key) {
    throw UsageError("--signature needs --public-key: a signature is checked with a key");
  }
  need_file(path, "build` or `pilotage prepare");
  if (!options.public_key) return std::nullopt;
  const auto signature = options.signature ? std::optional<std::filesystem::path>(*options.signature) : std::nullopt;
  return read_signed_map(path, {*options.public_key}, signature);
}

}  // namespace pilotage
