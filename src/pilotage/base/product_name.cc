#include "pilotage/base/product_name.h"

#include <cctype>
#include <string>

#include "pilotage/base/error.h"
#include "pilotage/base/text.h"

namespace pilotage {
namespace {

std::string plain(std::string_view name) {
  std::string letters;
  for (const char c : name) {
    const auto letter = static_cast<unsigned char>(c);
    if (std::isalnum(letter) != 0) letters += static_cast<char>(std::tolower(letter));
  }
  return letters;
}

}  // namespace

std::size_t product_of_name(std::string_view name, const std::vector<ProductName>& products,
                            const ProductTable& table) {
  const std::string wanted = plain(name);
  std::vector<std::string> names;
  std::vector<std::string> with_a_word;
  std::vector<std::string> plain_names;
  for (std::size_t i = 0; i < products.size(); ++i) {
    const ProductName& product = products[i];
    if (wanted == plain(product.name) || (!product.also.empty() && wanted == plain(product.also))) return i;
    names.emplace_back(product.name);
    plain_names.push_back(plain(product.name));
    if (!wanted.empty() && plain_names.back().find(wanted) != std::string::npos) with_a_word.push_back(names.back());
  }
  const std::string what(table.what);
  if (wanted == "list") throw UsageError("the " + what + "s known by name: " + join(names, "; "));
  if (with_a_word.empty()) {
    const std::string nearest = nearest_word(wanted, plain_names);
    for (std::size_t i = 0; i < names.size(); ++i) {
      if (!nearest.empty() && plain_names[i] == nearest) with_a_word.push_back(names[i]);
    }
  }
  throw UsageError("no " + what + " \"" + std::string(name.substr(0, 60)) + "\" is known by name" +
                   (with_a_word.empty() ? "" : "; did you mean " + join(with_a_word, ", or ") + "?") + " " +
                   std::string(table.flag) + " list names all; " + std::string(table.remedy));
}

}  // namespace pilotage
