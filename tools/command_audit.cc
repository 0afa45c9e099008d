#include <cmath>
#include <filesystem>
#include <optional>

#include "commands.h"
#include "exit_code.h"
#include "spread_output.h"

#include "pilotage/audit/audit_map.h"
#include "pilotage/audit/shift_picture.h"
#include "pilotage/base/json_object.h"
#include "pilotage/base/output_file.h"
#include "pilotage/base/text.h"
#include "pilotage/base/wording.h"
#include "pilotage/raster/gdal_write.h"
#include "pilotage/registration/disagreement_raster.h"

namespace pilotage {
namespace {

struct AuditCommandOptions {
  AuditOptions audit;
  std::string disagreement;

  template <class Self, class Fields>
  static void describe(Self& self, Fields& fields) {
    AuditOptions::describe(self.audit, fields);
    fields.path("disagreement", self.disagreement,
                "Also write the disagreement as a raster (GeoTIFF), where the other map shows the ground less where "
                "this one does, as score and prepare write it.");
  }
};

std::string verdict_text(const MapAudit& audit, const AuditOptions& options) {
  const std::string limit = format_number(options.max_shift_m) + " m";
  const std::string silent = "; of " + percent_text(1 - audit.compared) + " of the common ground nothing is said";
  switch (audit.verdict) {
    case AuditVerdict::kWithin:
      return "WITHIN " + limit + ": 95 % of what was compared lies within it" + silent;
    case AuditVerdict::kBeyond:
      return "BEYOND " + limit + ": more than 5 % of what was compared lies farther off" + silent;
    case AuditVerdict::kNotKnown:
      break;
  }
  return "NOT KNOWN: " + why_not_known(audit, options);
}

std::vector<std::string> assumptions_of(const MapAudit& audit, const AuditOptions& options) {
  return {"the other map is right where they differ; nothing here tells which of them is",
          shadows_assumption(options.registration, audit.registration.gsd_m)};
}

std::string result_text(const MapAudit& audit, const AuditOptions& options) {
  std::string text = verdict_text(audit, options) + "\n";
  text += "compared: " + format_fixed(audit.compared_m2 / 1e4, 1) + " of " + format_fixed(audit.common_m2 / 1e4, 1) +
          " ha that both show, " + std::to_string(audit.registration.finest_ties) + " ties of " +
          std::to_string(audit.registration.places) + " places at " + format_number(audit.registration.gsd_m) + " m\n";
  if (audit.compared_m2 == 0) return text;
  text += "shift, this map less the other: " + format_fixed(audit.median_shift_en_m.x(), 2) + " m east, " +
          format_fixed(audit.median_shift_en_m.y(), 2) + " m north (medians)\n";
  text += "  its length: " + spread_text(audit.shift_m) + "\n";
  text += "  about the medians: " + spread_text(audit.about_median_m) + "\n";
  text += "measured to: " + spread_text(audit.registration.fit.left_out_m) + " (ties left out of the fit)\n";
  if (!std::isnan(audit.map_sigma_m)) {
    const double along_m = audit.median_shift_en_m.norm() / std::sqrt(2.0);
    text += "the map's own error, each axis, as it says itself: " + format_fixed(audit.map_sigma_m, 2) +
            " m; the median shift is " + format_fixed(along_m / audit.map_sigma_m, 1) +
            " times that on each axis, with whatever the other map is off\n";
  }
  if (!std::isnan(audit.other_sigma_m)) {
    text +=
        "the other map's own error, each axis, as that says itself: " + format_fixed(audit.other_sigma_m, 2) + " m\n";
  }
  for (const std::string& one : assumptions_of(audit, options)) text += "assumes: " + one + "\n";
  return text;
}

nlohmann::ordered_json result_json(const MapAudit& audit, const AuditOptions& options) {
  return {{"verdict", options_detail::enum_to_name(audit.verdict)},
          {"max_shift_m", options.max_shift_m},
          {"crs", audit.crs.name()},
          {"common_m2", audit.common_m2},
          {"compared_m2", audit.compared_m2},
          {"places", audit.registration.places},
          {"ties", audit.registration.finest_ties},
          {"gsd_m", audit.registration.gsd_m},
          {"median_shift_m", {json_number(audit.median_shift_en_m.x()), json_number(audit.median_shift_en_m.y())}},
          {"shift_m", spread_json(audit.shift_m)},
          {"about_median_m", spread_json(audit.about_median_m)},
          {"left_out_m", spread_json(audit.registration.fit.left_out_m)},
          {"map_sigma_m", json_number(audit.map_sigma_m)},
          {"other_map_sigma_m", json_number(audit.other_sigma_m)},
          {"assumptions", assumptions_of(audit, options)}};
}

CommandResult run_audit(const AuditCommandOptions& options, const Invocation& invocation) {
  const std::string& map = invocation.inputs.front();
  const std::vector<std::string> other(invocation.inputs.begin() + 1, invocation.inputs.end());
  std::optional<OutputFile> picture;
  if (!invocation.output.empty()) picture.emplace(invocation.output, invocation.overwrite);
  std::optional<OutputFile> raster;
  if (!options.disagreement.empty()) raster.emplace(options.disagreement, invocation.overwrite);
  const MapAudit audit = audit_map(map, other, options.audit, invocation.threads, invocation.progress);
  std::vector<const OutputFile*> outputs;
  if (raster) {
    const DisagreementRaster layer = disagreement_raster(audit.registration.fit.field, audit.area_m);
    write_score_raster(*raster, layer.bands, audit.crs, layer.map_from_pixel, false);
    outputs.push_back(&*raster);
  }
  if (picture) {
    picture->write(shift_picture_svg(audit, map, options.audit));
    outputs.push_back(&*picture);
  }
  if (!outputs.empty()) OutputFile::commit(outputs, {});
  CommandResult result;
  result.text = result_text(audit, options.audit);
  result.json = result_json(audit, options.audit);
  result.warnings = audit.warnings;
  if (audit.verdict != AuditVerdict::kWithin) result.exit_code = kExitGateNotMet;
  return result;
}

}  // namespace

Command make_audit_command() {
  Command command;
  command.word = "audit";
  command.group = CommandGroup::kInspect;
  command.summary = "Hold a map against another one: how far is it off, and where";
  command.examples = {{"A map of one's own against the survey's orthophoto; 3 when it is off by more than 3 m.",
                       "pilotage audit reference.tif orthophoto.tif --max-shift-m 3 -o shifts.svg"}};
  command.inputs = {.name = "MAP OTHER...",
                    .help = "The map, and the other one (GDAL datasets; later ones on top).",
                    .min = 2,
                    .max = InputSpec::kMany};
  command.output = {.kind = OutputKind::kFile,
                    .help = "A picture of the shifts (SVG).",
                    .required = false,
                    .flags = {"disagreement"}};
  command.reads_rasters = true;
  bind_options<AuditCommandOptions>(command, run_audit);
  return command;
}

}  // namespace pilotage
