#include <cstdlib>
#include <filesystem>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include <cpl_minixml.h>
#include <cpl_string.h>
#include <cpl_vsi.h>

#include "pilotage/base/error.h"
#include "pilotage/raster/gdal_guard.h"
#include "pilotage/raster/gdal_handle.h"
#include "pilotage/raster/gdal_sqlite.h"

namespace pilotage {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kMark = "<VRTDataset";               // by which GDAL knows a VRT, in its first bytes
constexpr std::size_t kHeadBytes = 1024;                        // as many as GDAL looks at
constexpr std::uint64_t kMaxVrtBytes = std::uint64_t{1} << 28;  // half a million sources
constexpr int kMaxXmlDepth = 100;

struct XmlTree {
  void operator()(CPLXMLNode* node) const { CPLDestroyXMLNode(node); }
};

/// The text of a VRT's file, or "" when it is none.
std::string vrt_text(const std::string& file) {
  const std::unique_ptr<VSILFILE, int (*)(VSILFILE*)> stream(VSIFOpenL(file.c_str(), "rb"), VSIFCloseL);
  if (stream == nullptr) return "";
  std::string text(kHeadBytes, '\0');
  text.resize(VSIFReadL(text.data(), 1, text.size(), stream.get()));
  if (text.find(kMark) == std::string::npos) return "";
  VSIFSeekL(stream.get(), 0, SEEK_END);
  const std::uint64_t bytes = VSIFTellL(stream.get());
  if (bytes > kMaxVrtBytes) {
    throw DataError(file + ": has " + std::to_string(bytes) + " bytes, a VRT at most " + std::to_string(kMaxVrtBytes));
  }
  VSIFSeekL(stream.get(), 0, SEEK_SET);
  text.resize(bytes);
  text.resize(VSIFReadL(text.data(), 1, text.size(), stream.get()));
  return text;
}

std::string parent_of(const std::string& file) {
  const fs::path parent = fs::path(file).parent_path();
  return parent.empty() ? "." : parent.string();
}

/// The VRTs of one that is opened, and what they name.
class VrtCheck {
 public:
  /// `folder`: where sources may lie; "" is nowhere.
  VrtCheck(std::string vrt, std::string folder) : vrt_(std::move(vrt)), folder_(std::move(folder)) {
    std::error_code ignored;
    root_ = is_virtual(folder_) ? fs::path(folder_).lexically_normal() : fs::weakly_canonical(folder_, ignored);
  }

  void check_text(const std::string& text, const std::string& folder) {
    const GdalErrors errors;  // GDAL says what is wrong with it when it opens it
    const std::unique_ptr<CPLXMLNode, XmlTree> tree(CPLParseXMLString(text.c_str()));
    check_node(tree.get(), folder, 0);
  }

 private:
  static bool is_virtual(const std::string& path) { return path.starts_with("/vsi"); }

  void check_node(const CPLXMLNode* node, const std::string& folder, int depth) {
    if (depth > kMaxXmlDepth) throw DataError(vrt_ + ": its XML is nested more than 100 deep");
    for (; node != nullptr; node = node->psNext) {
      if (node->eType != CXT_Element) continue;
      if (EQUAL(node->pszValue, "VRTRasterBand") && EQUAL(text_of(node, "subClass"), "VRTRawRasterBand")) {
        throw DataError(vrt_ +
                        ": has a raw band (VRTRawRasterBand), which shows any file as pixels; convert it "
                        "(gdal_translate), or give --allow-any-vrt");
      }
      if (names_dataset(node)) check_source(text_of(node, ""), text_of(node, "relativeToVRT"), folder);
      check_node(node->psChild, folder, depth + 1);
    }
  }

  /// As GDAL reads it: an attribute or an element of this name.
  static const char* text_of(const CPLXMLNode* node, const char* name) { return CPLGetXMLValue(node, name, ""); }

  static bool names_dataset(const CPLXMLNode* node) {
    for (const char* element : {"SourceFilename", "SourceDataset", "DEMPath"}) {
      if (EQUAL(node->pszValue, element)) return true;
    }
    if (!EQUAL(node->pszValue, "MDI")) return false;
    for (const char* key : {"X_DATASET", "Y_DATASET", "OVERVIEW_FILE", "RPC_DEM"}) {
      if (EQUAL(text_of(node, "key"), key)) return true;
    }
    return false;
  }

  void check_source(const std::string& name, const std::string& relative, const std::string& folder) {
    if (name.empty()) return;
    const bool beside = std::strtol(relative.c_str(), nullptr, 10) != 0;
    const std::string source = beside && fs::path(name).is_relative() ? folder + "/" + name : name;
    std::error_code ignored;
    const bool is_file = fs::is_regular_file(source, ignored) || fs::is_directory(source, ignored);
    // What is no file may mean something to a driver of GDAL: "NETCDF:a.nc:x", "<GDAL_WMS>…".
    const bool names_more = !is_file && !is_virtual(source) && name.find_first_of(":<") != std::string::npos;
    if (names_more || !lies_inside(source)) {
      throw DataError(vrt_ + ": its source \"" + name + "\" is no file " +
                      (folder_.empty() ? "of a folder (it is no file itself)" : "in the folder " + folder_) +
                      "; bring it there, or give --allow-any-vrt");
    }
    if (!seen_.insert(source).second) return;
    const std::string parent = parent_of(source);
    if (!special_.contains(parent)) special_[parent] = special_files_in(parent);
    refuse_special_beside(source, special_[parent]);
    check_sqlite_raster(source);
    const std::string text = vrt_text(source);
    if (!text.empty()) check_text(text, parent);
  }

  bool lies_inside(const std::string& source) const {
    if (folder_.empty()) return false;
    std::error_code error;
    const fs::path path = is_virtual(source) || is_virtual(folder_) ? fs::path(source).lexically_normal()
                                                                    : fs::weakly_canonical(source, error);
    const fs::path way = path.lexically_relative(root_);
    return !error && !way.empty() && *way.begin() != "..";
  }

  std::string vrt_;
  std::string folder_;
  fs::path root_;
  std::set<std::string> seen_;
  std::map<std::string, std::vector<std::string>> special_;  // by folder
};

}  // namespace

void check_vrt(const std::string& dataset) {
  constexpr std::string_view kConnection = "vrt://";  // "vrt://a.tif?bands=1"
  if (dataset.starts_with(kConnection)) {
    return check_access(dataset.substr(kConnection.size(), dataset.find('?') - kConnection.size()));
  }
  if (dataset.find(kMark) != std::string::npos)
    return VrtCheck("the VRT that is given as text", "").check_text(dataset, "");
  const std::string text = vrt_text(dataset);
  if (!text.empty()) VrtCheck(dataset, parent_of(dataset)).check_text(text, parent_of(dataset));
}

}  // namespace pilotage
