#include "server/gateway/scene_requests.h"

#include <algorithm>

#include "protocol/config/unknown_name.h"
#include "server/gateway/scenario_files.h"
#include "server/gateway/scene_files.h"

namespace visum::gateway {

void SceneRequests::handle(const Call& call, const protocol::ListScenes&) {
  if (world_.models.empty()) return call.reply(protocol::SceneList{});
  call.reply(protocol::SceneList{scenes_in(world_.models), scenarios_in(world_.models)});
}

void SceneRequests::handle(const Call& call, const protocol::LoadScene& request) {
  const auto scenes = world_.models.empty() ? std::vector<std::string>() : scenes_in(world_.models);
  if (std::ranges::find(scenes, request.scene) == scenes.end())
    return call.fail(protocol::ErrorCode::kUnknownName, config::unknown_name("scene", request.scene, scenes));
  call.session.log(protocol::LogLevel::kWarning, "'" + call.session.client_name() + "' at " +
                                                     call.session.peer() + " loads the scene '" +
                                                     request.scene + "'");
  commands_.send(call, request);
}

}  // namespace visum::gateway
