#include "pilotage/raster/gdal_xml.h"

#include <algorithm>
#include <memory>

#include <cpl_minixml.h>

#include "pilotage/base/error.h"
#include "pilotage/raster/gdal_handle.h"

namespace pilotage {
namespace {

constexpr int kDeepestElement = 64;

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view kXmlBlanks = " \t\r\n";
  const auto first = text.find_first_not_of(kXmlBlanks);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kXmlBlanks) - first + 1);
}

XmlElement element_of(const CPLXMLNode& node, const std::string& name, int depth) {
  if (depth > kDeepestElement) {
    throw DataError(name + ": its XML is nested deeper than " + std::to_string(kDeepestElement) + " elements");
  }
  XmlElement element;
  const std::string_view full_name = node.pszValue;
  element.name = full_name.substr(full_name.find(':') + 1);  // npos + 1 is 0
  for (const CPLXMLNode* child = node.psChild; child != nullptr; child = child->psNext) {
    if (child->eType == CXT_Element) element.children.push_back(element_of(*child, name, depth + 1));
    if (child->eType == CXT_Text) element.text += child->pszValue;
    if (child->eType == CXT_Attribute) {
      element.attributes.emplace_back(child->pszValue, child->psChild == nullptr ? "" : child->psChild->pszValue);
    }
  }
  element.text = trimmed(element.text);
  return element;
}

}  // namespace

const XmlElement* XmlElement::child(std::string_view child_name) const {
  const auto found = std::find_if(children.begin(), children.end(),
                                  [&](const XmlElement& element) { return element.name == child_name; });
  return found == children.end() ? nullptr : &*found;
}

std::string XmlElement::child_text(std::string_view child_name) const {
  const XmlElement* element = child(child_name);
  return element == nullptr ? "" : element->text;
}

const std::string* XmlElement::attribute(std::string_view attribute_name) const {
  const auto found = std::find_if(attributes.begin(), attributes.end(),
                                  [&](const auto& attribute) { return attribute.first == attribute_name; });
  return found == attributes.end() ? nullptr : &found->second;
}

XmlElement parse_xml(const std::string& name, std::string_view text) {
  const GdalErrors errors;
  const std::string terminated(text);
  const std::unique_ptr<CPLXMLNode, decltype(&CPLDestroyXMLNode)> document(CPLParseXMLString(terminated.c_str()),
                                                                           CPLDestroyXMLNode);
  if (!document) errors.throw_data_error(name + ": is not well-formed XML");
  for (const CPLXMLNode* node = document.get(); node != nullptr; node = node->psNext) {
    // The declaration <?xml …?> is an element of that name to GDAL.
    if (node->eType == CXT_Element && node->pszValue[0] != '?') return element_of(*node, name, 1);
  }
  throw DataError(name + ": is not well-formed XML: it has no element");
}

}  // namespace pilotage
