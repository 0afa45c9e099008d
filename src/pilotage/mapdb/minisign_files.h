#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace pilotage {

// What is needed to check a signature of minisign (F. Denis, https://jedisct1.github.io/minisign, "Formats"): public
// key and signature as values. The secret key: minisign_secret_key.h.

struct MinisignPublicKey {
  std::array<std::uint8_t, 8> key_id{};
  std::array<std::uint8_t, 32> key{};
};

struct MinisignSignature {
  bool prehashed = true;
  std::array<std::uint8_t, 8> key_id{};
  std::array<std::uint8_t, 64> signature{};
  std::string trusted_comment;
  std::array<std::uint8_t, 64> global_signature{};  ///< Over signature and trusted comment.
};

/// Each parse function throws DataError beginning with `name` when the text is not what it should be.

/// The key alone (56 base64 characters) or the text of a public key file.
MinisignPublicKey parse_public_key(const std::string& text, const std::string& name);

MinisignSignature parse_signature(const std::string& text, const std::string& name);

/// What the global signature covers: the signature and the trusted comment.
std::string minisign_global_message(const MinisignSignature& signature);

/// 16 hex digits, as minisign prints a key id.
std::string format_key_id(const std::array<std::uint8_t, 8>& key_id);

// The pieces that all of minisign's files are made of.

inline constexpr std::string_view kMinisignUntrusted = "untrusted comment: ";
inline constexpr std::string_view kMinisignTrusted = "trusted comment: ";

/// The lines of a text, without their ends.
std::vector<std::string> minisign_lines(const std::string& text);

/// Exactly `size` bytes of base64; else DataError "<name>: is not a minisign <what>".
std::vector<std::uint8_t> minisign_bytes(std::string_view base64, std::size_t size, const std::string& name,
                                         const char* what);

/// Whether the two bytes of `tag` stand at `at`.
bool has_minisign_tag(const std::vector<std::uint8_t>& bytes, std::size_t at, std::string_view tag);

template <std::size_t N>
void take_bytes(const std::vector<std::uint8_t>& bytes, std::size_t at, std::array<std::uint8_t, N>& part) {
  std::copy_n(bytes.begin() + static_cast<std::ptrdiff_t>(at), N, part.begin());
}

}  // namespace pilotage
