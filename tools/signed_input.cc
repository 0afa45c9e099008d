#include "signed_input.h"

#include <chrono>
#include <filesystem>

#include "stage_files.h"

#include "pilotage/base/error.h"
#include "pilotage/base/read_file.h"
#include "pilotage/mapdb/trusted_signature.h"

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

TrustedKeys checked_keys_of(const TrustOptions& options) {
  check_trust_options(options);
  if (!options.public_key.empty() || options.key_list.empty()) return {options.public_key, std::nullopt};
  KeyList list = read_key_lists({options.key_list.begin(), options.key_list.end()}, options.root_key,
                                {options.min_key_list_version, judging_time(options)});
  std::vector<std::string> keys = list.trusted_keys();
  if (keys.empty()) throw IntegrityError(options.key_list.back() + ": names no signer, so nothing can be checked");
  return {std::move(keys), std::move(list)};
}

SignedText read_signed_text(const TrustOptions& options, const std::filesystem::path& path, std::uintmax_t max_bytes) {
  TrustedKeys trusted = checked_keys_of(options);
  if (options.signature) throw UsageError("--signature is of a map; that of a pack stands in it");
  SignedText signed_text{read_file(path, max_bytes), std::nullopt, std::nullopt};
  if (trusted.keys.empty()) return signed_text;
  const TrustedSignature signature = read_trusted_signature(signature_path_of(path), trusted.keys);
  check_signed_bytes(path.string(), signed_text.text, signature);
  signed_text.signature = SignatureInfo{signature.signature.trusted_comment, format_key_id(signature.signature.key_id),
                                        signature.signature.prehashed};
  signed_text.key_list = std::move(trusted.list);
  return signed_text;
}

std::optional<SignedInput> read_signed_input(const TrustOptions& options, const std::string& path) {
  TrustedKeys trusted = checked_keys_of(options);
  need_file(path, "build` or `pilotage prepare");
  const auto signature = options.signature ? std::optional<std::filesystem::path>(*options.signature) : std::nullopt;
  if (trusted.keys.empty()) return std::nullopt;
  return SignedInput{read_signed_map(path, trusted.keys, signature), std::move(trusted.list)};
}

void add_signature(const SignatureInfo& signature, const std::optional<KeyList>& key_list, CommandResult& result) {
  result.text += "signed by key " + signature.key_id + ", " + signature.trusted_comment + "\n";
  result.json["signature"] = {{"key_id", signature.key_id}, {"trusted_comment", signature.trusted_comment}};
  if (!key_list) return;
  const ListedKey* const signer = key_list->find_signer(signature.key_id);
  if (signer == nullptr) return;  // cannot be: the list gave the keys
  const std::string valid_until = format_utc_time(key_list->valid_until);
  result.text += "trusted by key list version " + std::to_string(key_list->version) + ", valid until " + valid_until +
                 ": " + signer->name + "\n";
  result.json["key_list"] = {{"version", key_list->version}, {"valid_until", valid_until}, {"signer", signer->name}};
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
