#pragma once

#include <string>

#include "command.h"

#include "pilotage/airsim/airsim_types.h"
#include "pilotage/mission/mission.h"

namespace pilotage {

/// `pilotage simulate --serve`: what stands for AirSim.
struct ServeOptions {
  std::string serve;
  AirsimDialect serve_dialect = AirsimDialect::kAirsim;

  template <class Self, class Fields>
  static void describe(Self& self, Fields& fields) {
    fields.field("serve", self.serve,
                 "Instead of flying: answer the AirSim protocol on this HOST:PORT, until interrupted (Ctrl-C); port 0 "
                 "takes a free one.");
    fields.field("serve_dialect", self.serve_dialect,
                 "Whose protocol is served: AirSim's, that of Colosseum 2.3, or that of Cosys-AirSim.");
  }
};

/// Serves frames of the world `imagery` (make_rendered_world) by `camera` until the invocation's progress asks to stop.
CommandResult serve_airsim(const Mission& mission, const std::string& imagery, const Camera& camera,
                           const ServeOptions& options, const Progress& progress);

}  // namespace pilotage
