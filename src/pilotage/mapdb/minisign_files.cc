#include "pilotage/mapdb/minisign_files.h"

#include <algorithm>
#include <utility>

#include <sodium.h>

#include "pilotage/base/error.h"

namespace pilotage {
namespace {

constexpr std::size_t kPublicKeyBytes = 42;  // "Ed", key id, key
constexpr std::size_t kSignatureBytes = 74;  // "Ed" or "ED", key id, signature

}  // namespace

std::vector<std::string> minisign_lines(const std::string& text) {
  std::vector<std::string> lines;
  std::size_t at = 0;
  while (at < text.size()) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    std::string line = text.substr(at, end - at);
    if (!line.empty() && line.back() == '\r') line.pop_back();
    lines.push_back(std::move(line));
    at = end + 1;
  }
  return lines;
}

std::vector<std::uint8_t> minisign_bytes(std::string_view base64, std::size_t size, const std::string& name,
                                         const char* what) {
  std::vector<std::uint8_t> bytes(size);
  std::size_t length = 0;
  // libsodium takes bytes above 127 for "/".
  const bool is_ascii = std::all_of(base64.begin(), base64.end(), [](char c) { return c > 0; });
  const int result = sodium_base642bin(bytes.data(), bytes.size(), base64.data(), base64.size(), nullptr, &length,
                                       nullptr, sodium_base64_VARIANT_ORIGINAL);
  if (!is_ascii || result != 0 || length != size) throw DataError(name + ": is not a minisign " + what);
  return bytes;
}

bool has_minisign_tag(const std::vector<std::uint8_t>& bytes, std::size_t at, std::string_view tag) {
  return bytes[at] == static_cast<std::uint8_t>(tag[0]) && bytes[at + 1] == static_cast<std::uint8_t>(tag[1]);
}

std::string format_key_id(const std::array<std::uint8_t, 8>& key_id) {
  static constexpr char kHex[] = "0123456789ABCDEF";
  std::string text;
  for (auto it = key_id.rbegin(); it != key_id.rend(); ++it) text += {kHex[*it >> 4], kHex[*it & 15]};
  return text;
}

std::string minisign_global_message(const MinisignSignature& signature) {
  return std::string(signature.signature.begin(), signature.signature.end()) + signature.trusted_comment;
}

MinisignPublicKey parse_public_key(const std::string& text, const std::string& name) {
  const std::vector<std::string> lines = minisign_lines(text);
  const bool with_comment = !lines.empty() && lines[0].starts_with(kMinisignUntrusted);
  if (lines.size() < (with_comment ? 2U : 1U)) throw DataError(name + ": is not a minisign public key");
  const std::vector<std::uint8_t> bytes =
      minisign_bytes(lines[with_comment ? 1 : 0], kPublicKeyBytes, name, "public key");
  if (!has_minisign_tag(bytes, 0, "Ed")) throw DataError(name + ": is a key of another algorithm than Ed25519");
  MinisignPublicKey key;
  take_bytes(bytes, 2, key.key_id);
  take_bytes(bytes, 10, key.key);
  return key;
}

MinisignSignature parse_signature(const std::string& text, const std::string& name) {
  const std::vector<std::string> lines = minisign_lines(text);
  if (lines.size() < 4 || !lines[0].starts_with(kMinisignUntrusted) || !lines[2].starts_with(kMinisignTrusted)) {
    throw DataError(name + ": is not a minisign signature");
  }
  const std::vector<std::uint8_t> bytes = minisign_bytes(lines[1], kSignatureBytes, name, "signature");
  MinisignSignature signature;
  signature.prehashed = has_minisign_tag(bytes, 0, "ED");
  if (!signature.prehashed && !has_minisign_tag(bytes, 0, "Ed")) {
    throw DataError(name + ": is a signature of another algorithm than Ed25519");
  }
  take_bytes(bytes, 2, signature.key_id);
  take_bytes(bytes, 10, signature.signature);
  signature.trusted_comment = lines[2].substr(kMinisignTrusted.size());
  take_bytes(minisign_bytes(lines[3], signature.global_signature.size(), name, "signature"), 0,
             signature.global_signature);
  return signature;
}

}  // namespace pilotage
