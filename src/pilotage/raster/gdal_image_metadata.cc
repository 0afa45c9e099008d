#include "pilotage/raster/gdal_image_metadata.h"

#include <memory>
#include <string_view>

#include <cpl_minixml.h>
#include <gdal_priv.h>

#include "pilotage/raster/gdal_handle.h"

namespace pilotage {
namespace {

constexpr std::string_view kExifPrefix = "EXIF_";
constexpr int kMaxDepth = 100;

struct XmlFree {
  void operator()(CPLXMLNode* node) const { CPLDestroyXMLNode(node); }
};

std::string without_blanks(std::string_view text) {
  constexpr std::string_view kBlanks = " \t\r\n";
  const std::size_t begin = text.find_first_not_of(kBlanks);
  if (begin == std::string_view::npos) return "";
  return std::string(text.substr(begin, text.find_last_not_of(kBlanks) - begin + 1));
}

/// Attributes, and elements that hold nothing but text, of a node, its siblings and all below.
void collect(const CPLXMLNode* node, int depth, std::map<std::string, std::string>& properties) {
  for (; node != nullptr && depth < kMaxDepth; node = node->psNext) {
    const std::string_view name = node->pszValue != nullptr ? node->pszValue : "";
    const CPLXMLNode* child = node->psChild;
    const bool holds_text = child != nullptr && child->eType == CXT_Text && child->psNext == nullptr;
    const bool is_property = node->eType == CXT_Attribute || (node->eType == CXT_Element && holds_text);
    if (is_property && holds_text && !name.starts_with("xmlns")) {
      properties.emplace(name, without_blanks(child->pszValue));
    } else if (node->eType == CXT_Element) {
      collect(child, depth + 1, properties);
    }
  }
}

}  // namespace

ImageMetadata read_image_metadata(const std::string& dataset) {
  const DatasetPtr opened = open_raster(dataset);
  const GdalErrors errors;  // packets that are no XML are reported, too
  ImageMetadata metadata;
  metadata.width_px = opened->GetRasterXSize();
  metadata.height_px = opened->GetRasterYSize();
  for (const char* domain : {"", "EXIF"}) {  // JPEG keeps the tags in the first, TIFF in the second
    for (char** item = opened->GetMetadata(domain); item != nullptr && *item != nullptr; ++item) {
      const std::string_view pair = *item;
      const std::size_t equals = pair.find('=');
      if (!pair.starts_with(kExifPrefix) || equals == std::string_view::npos) continue;
      metadata.exif.emplace(pair.substr(kExifPrefix.size(), equals - kExifPrefix.size()),
                            without_blanks(pair.substr(equals + 1)));
    }
  }
  char** packet = opened->GetMetadata("xml:XMP");
  if (packet == nullptr || *packet == nullptr) return metadata;
  const std::unique_ptr<CPLXMLNode, XmlFree> root(CPLParseXMLString(*packet));
  collect(root.get(), 0, metadata.xmp);
  return metadata;
}

}  // namespace pilotage
