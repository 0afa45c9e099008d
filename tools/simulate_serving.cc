#include "simulate_serving.h"

#include "pilotage/airsim/airsim_simulation.h"
#include "pilotage/airsim/rpc_server.h"
#include "pilotage/simulate/airsim_scene.h"

namespace pilotage {

CommandResult serve_airsim(const Mission& mission, const RenderedWorld& world, const Camera& camera,
                           const ServeOptions& options, const Invocation& invocation) {
  const HostPort address = parse_host_port("--serve", options.serve, kAirsimPort);
  AirsimSimulation simulation(options.serve_dialect, airsim_scene(mission, world, camera));
  const Descriptor listener = listen_on(address);
  const std::string where = HostPort{address.host, port_of(listener)}.text();
  const bool alone = is_loopback(listener);
  const std::string reach = alone ? "this machine alone" : "whoever reaches it, unencrypted";
  const std::string serving = "serving AirSim on " + where + " to " + reach;
  invocation.say(serving);
  if (!alone) invocation.say("warning: whoever reaches this address may fly, look and pause; nothing asks who it is");
  RpcServerLimits limits;
  limits.idle_s = options.serve_idle_s;
  const auto stop = [&](const RpcServed& so_far) { return !invocation.progress(serving, so_far.calls, 0); };
  const RpcServed served = serve_rpc(listener, simulation.service(), stop, limits);
  CommandResult result;
  result.text = "served AirSim on " + where + " to " + reach + ": " + std::to_string(served.calls) + " calls of " +
                std::to_string(served.connections) + " connections, " + std::to_string(served.dropped) +
                " dropped because they sent no calls, " + std::to_string(served.idle) + " because they were quiet\n";
  result.json = {{"served", where},
                 {"calls", served.calls},
                 {"connections", served.connections},
                 {"dropped", served.dropped},
                 {"idle", served.idle}};
  for (const auto& [text, count] : served.refused) {
    result.warnings.push_back(std::to_string(count) + (count == 1 ? " call was" : " calls were") + " refused: " + text);
  }
  return result;
}

}  // namespace pilotage
