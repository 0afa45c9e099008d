#include "pilotage/raster/gdal_vector.h"

#include <algorithm>
#include <functional>
#include <memory>

#include <cpl_string.h>
#include <gdal_priv.h>
#include <ogr_spatialref.h>
#include <ogrsf_frmts.h>

#include "pilotage/base/error.h"
#include "pilotage/base/output_file.h"
#include "pilotage/raster/gdal_handle.h"
#include "pilotage/raster/gdal_local_config.h"
#include "pilotage/raster/gdal_shapes.h"

namespace pilotage {
namespace {

using FeaturePtr = std::unique_ptr<OGRFeature, decltype(&OGRFeature::DestroyFeature)>;

constexpr const char* kStyleTable = "layer_styles";

OGRFieldType field_type(VectorType type) {
  if (type == VectorType::kReal) return OFTReal;
  if (type == VectorType::kText) return OFTString;
  return type == VectorType::kInteger ? OFTInteger64 : OFTInteger;
}

bool has_parts(const OGRGeometry& shape) {
  return OGR_GT_IsSubClassOf(shape.getGeometryType(), wkbGeometryCollection) != 0;
}

OGRwkbGeometryType layer_type(const VectorLayer& layer, const std::vector<GeometryPtr>& shapes) {
  if (layer.shape == VectorShape::kNone) return wkbNone;
  bool parts = false;
  for (const GeometryPtr& shape : shapes) parts = parts || has_parts(*shape);
  if (layer.shape == VectorShape::kPoint) return wkbPoint;
  if (layer.shape == VectorShape::kLine) return parts ? wkbMultiLineString : wkbLineString;
  return parts ? wkbMultiPolygon : wkbPolygon;
}

void set_value(OGRFeature& feature, int field, const VectorValue& value) {
  struct Visitor {
    OGRFeature& feature;
    int field;
    void operator()(std::monostate) const { feature.SetFieldNull(field); }
    void operator()(bool flag) const { feature.SetField(field, flag ? 1 : 0); }
    void operator()(std::int64_t number) const { feature.SetField(field, static_cast<GIntBig>(number)); }
    void operator()(double number) const { feature.SetField(field, number); }
    void operator()(const std::string& text) const { feature.SetField(field, text.c_str()); }
  };
  std::visit(Visitor{feature, field}, value);
}

/// A field of a layer that is not one of its columns, and what stands in it.
struct ExtraField {
  const char* name;
  OGRFieldType type;
  std::function<VectorValue(const VectorFeature&)> value;
};

void write_layer(GDALDataset& dataset, const VectorLayer& layer, bool in_wgs84, const CPLStringList& options,
                 const std::vector<ExtraField>& extras = {}) {
  std::vector<GeometryPtr> shapes = shapes_of(layer, in_wgs84);
  OGRwkbGeometryType type = layer_type(layer, shapes);
  OGRSpatialReference reference = layer_reference(in_wgs84 || layer.crs.empty() ? Crs::wgs84() : layer.crs);
  OGRLayer* target = dataset.CreateLayer(layer.name.c_str(), type == wkbNone ? nullptr : &reference, type,
                                         const_cast<char**>(options.List()));
  if (target == nullptr) return;  // GdalErrors has the reason
  const auto add_field = [&](const char* name, OGRFieldType field_type, bool flag, const std::string& title) {
    OGRFieldDefn field(name, field_type);
    if (flag) field.SetSubType(OFSTBoolean);
    if (!title.empty() && title != name) field.SetAlternativeName(title.c_str());
    target->CreateField(&field);
  };
  for (const ExtraField& extra : extras) add_field(extra.name, extra.type, false, "");
  for (const VectorColumn& column : layer.columns) {
    add_field(column.name.c_str(), field_type(column.type), column.type == VectorType::kBoolean, column.title);
  }
  for (std::size_t i = 0; i < layer.features.size(); ++i) {
    const VectorFeature& source = layer.features[i];
    check_values(layer, source);
    const FeaturePtr feature(OGRFeature::CreateFeature(target->GetLayerDefn()), OGRFeature::DestroyFeature);
    int field = 0;
    for (const ExtraField& extra : extras) set_value(*feature, field++, extra.value(source));
    for (const VectorValue& value : source.values) set_value(*feature, field++, value);
    if (type != wkbNone) {
      GeometryPtr shape = std::move(shapes[i]);
      if (type == wkbMultiLineString || type == wkbMultiPolygon) {
        shape.reset(OGRGeometryFactory::forceTo(shape.release(), type));
      }
      feature->SetGeometryDirectly(shape.release());
    }
    if (target->CreateFeature(feature.get()) != OGRERR_NONE) return;
  }
}

/// Creates a dataset, lets `fill` write into it and closes it; whatever GDAL reports as a failure is a DataError.
void write_dataset(const char* driver_name, const std::string& path, const std::string& name,
                   const CPLStringList& options, const std::function<void(GDALDataset&)>& fill) {
  const GdalErrors errors;
  GDALDriver* driver = GetGDALDriverManager()->GetDriverByName(driver_name);
  if (driver == nullptr) throw DataError(name + ": this GDAL has no driver " + driver_name);
  DatasetPtr dataset(driver->Create(path.c_str(), 0, 0, 0, GDT_Unknown, const_cast<char**>(options.List())));
  if (dataset != nullptr) fill(*dataset);
  const bool created = dataset != nullptr;
  // Not by the pointer's own closer, which would keep what closing has to report.
  if (created) GDALClose(GDALDataset::ToHandle(dataset.release()));
  if (!created || errors.failed()) errors.throw_data_error(name + ": cannot be written");
}

CPLStringList list_of(const std::vector<std::string>& options) {
  CPLStringList list;
  for (const std::string& option : options) list.AddString(option.c_str());
  return list;
}

/// The table from which QGIS takes default styles, as QGIS itself makes it.
VectorLayer style_table(const std::vector<VectorLayer>& layers, const std::string& timestamp) {
  VectorLayer table;
  table.name = kStyleTable;
  table.description = "Styles in which QGIS shows the layers.";
  for (const char* name : {"f_table_catalog", "f_table_schema", "f_table_name", "f_geometry_column", "styleName",
                           "styleQML", "styleSLD"}) {
    table.columns.push_back({name, VectorType::kText, ""});
  }
  table.columns.push_back({"useAsDefault", VectorType::kBoolean, ""});
  for (const char* name : {"description", "owner", "ui"}) table.columns.push_back({name, VectorType::kText, ""});
  for (const VectorLayer& layer : layers) {
    if (layer.qml.empty()) continue;
    VectorFeature row;
    row.values = {std::string(), std::string(), layer.name,  std::string("geom"), layer.name,   layer.qml,
                  std::string(), true,          layer.title, std::string(),       std::string()};
    row.note = timestamp;
    table.features.push_back(std::move(row));
  }
  return table;
}

}  // namespace

VectorFeature join_polygons(const std::vector<std::vector<Eigen::Vector2d>>& polygons) {
  const GdalErrors errors;
  OGRMultiPolygon all;
  for (const auto& polygon : polygons) all.addGeometryDirectly(polygon_shape(polygon, {}, "areas").release());
  const GeometryPtr joined(all.UnionCascaded());
  if (joined == nullptr || wkbFlatten(joined->getGeometryType()) != wkbPolygon) {
    throw UsageError("areas: polygons that are to be joined do not make one piece");
  }
  const auto corners = [](const OGRLinearRing& ring) {
    std::vector<Eigen::Vector2d> points;
    for (int i = 0; i + 1 < ring.getNumPoints(); ++i) points.emplace_back(ring.getX(i), ring.getY(i));
    return points;
  };
  const OGRPolygon& outline = *joined->toPolygon();
  VectorFeature feature;
  feature.points = corners(*outline.getExteriorRing());
  for (int i = 0; i < outline.getNumInteriorRings(); ++i) {
    feature.holes.push_back(corners(*outline.getInteriorRing(i)));
  }
  return feature;
}

DegreeShape degree_shape(const VectorLayer& layer, const VectorFeature& feature) {
  VectorLayer alone = layer;
  alone.features = {feature};
  const std::vector<GeometryPtr> shapes = shapes_of(alone, true);
  if (shapes.empty()) throw UsageError("layer " + layer.name + " has no shapes");
  const GdalErrors errors;
  const CPLStringList options = list_of({"COORDINATE_PRECISION=7"});
  DegreeShape result;
  char* const text =
      OGR_G_ExportToJsonEx(OGRGeometry::ToHandle(shapes.front().get()), const_cast<char**>(options.List()));
  result.geojson = text != nullptr ? text : "";
  CPLFree(text);
  if (result.geojson.empty()) errors.throw_data_error("layer " + layer.name + ": a shape cannot be written");
  OGREnvelope box;
  shapes.front()->getEnvelope(&box);
  result = {result.geojson, box.MinX, box.MinY, box.MaxX, box.MaxY};
  constexpr double kHalfTurn_deg = 180;
  if (!has_parts(*shapes.front()) || box.MinX > -kHalfTurn_deg || box.MaxX < kHalfTurn_deg) return result;
  // Cut at the antimeridian: the parts west of it begin the box, those east of it end it.
  result.west_deg = kHalfTurn_deg;
  result.east_deg = -kHalfTurn_deg;
  for (const OGRGeometry* part : *shapes.front()->toGeometryCollection()) {
    part->getEnvelope(&box);
    if (box.MinX > 0) result.west_deg = std::min(result.west_deg, box.MinX);
    if (box.MaxX < 0) result.east_deg = std::max(result.east_deg, box.MaxX);
  }
  return result;
}

void write_geojson(const std::filesystem::path& path, const VectorLayer& layer, bool overwrite) {
  OutputFile output(path, overwrite);
  write_dataset("GeoJSON", output.temporary_path().string(), path.string(), {}, [&](GDALDataset& dataset) {
    write_layer(dataset, layer, true, list_of({"RFC7946=YES", "COORDINATE_PRECISION=7"}));
  });
  output.commit();
}

void write_geopackage(const std::filesystem::path& path, const std::vector<VectorLayer>& layers,
                      const std::string& timestamp, bool overwrite) {
  const LocalConfig date("OGR_CURRENT_DATE", timestamp.c_str());
  const LocalConfig no_sync("OGR_SQLITE_SYNCHRONOUS", "OFF");  // the whole file is synced before it is renamed
  OutputFile output(path, overwrite);
  const CPLStringList creation = list_of({"VERSION=1.3", "ADD_GPKG_OGR_CONTENTS=NO"});
  write_dataset("GPKG", output.temporary_path().string(), path.string(), creation, [&](GDALDataset& dataset) {
    for (const VectorLayer& layer : layers) {
      write_layer(dataset, layer, false,
                  list_of({"GEOMETRY_NAME=geom", "FID=fid", "SPATIAL_INDEX=YES", "ASPATIAL_VARIANT=GPKG_ATTRIBUTES",
                           "IDENTIFIER=" + (layer.title.empty() ? layer.name : layer.title),
                           "DESCRIPTION=" + layer.description}));
    }
    const VectorLayer styles = style_table(layers, timestamp);
    if (styles.features.empty()) return;
    const ExtraField update_time{"update_time", OFTDateTime,
                                 [](const VectorFeature& row) { return VectorValue(row.note); }};
    write_layer(dataset, styles, false,
                list_of({"FID=id", "ASPATIAL_VARIANT=GPKG_ATTRIBUTES", "IDENTIFIER=" + std::string(kStyleTable),
                         "DESCRIPTION=" + styles.description}),
                {update_time});
  });
  output.commit();
}

}  // namespace pilotage
