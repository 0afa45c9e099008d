#include "signed_input.h"

#include <chrono>
#include <filesystem>

#include "stage_files.h"

#include "pilotage/base/error.h"

namespace pilotage {
namespace {

void refuse_any_empty(const std::string& flag, const std::vector<std::string>& values) {
  for (const std::string& value : values) refuse_empty(flag, value);
}

void check_trust_options(const TrustOptions& options) {
  refuse_any_empty("--public-key", options.public_key);
  refuse_any_empty("--key-list", options.key_list);
  refuse_any_empty("--root-key", options.root_key);
  refuse_empty("--signature", options.signature);
  refuse_empty("--mission", options.mission);
  const bool keys = !options.public_key.empty();
  const bool list = !options.key_list.empty();
  if (keys && list) {
    throw UsageError("--public-key and --key-list exclude each other: a key beside the list would get around it");
  }
  if (list && options.root_key.empty()) throw UsageError("--key-list needs --root-key: a key list is signed, too");
  if (!list && !options.root_key.empty()) throw UsageError("--root-key needs --key-list, which it is to have signed");
  if (!list && options.min_key_list_version > 1) throw UsageError("--min-key-list-version needs --key-list");
  if (options.signature && !keys && !list) {
    throw UsageError("--signature needs --public-key or --key-list: a signature is checked with a key");
  }
  if (options.require_signature && !keys && !list) {
    throw UsageError("--require-signature needs --public-key or --key-list: a signature is checked with a key");
  }
}

/// The time by which validity is judged; nothing when what has expired is allowed.
std::optional<UtcTime> judging_time(const TrustOptions& options) {
  std::optional<UtcTime> time = std::chrono::floor<std::chrono::seconds>(std::chrono::system_clock::now());
  if (options.now) time = parse_utc_time(*options.now);
  if (!time) throw UsageError("--now = \"" + *options.now + "\" is not a time like 2026-03-01T06:30:00Z");
  return options.allow_expired ? std::nullopt : time;
}

}  // namespace

std::optional<SignedInput> read_signed_input(const TrustOptions& options, const std::string& path) {
  check_trust_options(options);
  need_file(path, "build` or `pilotage prepare");
  const auto signature = options.signature ? std::optional<std::filesystem::path>(*options.signature) : std::nullopt;
  if (!options.public_key.empty()) {
    return SignedInput{read_signed_map(path, options.public_key, signature), std::nullopt};
  }
  if (options.key_list.empty()) return std::nullopt;
  KeyList list = read_key_lists({options.key_list.begin(), options.key_list.end()}, options.root_key,
                                {options.min_key_list_version, judging_time(options)});
  SignedMap map = read_signed_map(path, list.trusted_keys(), signature);
  return SignedInput{std::move(map), std::move(list)};
}

std::optional<std::string> expiry_warning(const MapReader& map, const TrustOptions& options) {
  if (!options.allow_expired) return std::nullopt;
  TrustOptions strict = options;
  strict.allow_expired = false;
  MapRequirements required;
  required.now = judging_time(strict);
  try {
    check_purpose(map, required);
  } catch (const IntegrityError& error) {
    return std::string(error.what()) + "; taken nevertheless: --allow-expired";
  }
  return std::nullopt;
}

MapRequirements requirements_of(const TrustOptions& options) {
  MapRequirements required;
  required.mission_name = options.mission;
  required.min_version = options.min_version;
  required.now = judging_time(options);
  return required;
}

}  // namespace pilotage
