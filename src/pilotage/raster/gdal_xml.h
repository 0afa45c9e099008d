#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace pilotage {

/// An element of an XML document: its name without the prefix of its namespace, the text that stands directly in it
/// (without blanks at either end), its attributes and the elements in it in the order of the document.
struct XmlElement {
  std::string name;
  std::string text;
  std::vector<std::pair<std::string, std::string>> attributes;  ///< Names with their prefixes.
  std::vector<XmlElement> children;

  /// The first child of that name; nullptr when there is none.
  const XmlElement* child(std::string_view child_name) const;
  /// Its text; "" when there is none.
  std::string child_text(std::string_view child_name) const;
  /// The value of an attribute; nullptr when there is none.
  const std::string* attribute(std::string_view attribute_name) const;
};

/// The root element of an XML text in UTF-8. `name` stands in messages. Throws DataError when the text is not well
/// formed, has no root, or is nested deeper than 64 elements.
XmlElement parse_xml(const std::string& name, std::string_view text);

}  // namespace pilotage
