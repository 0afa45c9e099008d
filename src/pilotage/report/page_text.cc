#include "pilotage/report/page_text.h"

#include <bit>
#include <cstring>
#include <stdexcept>

#include <nlohmann/json.hpp>

#include "pilotage/base/utf8.h"

namespace pilotage {

nlohmann::ordered_json valid_utf8_json(const nlohmann::ordered_json& json) {
  if (json.is_string()) return valid_utf8(json.get_ref<const std::string&>());
  if (!json.is_structured()) return json;
  nlohmann::ordered_json result = json.is_array() ? nlohmann::ordered_json::array() : nlohmann::ordered_json::object();
  for (const auto& item : json.items()) {
    if (json.is_array()) {
      result.push_back(valid_utf8_json(item.value()));
    } else {
      result[valid_utf8(item.key())] = valid_utf8_json(item.value());
    }
  }
  return result;
}

std::string script_json(const nlohmann::ordered_json& json) {
  const std::string text = json.dump();
  std::string result;
  result.reserve(text.size());
  for (std::size_t at = 0; at < text.size(); ++at) {
    const std::string_view rest = std::string_view(text).substr(at);
    if (text[at] == '<') {
      result += "\\u003c";
    } else if (text[at] == '>') {
      result += "\\u003e";
    } else if (text[at] == '&') {
      result += "\\u0026";
    } else if (rest.starts_with("\xE2\x80\xA8") || rest.starts_with("\xE2\x80\xA9")) {
      result += text[at + 2] == '\xA8' ? "\\u2028" : "\\u2029";
      at += 2;
    } else {
      result += text[at];
    }
  }
  return result;
}

std::string base64(std::string_view bytes) {
  constexpr std::string_view kAlphabet = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  const auto byte_at = [&](std::size_t at) { return at < bytes.size() ? static_cast<unsigned char>(bytes[at]) : 0U; };
  std::string result;
  result.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t at = 0; at < bytes.size(); at += 3) {
    const unsigned group = byte_at(at) << 16 | byte_at(at + 1) << 8 | byte_at(at + 2);
    result += kAlphabet[group >> 18];
    result += kAlphabet[group >> 12 & 63];
    result += at + 1 < bytes.size() ? kAlphabet[group >> 6 & 63] : '=';
    result += at + 2 < bytes.size() ? kAlphabet[group & 63] : '=';
  }
  return result;
}

std::string base64_doubles(const std::vector<double>& numbers) {
  static_assert(std::endian::native == std::endian::little, "the page reads little-endian numbers");
  std::string bytes(numbers.size() * sizeof(double), '\0');
  std::memcpy(bytes.data(), numbers.data(), bytes.size());
  return base64(bytes);
}

std::string fill_template(std::string_view page, const std::map<std::string, std::string, std::less<>>& values) {
  std::string result;
  for (std::size_t at = 0;;) {
    const std::size_t open = page.find("{{", at);
    if (open == std::string_view::npos) return result += page.substr(at);
    const std::size_t close = page.find("}}", open);
    if (close == std::string_view::npos) throw std::logic_error("the report's page opens {{ and does not close it");
    const std::string name(page.substr(open + 2, close - open - 2));
    const auto value = values.find(name);
    if (value == values.end()) throw std::logic_error("the report's page names {{" + name + "}}, which has no value");
    result += page.substr(at, open - at);
    result += value->second;
    at = close + 2;
  }
}

}  // namespace pilotage
