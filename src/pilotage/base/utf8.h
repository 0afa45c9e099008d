#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace pilotage {

/// Length of the well-formed UTF-8 sequence (RFC 3629, section 4) at the start of `text`; 0 when there is none.
std::size_t utf8_sequence_length(std::string_view text);

/// `text` after the byte order mark that some editors put before UTF-8; all of it where there is none.
std::string_view without_byte_order_mark(std::string_view text);

/// `text` with every byte that is not part of well-formed UTF-8 replaced by U+FFFD.
std::string valid_utf8(std::string_view text);

/// A file's name, which may be any bytes, as UTF-8 for files that must be: bytes that are not part of well-formed UTF-8
/// become \xHH, and so does a backslash in front of such four characters, so that bytes_of_name gives back every name.
std::string name_as_utf8(std::string_view name);
/// The inverse: \xHH (two lower-case hexadecimal digits) becomes a byte.
std::string bytes_of_name(std::string_view text);

}  // namespace pilotage
