#pragma once

#include <string>

#include "command.h"

#include "pilotage/airsim/airsim_types.h"
#include "pilotage/mission/mission.h"
#include "pilotage/simulate/rendered_world.h"

namespace pilotage {

/// `pilotage simulate --serve`: what stands for AirSim.
struct ServeOptions {
  std::string serve;
  AirsimDialect serve_dialect = AirsimDialect::kAirsim;
  double serve_idle_s = 600;

  template <class Self, class Fields>
  static void describe(Self& self, Fields& fields) {
    fields.field("serve", self.serve,
                 "Instead of flying: answer the AirSim protocol on this HOST:PORT, until interrupted (Ctrl-C); port 0 "
                 "takes a free one.");
    fields.field("serve_dialect", self.serve_dialect,
                 "Whose protocol is served: AirSim's, that of Colosseum 2.3, or that of Cosys-AirSim.");
    fields.field("serve_idle_s", self.serve_idle_s,
                 "A connection that asks nothing for so long, and waits for no answer, is closed.", Range{1, 86400});
  }
};

/// Serves frames of the `world` by `camera` until the invocation's progress asks to stop.
/// Says where at once, and who may connect.
CommandResult serve_airsim(const Mission& mission, const RenderedWorld& world, const Camera& camera,
                           const ServeOptions& options, const Invocation& invocation);

}  // namespace pilotage
