#pragma once

#include "pilotage/audit/audit_map.h"
#include "pilotage/audit/shift_picture.h"
#include "pilotage/base/error.h"
#include "pilotage/base/progress.h"
#include "pilotage/build_map/build_map.h"
#include "pilotage/capture/capture.h"
#include "pilotage/fetch/fetch_imagery.h"
#include "pilotage/gis/report_outputs.h"
#include "pilotage/ground/ground_of_rasters.h"
#include "pilotage/ground/measures.h"
#include "pilotage/ground/score_table.h"
#include "pilotage/mapdb/map_delta_writer.h"
#include "pilotage/mapdb/map_signing.h"
#include "pilotage/mapdb/map_verify.h"
#include "pilotage/mission/input_files.h"
#include "pilotage/mission/plan_file.h"
#include "pilotage/mission/selection_file.h"
#include "pilotage/mission/simulation_file.h"
#include "pilotage/pack/field_pack.h"
#include "pilotage/prepare/prepare.h"
#include "pilotage/raster/gdal_access.h"
#include "pilotage/report/plan_report.h"
#include "pilotage/report/report.h"
#include "pilotage/score/score_ground.h"
#include "pilotage/select/route_ageing.h"
#include "pilotage/select/select_tiles.h"
#include "pilotage/survey/run_survey.h"
#include "pilotage/tile/plan_tiles.h"
#include "pilotage/version.h"

/// @file
/// What a program on the ground includes: from imagery and a route to a verified map. docs/examples/prep is such a
/// program. Link `pilotage::prep`, which brings `pilotage::onboard`.
///
/// @code
/// cv::setNumThreads(1);                                    // once, see Threads
/// pilotage::PrepareOptions options;                        // what mission.json holds, with the defaults of --help
/// options.tile.imagery = {"ortho.tif"};
/// options.tile.route = "route.plan";
/// options.tile.camera.file = "camera.yaml";
/// options.tile.route_options.agl_m = 120;
/// pilotage::PrepareRun run;
/// run.output_folder = "out";
/// const pilotage::PrepareResult result = pilotage::prepare(options, run);
/// pilotage::require_intact(pilotage::verify_map("out/map.gpkg"));
/// @endcode
///
/// Order
///  prepare() is all of it. A program that wants something in between calls the stages; what passes between them are
///  values, and each value has a file:
///  1. plan_tiles(): TileOptions → Mission, a Ground and a Flight over it. read_plan(), plan_to_json(). Without a route
///     ground_of_rasters() and cut_all_tiles() make a Ground.
///  2. score_ground(): Ground → GroundScores, the TileScores of every tile with the probability of a correct fix.
///     tile_table_to_csv(); tile_table_from_csv() and scores_of(). measures() lists what they hold.
///  3. select_tiles(): Mission, its scores, stored_size() → Selection. age_route(): what becomes of it when the map is
///     flown by later. read_selection(), selection_to_json().
///  4. build_map(): all of these and input_files() of the plan → map.gpkg.
///  5. make_report_input(), add_pictures(), make_report(), write_report_outputs(): all of these → the files of
///     the report. Without a route run_survey() says of an area where a camera could find its place.
///     capture() makes imagery of frames, before all of this; audit_map() holds it against other imagery.
///  6. verify_map(), require_intact(): every digest of the map, before it flies; sign_file() for those
///     to whom it is handed on, who open it with the key (pilotage/onboard.h).
///
/// Errors
///  - UsageError: an option is missing, outside its range, or excludes another.
///  - DataError: a file cannot be read or written, is damaged, or does not belong to the others.
///  - IntegrityError, a DataError: a digest or a signature is wrong.
///  - Interrupted, no std::exception: the Progress callback returned false.
///  Each message is one line that names the thing, the value and what is allowed. Outputs appear when they are whole,
///  or not at all. What a planner should look at and what is no error stands in `warnings`.
///
/// Threads
///  - Functions with a parameter `threads` share their work out: 0 means all cores. Results are the same bytes for any
///    number. Call one stage at a time: each fills the machine.
///  - A Progress callback is called by one thread at a time, not always the caller's.
///  - OpenCV's own threads would come on top of these; results do not depend on them. A program turns them off with
///    cv::setNumThreads(1), which holds for the process, so the library does not call it. The command line does.
///  - GDAL's settings and caches are those of the process, as GDAL's user set them. Its drivers and file systems become
///    those that set_raster_access() allows, for the whole process: without a call neither the network nor formats that
///    planners do not deliver (docs/decisions/imagery-drivers.md).
///
/// Options structs describe themselves: name, help and range of each field (pilotage/base/options.h), from which the
/// command line, configuration files and their schemas are made. Units stand in names; points are WGS 84, longitude
/// first.
