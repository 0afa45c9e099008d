#include "pilotage/raster/gdal_datum.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <iterator>
#include <map>
#include <memory>
#include <mutex>
#include <string_view>
#include <tuple>

#include <proj.h>

#include "pilotage/base/error.h"
#include "pilotage/geo/geodesic.h"
#include "pilotage/raster/gdal_crs.h"

namespace pilotage {
namespace {

struct ProjDeleter {
  void operator()(PJ_CONTEXT* context) const { proj_context_destroy(context); }
  void operator()(PJ* object) const { proj_destroy(object); }
  void operator()(PJ_OBJ_LIST* list) const { proj_list_destroy(list); }
  void operator()(PJ_OPERATION_FACTORY_CONTEXT* factory) const { proj_operation_factory_context_destroy(factory); }
};
template <class T>
using ProjPtr = std::unique_ptr<T, ProjDeleter>;

ProjPtr<PJ_CONTEXT> quiet_context() {
  ProjPtr<PJ_CONTEXT> context(proj_context_create());
  proj_log_level(context.get(), PJ_LOG_NONE);
  return context;
}

ProjPtr<PJ> horizontal_crs(PJ_CONTEXT* context, const Crs& crs) {
  ProjPtr<PJ> object(proj_create(context, crs.wkt().c_str()));
  if (object && proj_get_type(object.get()) == PJ_TYPE_COMPOUND_CRS) {
    object.reset(proj_crs_get_sub_crs(context, object.get(), 0));
  }
  if (!object) throw DataError("PROJ cannot read the CRS \"" + crs.name() + "\"");
  return object;
}

/// The first grid of an operation that is not installed.
std::string missing_grid_of(PJ_CONTEXT* context, const PJ* operation) {
  for (int i = 0; i < proj_coordoperation_get_grid_used_count(context, operation); ++i) {
    const char* name = nullptr;
    int available = 0;
    if (proj_coordoperation_get_grid_used(context, operation, i, &name, nullptr, nullptr, nullptr, nullptr, nullptr,
                                          &available) != 0 &&
        available == 0 && name != nullptr) {
      return name;
    }
  }
  return "";
}

DatumShift find_datum_shift(const Crs& crs, GeodeticPoint place) {
  const ProjPtr<PJ_CONTEXT> context = quiet_context();
  const ProjPtr<PJ> source = horizontal_crs(context.get(), crs);
  const ProjPtr<PJ> wgs84(proj_create(context.get(), "EPSG:4326"));
  const ProjPtr<PJ_OPERATION_FACTORY_CONTEXT> factory(proj_create_operation_factory_context(context.get(), nullptr));
  constexpr double kAround_deg = 0.01;
  proj_operation_factory_context_set_area_of_interest(
      context.get(), factory.get(), place.lon_deg - kAround_deg, std::max(-90.0, place.lat_deg - kAround_deg),
      place.lon_deg + kAround_deg, std::min(90.0, place.lat_deg + kAround_deg));
  proj_operation_factory_context_set_spatial_criterion(context.get(), factory.get(),
                                                       PROJ_SPATIAL_CRITERION_PARTIAL_INTERSECTION);
  proj_operation_factory_context_set_grid_availability_use(context.get(), factory.get(),
                                                           PROJ_GRID_AVAILABILITY_IGNORED);
  const ProjPtr<PJ_OBJ_LIST> operations(
      proj_create_operations(context.get(), source.get(), wgs84.get(), factory.get()));
  const int count = operations ? proj_list_get_count(operations.get()) : 0;
  DatumShift shift;
  for (int i = 0; i < count; ++i) {
    const ProjPtr<PJ> operation(proj_list_get(context.get(), operations.get(), i));
    const double accuracy_m = proj_coordoperation_get_accuracy(context.get(), operation.get());
    const auto known = accuracy_m >= 0 ? std::optional(accuracy_m) : std::nullopt;
    if (proj_coordoperation_is_instantiable(context.get(), operation.get()) != 0) {
      const char* name = proj_get_name(operation.get());
      shift.operation = name != nullptr ? name : "";
      shift.accuracy_m = known;
      shift.ballpark = proj_coordoperation_has_ballpark_transformation(context.get(), operation.get()) != 0;
      break;
    }
    // Best first: what comes before the one that is taken would be better.
    if (!shift.missing_grid.empty()) continue;
    shift.missing_grid = missing_grid_of(context.get(), operation.get());
    shift.accuracy_with_grid_m = known;
  }
  if (shift.accuracy_m && shift.accuracy_with_grid_m && !(*shift.accuracy_with_grid_m < *shift.accuracy_m)) {
    shift.missing_grid.clear();
    shift.accuracy_with_grid_m.reset();
  }
  return shift;
}

std::string lower_case(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

/// Geographic CRSs on an ellipsoid, by a word in its name.
struct EllipsoidDatums {
  std::string_view word;
  std::array<std::string_view, 5> crs;
};
constexpr EllipsoidDatums kDatums[] = {
    {"bessel", {"EPSG:4312", "EPSG:4156", "EPSG:4314", "EPSG:4301", "EPSG:4149"}},
    {"krass", {"EPSG:4284", "EPSG:4178", "EPSG:4179", "EPSG:4214", ""}},
    {"international 1924", {"EPSG:4230", "EPSG:4265", "EPSG:4207", "EPSG:4272", "EPSG:4274"}},
    {"clarke 1866", {"EPSG:4267", "EPSG:4253", "", "", ""}},
    {"airy", {"EPSG:4277", "EPSG:4299", "", "", ""}},
    {"clarke 1880", {"EPSG:4275", "EPSG:4222", "EPSG:4209", "EPSG:4210", "EPSG:4240"}},
    {"australian", {"EPSG:4202", "EPSG:4203", "", "", ""}},
    {"everest", {"EPSG:4240", "EPSG:4298", "EPSG:4245", "", ""}}};

struct DatumNames {
  std::string datum;  ///< In small letters.
  std::string ellipsoid;
  double semi_major_m = 0;
  bool is_bound = false;  ///< The CRS says itself how to get to WGS 84.
};

DatumNames datum_names(const Crs& crs) {
  const ProjPtr<PJ_CONTEXT> context = quiet_context();
  const ProjPtr<PJ> object = horizontal_crs(context.get(), crs);
  const ProjPtr<PJ> datum(proj_crs_get_datum_forced(context.get(), object.get()));
  const ProjPtr<PJ> ellipsoid(proj_get_ellipsoid(context.get(), object.get()));
  const auto name_of = [](const PJ* thing) {
    const char* name = thing != nullptr ? proj_get_name(thing) : nullptr;
    return std::string(name != nullptr ? name : "");
  };
  DatumNames names{lower_case(name_of(datum.get())), name_of(ellipsoid.get()), 0,
                   proj_get_type(object.get()) == PJ_TYPE_BOUND_CRS};
  if (ellipsoid) {
    proj_ellipsoid_get_parameters(context.get(), ellipsoid.get(), &names.semi_major_m, nullptr, nullptr, nullptr);
  }
  return names;
}

bool is_unknown(const std::string& datum) {
  return datum.find("unknown") != std::string::npos || datum.find("specified") != std::string::npos ||
         datum.find("undefined") != std::string::npos;
}

/// Of WGS 84 and of GRS 1980.
bool is_near_wgs84(const DatumNames& names) {
  constexpr double kSemiMajor_m = 6378137;
  return std::abs(names.semi_major_m - kSemiMajor_m) < 1e-3;
}

}  // namespace

DatumShift datum_shift(const Crs& crs, GeodeticPoint place) {
  // PROJ searches its database for tens of milliseconds, and a mosaic asks it for each of its rasters.
  using Key = std::tuple<std::string, double, double>;
  static std::mutex mutex;
  static auto& found = *new std::map<Key, DatumShift>;
  const Key key(crs.wkt(), std::floor(place.lon_deg), std::floor(place.lat_deg));
  const std::lock_guard lock(mutex);
  const auto known = found.find(key);
  if (known != found.end()) return known->second;
  return found.emplace(key, find_datum_shift(crs, place)).first->second;
}

std::string ellipsoid_without_datum(const Crs& crs) {
  const DatumNames names = datum_names(crs);
  if (!is_unknown(names.datum) || names.is_bound || is_near_wgs84(names)) return "";
  return names.ellipsoid.empty() ? "unknown" : names.ellipsoid;
}

NearWgs84 near_wgs84(const Crs& crs) {
  const DatumNames names = datum_names(crs);
  if (!is_near_wgs84(names)) return NearWgs84::kFar;
  const std::string said = is_unknown(names.datum) ? lower_case(names.ellipsoid) : names.datum;
  std::string letters;
  std::copy_if(said.begin(), said.end(), std::back_inserter(letters),
               [](unsigned char c) { return std::isalnum(c) != 0; });
  for (const std::string_view same : {"wgs84", "wgs1984", "worldgeodeticsystem1984"}) {
    if (letters.find(same) != std::string::npos) return NearWgs84::kSame;
  }
  return NearWgs84::kNear;
}

std::vector<PossibleDatum> possible_datums(const std::string& ellipsoid, GeodeticPoint place) {
  std::vector<PossibleDatum> possible;
  const std::string name = lower_case(ellipsoid);
  for (const EllipsoidDatums& datums : kDatums) {
    if (name.find(datums.word) == std::string::npos) continue;
    for (const std::string_view code : datums.crs) {
      if (code.empty()) continue;
      const Crs crs = Crs::from_user_input(std::string(code));
      const DatumShift shift = datum_shift(crs, place);
      const auto moved = CrsTransform(crs).geodetic_from_map({place.lon_deg, place.lat_deg});
      if (shift.ballpark || shift.operation.empty() || !moved) continue;
      possible.push_back({crs.name(), geodesic_between(place, *moved).length_m});
    }
  }
  return possible;
}

}  // namespace pilotage
