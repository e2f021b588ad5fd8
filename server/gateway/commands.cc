#include "server/gateway/commands.h"

#include <utility>

namespace visum::gateway {
namespace {

bool is_about_pace(const protocol::Request& request) {
  return std::holds_alternative<protocol::Pause>(request) ||
         std::holds_alternative<protocol::Resume>(request) ||
         std::holds_alternative<protocol::SetSpeed>(request) ||
         std::holds_alternative<protocol::Step>(request);
}

}  // namespace

void Commands::send(const Call& call, const protocol::Request& request, std::uint32_t part) {
  if (!parts_.send_before_command(call, !is_about_pace(request))) return;
  auto command = std::make_unique<Command>(Command{call.session.id(), call.id, part, request, {}, {}});
  call.client.waiting = mailbox_.send(std::move(command));
  if (!call.client.waiting) call.fail(protocol::ErrorCode::kBusy, "too many requests wait for the next tick");
}

void Commands::collect() {
  while (auto command = mailbox_.next_done()) done_.push_back(std::move(command));
}

std::vector<std::unique_ptr<Command>> Commands::take_collected() {
  return std::exchange(done_, {});
}

}  // namespace visum::gateway
