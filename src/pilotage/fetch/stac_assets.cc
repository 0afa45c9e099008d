#include "pilotage/fetch/stac_assets.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string_view>
#include <utility>

#include <nlohmann/json.hpp>

#include "pilotage/base/error.h"
#include "pilotage/base/json_object.h"
#include "pilotage/base/options_json.h"
#include "pilotage/base/text.h"
#include "pilotage/base/utc_time.h"
#include "pilotage/raster/gdal_text.h"

namespace pilotage {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::string_view kOverNetwork = "/vsicurl/";

/// How GDAL is told an address.
std::string gdal_name_of(const std::string& place) {
  if (place.starts_with("http://") || place.starts_with("https://")) return std::string(kOverNetwork) + place;
  if (place.starts_with("s3://")) return "/vsis3/" + place.substr(5);
  if (place.starts_with("gs://")) return "/vsigs/" + place.substr(5);
  return place;
}

/// Whether a file lies on the network: whatever leads through a file system of GDAL's other than those of archives.
bool is_on_network(const std::string& place) {
  std::string rest = place;
  for (bool packed = true; packed;) {
    packed = false;
    for (const std::string_view archive : {"/vsizip/", "/vsigzip/", "/vsitar/"}) {
      if (!rest.starts_with(archive)) continue;
      rest.erase(0, archive.size());
      packed = true;
    }
    if (rest.starts_with('{')) rest.erase(0, 1);
  }
  return rest.starts_with("/vsi") || rest.find("://") != std::string::npos;
}

/// "https:" of "https://example.org/a"; "" of a path.
std::string scheme_of(const std::string& reference) {
  const std::size_t colon = reference.find(':');
  if (colon == std::string::npos || colon < 2 || reference.find_first_of("/?#") < colon) return "";
  return reference.substr(0, colon + 1);
}

/// RFC 3986, 5.2, of a reference without a scheme; `base` without GDAL's prefix.
std::string resolve_address(const std::string& reference, const std::string& base) {
  const std::size_t scheme = base.find("://");
  const std::size_t host = scheme == std::string::npos ? 0 : scheme + 3;
  const std::size_t path_begin = std::min(base.find_first_of("/?#", host), base.size());
  const std::string root = base.substr(0, path_begin);
  const std::string path = base.substr(path_begin, base.find_first_of("?#", path_begin) - path_begin);
  if (reference.starts_with("//")) return base.substr(0, scheme + 1) + reference;
  if (reference.starts_with('?')) return root + path + reference;
  const std::size_t query = std::min(reference.find_first_of("?#"), reference.size());
  const std::filesystem::path joined = reference.starts_with('/')
                                           ? std::filesystem::path(reference.substr(0, query))
                                           : std::filesystem::path(path).parent_path() / reference.substr(0, query);
  const std::string normal = joined.lexically_normal().string();
  return root + (normal.starts_with('/') ? "" : "/") + normal + reference.substr(query);
}

std::string text_of(const Json& json, const char* key) {
  const auto found = json.find(key);
  return found != json.end() && found->is_string() ? found->get<std::string>() : "";
}

const Json& list_of(const Json& json, const char* key) {
  static const Json empty = Json::array();
  const auto found = json.find(key);
  return found != json.end() && found->is_array() ? *found : empty;
}

const Json& object_of(const Json& json, const char* key) {
  static const Json empty = Json::object();
  const auto found = json.find(key);
  return found != json.end() && found->is_object() ? *found : empty;
}

const Json* find(const Json& json, const char* key) {
  const auto found = json.find(key);
  return found == json.end() || found->is_null() ? nullptr : &*found;
}

bool has_role(const Json& json, std::string_view role) {
  const Json& roles = list_of(json, "roles");
  return std::any_of(roles.begin(), roles.end(), [&](const Json& next) { return next == role; });
}

/// "2023-06-14T10:30:00Z" of a moment that is no midnight, else its day, in UTC (RFC 3339); "" for what is no date.
std::string date_of_stac(const std::string& text) {
  if (text.size() < 20 || (text[10] != 'T' && text[10] != 't')) {
    const std::string day = text.substr(0, 10);
    return parse_utc_date(day) ? day : "";
  }
  const auto clock = parse_utc_time(text.substr(0, 10) + "T" + text.substr(11, 8) + "Z");
  if (!clock) return "";
  const std::string zone = text.substr(std::min(text.find_first_not_of("0123456789.", 19), text.size()));
  std::chrono::minutes ahead{0};
  if (zone.size() == 6 && (zone[0] == '+' || zone[0] == '-') && zone[3] == ':') {
    const auto hours = parse_number(zone.substr(1, 2));
    const auto minutes = parse_number(zone.substr(4, 2));
    if (!hours || !minutes) return "";
    ahead = std::chrono::minutes(static_cast<int>(60 * *hours + *minutes) * (zone[0] == '-' ? -1 : 1));
  } else if (zone != "Z" && zone != "z") {
    return "";
  }
  const std::string moment = format_utc_time(*clock - ahead);
  return moment.ends_with("T00:00:00Z") ? moment.substr(0, 10) : moment;
}

/// The date that the asset says, else the item: of an interval only where it is one day.
void set_date(const Json& said, StacAsset& asset) {
  const std::string first = date_of_stac(text_of(said, "start_datetime")).substr(0, 10);
  const std::string last = date_of_stac(text_of(said, "end_datetime")).substr(0, 10);
  const std::string moment = date_of_stac(text_of(said, "datetime"));
  if (!first.empty() && first != last) {
    asset.acquired.clear();
    asset.of_several_days = true;
  } else if (!moment.empty() || !first.empty()) {
    asset.acquired = moment.empty() ? first : moment;
    asset.of_several_days = false;
  }
}

/// What an item's properties, or a collection, say of it.
Licence licence_of(const Json& json, const Json& links, const std::string& place) {
  Licence licence;
  licence.terms = text_of(json, "license");
  const bool is_no_name = licence.terms == "proprietary" || licence.terms == "various" || licence.terms == "other";
  for (const Json& link : links) {
    if (!is_no_name || text_of(link, "rel") != "license") continue;
    const std::string href = text_of(link, "href");
    const bool is_address = href.starts_with("http://") || href.starts_with("https://");
    if (!is_address && (href.empty() || !scheme_of(href).empty() || !place.starts_with(kOverNetwork))) continue;
    licence.terms += ", " + (is_address ? href : resolve_address(href, place.substr(kOverNetwork.size())));
    break;
  }
  std::vector<std::string> owners;
  std::vector<std::string> all;
  for (const Json& provider : list_of(json, "providers")) {
    const std::string name = text_of(provider, "name");
    if (name.empty()) continue;
    all.push_back(name);
    if (has_role(provider, "licensor") || has_role(provider, "producer")) owners.push_back(name);
  }
  licence.attribution = text_of(json, "attribution");
  if (licence.attribution.empty()) licence.attribution = join(owners.empty() ? all : owners, ", ");
  return licence;
}

/// Nothing where there is none, or it is no rectangle.
std::optional<DegreeBounds> bounds_of(const Json& bbox) {
  if (!bbox.is_array() || (bbox.size() != 4 && bbox.size() != 6)) return std::nullopt;
  if (!std::all_of(bbox.begin(), bbox.end(), [](const Json& next) { return next.is_number(); })) return std::nullopt;
  const std::size_t half = bbox.size() / 2;
  return DegreeBounds{bbox[0].get<double>(), bbox[1].get<double>(), bbox[half].get<double>(),
                      bbox[half + 1].get<double>()};
}

/// Outside every one of the rectangles that are said; of several the first is around the others.
bool is_outside(const Json& bboxes, const DegreeBounds& bounds) {
  if (bboxes.empty()) return false;
  const auto around = bounds_of(bboxes.front());
  return around && !around->intersects(bounds);
}

bool is_raster(const Json& asset) {
  const std::string type = text_of(asset, "type");
  if (!type.empty())
    return type.starts_with("image/tiff") || type.starts_with("image/jp2") ||
           type.starts_with("image/vnd.stac.geotiff");
  std::string href = text_of(asset, "href");
  href.erase(std::min(href.find_first_of("?#"), href.size()));
  std::transform(href.begin(), href.end(), href.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
  return href.ends_with(".tif") || href.ends_with(".tiff") || href.ends_with(".jp2");
}

/// The key of the asset that is the imagery; else why there is none, behind `item`.
struct ChosenAsset {
  std::string key;
  std::string problem;
};

ChosenAsset imagery_asset(const Json& assets, const std::string& wanted, const std::string& item) {
  std::vector<std::string> keys;
  for (const auto& [key, asset] : assets.items()) keys.push_back(key);
  const std::string known = keys.empty() ? "none" : join(keys, ", ");
  if (!wanted.empty()) {
    if (find(assets, wanted.c_str()) != nullptr) return {wanted, ""};
    return {"", item + ": has no asset \"" + wanted + "\"; it has " + known};
  }
  std::array<std::vector<std::string>, 3> by_role;
  for (const auto& [key, asset] : assets.items()) {
    if (!is_raster(asset)) continue;
    const bool is_aside = has_role(asset, "thumbnail") || has_role(asset, "overview") || has_role(asset, "metadata");
    const std::size_t role = has_role(asset, "visual") ? 0 : has_role(asset, "data") ? 1 : 2;
    if (!is_aside) by_role[role].push_back(key);
  }
  for (const std::vector<std::string>& found : by_role) {
    if (found.size() == 1) return {found.front(), ""};
    if (found.size() > 1) {
      return {"", item + ": several of its assets could be the imagery; give --asset " + join(found, " or ")};
    }
  }
  return {"", item + ": none of its assets is a GeoTIFF or JPEG 2000; it has " + known + " (--asset)"};
}

/// Reads catalogues and follows their links.
class StacWalk {
 public:
  StacWalk(const DegreeBounds& bounds, std::string asset, const Progress& progress)
      : bounds_(bounds), asset_(std::move(asset)), progress_(progress) {}

  /// All that leads on from there, one file after the other.
  void walk(const std::string& place) {
    pending_.emplace_back(place, Licence{});
    while (!pending_.empty()) {
      const auto [next, licence] = std::move(pending_.back());
      pending_.pop_back();
      visit(next, licence);
    }
  }

  StacAssets take() { return std::move(found_); }

 private:
  void visit(const std::string& place, const Licence& of_collection) {
    if (!visited_.insert(place).second) return;
    if (visited_.size() > kMaxStacFiles) {
      throw DataError(place + ": is one of more than " + std::to_string(kMaxStacFiles) + " files of a catalogue");
    }
    report_progress(progress_, "reading the catalogue", static_cast<std::int64_t>(visited_.size()), 0);
    const Json json = read(place);
    const std::string type = text_of(json, "type");
    if (type == "Feature" && json.contains("assets")) {
      add_item(json, place, of_collection);
    } else if (type == "FeatureCollection") {
      for (const Json& item : list_of(json, "features")) add_item(item, place, of_collection);
      follow(json, place, of_collection, {"next"});
    } else if (type == "Collection" || type == "Catalog") {
      if (is_outside(list_of(object_of(object_of(json, "extent"), "spatial"), "bbox"), bounds_)) return;
      // A collection's word is of its items; a catalogue says none of its own.
      follow(json, place, type == "Collection" ? licence_of(json, list_of(json, "links"), place) : Licence{},
             {"item", "items", "child"});
    } else {
      throw DataError(place + ": is no STAC item, collection or catalogue (type \"" + type.substr(0, 40) + "\")");
    }
  }

  Json read(const std::string& place) {
    const std::string text = read_gdal_text(place, kMaxStacFileBytes);
    bytes_ += text.size();
    if (bytes_ > kMaxStacBytes) {
      throw DataError(place + ": with it more than " + std::to_string(kMaxStacBytes) + " bytes of catalogues are read");
    }
    return parse_json(place, text);
  }

  void follow(const Json& json, const std::string& place, const Licence& licence,
              const std::vector<std::string>& relations) {
    for (const Json& link : list_of(json, "links")) {
      const std::string relation = text_of(link, "rel");
      if (std::find(relations.begin(), relations.end(), relation) == relations.end()) continue;
      if (text_of(link, "method") == "POST") {
        throw DataError(place +
                        ": its next page is asked for by POST, which is not done; save the pages and name them");
      }
      const std::string target = text_of(link, "href");
      if (target.empty()) continue;
      if (pending_.size() >= 100 * kMaxStacFiles) throw DataError(place + ": has too many links");
      pending_.emplace_back(resolve_stac_reference(target, place), licence);
    }
  }

  /// Of the collection that an item names, where nothing that was read before says it; what cannot be read says none.
  Licence licence_of_its_collection(const Json& item, const std::string& place) {
    for (const Json& link : list_of(item, "links")) {
      if (text_of(link, "rel") != "collection" || text_of(link, "href").empty()) continue;
      const std::string target = resolve_stac_reference(text_of(link, "href"), place);
      const auto known = collections_.find(target);
      if (known != collections_.end()) return known->second;
      Licence licence;
      try {
        const Json json = read(target);
        licence = licence_of(json, list_of(json, "links"), target);
      } catch (const DataError&) {
      }
      return collections_.emplace(target, licence).first->second;
    }
    return {};
  }

  void add_item(const Json& item, const std::string& place, const Licence& of_collection) {
    const std::string id = text_of(item, "id");
    if (id.empty()) throw DataError(place + ": holds an item without an id");
    const auto around = bounds_of(item.contains("bbox") ? item["bbox"] : Json());
    if (around && !around->intersects(bounds_)) return;
    const std::string name = place + ": item " + id;
    const Json& assets = object_of(item, "assets");
    const ChosenAsset chosen = imagery_asset(assets, asset_, name);
    const Json& asset = object_of(assets, chosen.key.c_str());
    const std::string reference = text_of(asset, "href");
    if (chosen.key.empty() || reference.empty()) {
      found_.skipped.push_back(chosen.key.empty() ? chosen.problem
                                                  : name + ": its asset " + chosen.key + " has no href");
      return;
    }
    StacAsset found;
    found.item = id;
    found.key = chosen.key;
    found.dataset = resolve_stac_reference(reference, place);
    if (!datasets_.insert(found.dataset).second) return;  // an item may be reached on several ways
    if (found_.assets.size() >= kMaxStacAssets) {
      throw DataError(place + ": with it more than " + std::to_string(kMaxStacAssets) + " items lie in the rectangle");
    }
    const Json& properties = object_of(item, "properties");
    set_date(properties, found);
    set_date(asset, found);
    const Json& links = list_of(item, "links");
    found.licence = licence_or(licence_of(asset, links, place), licence_of(properties, links, place));
    found.licence = licence_or(found.licence, of_collection);
    if (found.licence.terms.empty() || found.licence.attribution.empty()) {
      found.licence = licence_or(found.licence, licence_of_its_collection(item, place));
    }
    found_.assets.push_back(std::move(found));
  }

  DegreeBounds bounds_;
  std::string asset_;
  const Progress& progress_;
  std::vector<std::pair<std::string, Licence>> pending_;  ///< Places, and what is known of their licence.
  std::set<std::string> visited_;
  std::map<std::string, Licence> collections_;
  std::set<std::string> datasets_;
  std::size_t bytes_ = 0;
  StacAssets found_;
};

}  // namespace

bool DegreeBounds::intersects(const DegreeBounds& other) const {
  if (south_deg > other.north_deg || other.south_deg > north_deg) return false;
  using Lon = std::pair<double, double>;
  const auto parts = [](const DegreeBounds& bounds) {
    if (bounds.west_deg <= bounds.east_deg) return std::vector<Lon>{{bounds.west_deg, bounds.east_deg}};
    return std::vector<Lon>{{bounds.west_deg, 180}, {-180, bounds.east_deg}};
  };
  for (const auto& [west, east] : parts(*this)) {
    for (const auto& [other_west, other_east] : parts(other)) {
      if (west <= other_east && other_west <= east) return true;
    }
  }
  return false;
}

std::string resolve_stac_reference(const std::string& reference, const std::string& base) {
  const std::string named = gdal_name_of(reference);
  if (named != reference) return named;
  const bool from_network = is_on_network(base);
  const std::string scheme = scheme_of(reference);
  if (scheme == "file:" || reference.starts_with("/vsi")) {
    if (from_network) throw DataError(base + ": \"" + reference + "\" leads from the network to files of this machine");
    return scheme.empty() ? reference : reference.substr(reference.starts_with("file:///") ? 7 : 5);
  }
  if (!scheme.empty()) throw DataError(base + ": \"" + reference + "\" is an address of a kind that is not read");
  if (from_network) {
    const std::size_t address = base.starts_with(kOverNetwork) ? kOverNetwork.size() : 0;
    return base.substr(0, address) + resolve_address(reference, base.substr(address));
  }
  const std::filesystem::path path(reference);
  if (path.is_absolute()) return reference;
  return (std::filesystem::path(base).parent_path() / path).lexically_normal().string();
}

StacAssets find_stac_assets(const std::vector<std::string>& places, const DegreeBounds& bounds,
                            const std::string& asset, const Progress& progress) {
  if (places.empty()) throw UsageError("there is no STAC item, collection or catalogue to read");
  StacWalk walk(bounds, asset, progress);
  for (const std::string& place : places) {
    const std::string named = gdal_name_of(place);
    walk.walk(is_on_network(named) ? named : std::filesystem::path(named).lexically_normal().string());
  }
  return walk.take();
}

}  // namespace pilotage
