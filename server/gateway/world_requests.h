// Requests about the bodies of the world: descriptions, meshes, pushes, bodies and models that come and go.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "server/gateway/commands.h"
#include "server/gateway/input_limiter.h"
#include "server/gateway/mailbox.h"

namespace visum::gateway {

// Keeps the description of the world that is valid now. Lives on the sessions' thread, owned by the Gateway.
class WorldRequests {
 public:
  WorldRequests(const StaticWorld& world, Mailbox& mailbox, Clients& clients, InputLimiter& limiter,
                Commands& commands, const Parts& parts)
      : world_(world),
        mailbox_(mailbox),
        clients_(clients),
        limiter_(limiter),
        commands_(commands),
        parts_(parts),
        view_(world.view) {}

  void handle(const Call& call, const protocol::DescribeWorld&) { call.reply(view_->description); }
  void handle(const Call& call, const protocol::ReadMesh& request);
  void handle(const Call& call, const protocol::ReadTexture& request);
  void handle(const Call& call, const protocol::PushBody& request);
  void handle(const Call& call, const protocol::AddBody& request);
  void handle(const Call& call, const protocol::RemoveBody& request) { commands_.send(call, request); }

  void handle(const Call& call, const protocol::SpawnModel& request);
  void handle(const Call& call, const protocol::RemoveModel& request);
  void handle(const Call& call, const protocol::ListModels&);

  const protocol::WorldDescription& description() const { return view_->description; }

  // Bodies or models came or went.
  void replace_view(WorldView view, const Published& now);
  // Takes over the world of another server where the copy shows one: a mirror shows that of an arm.
  void follow_shown_world(const Published& now);

 private:
  const std::vector<std::string>& models();

  const StaticWorld& world_;
  Mailbox& mailbox_;
  Clients& clients_;
  InputLimiter& limiter_;
  Commands& commands_;
  const Parts& parts_;
  std::optional<std::vector<std::string>> models_;  // of the installation, once somebody has asked
  std::shared_ptr<const WorldView> view_;           // of the world as it is now
  std::shared_ptr<const WorldView> shown_;          // another server's world, where the last copy showed one
};

}  // namespace visum::gateway
