#pragma once

#include <cstddef>
#include <string_view>
#include <vector>

namespace pilotage {

/// What a product of a table is called.
struct ProductName {
  std::string_view name;
  std::string_view also;  ///< Another name it is known by; "" for none.
};

/// How an error about such a table speaks of it: "no camera "x" is known by name; --camera-name list names all; any …".
struct ProductTable {
  std::string_view what;    ///< One of its products, "camera".
  std::string_view flag;    ///< The option that takes the name, "--camera-name".
  std::string_view remedy;  ///< How else such a thing can be given.
};

/// The index of the product of that name, or of that other name; case, blanks and punctuation do not matter. Throws
/// UsageError that names those spelt most alike; for the name "list" one that names all.
std::size_t product_of_name(std::string_view name, const std::vector<ProductName>& products, const ProductTable& table);

}  // namespace pilotage
