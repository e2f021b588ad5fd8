#include "server/gateway/commands.h"

#include <algorithm>
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

void Commands::send(const Call& call, const protocol::Request& request, std::uint32_t part,
                    std::vector<protocol::WriteBlackboard> pieces) {
  if (!parts_.send_before_command(call, !is_about_pace(request))) return;
  const auto session = call.session.id();
  auto command = std::make_unique<Command>(
      Command{session, call.id, part, parts_.generation(part), request, false, {}, std::move(pieces), {}});
  auto* const address = command.get();
  call.client.waiting = mailbox_.send(std::move(command));
  if (!call.client.waiting)
    return call.fail(protocol::ErrorCode::kBusy, "too many requests wait for the next tick");
  if (std::holds_alternative<protocol::Pause>(request))
    latched_.push_back({session, call.id, Clock::now(), address});
}

void Commands::stop(const Call& call, std::uint32_t part) {
  call.client.waiting = true;
  latched_.push_back({call.session.id(), call.id, Clock::now(), nullptr, stops_.press(part)});
}

void Commands::collect() {
  while (auto command = mailbox_.next_done()) {
    const auto pause = std::ranges::find(latched_, command.get(), &Latched::pause);
    if (pause != latched_.end()) {
      command->acknowledged = pause->acknowledged;
      latched_.erase(pause);
    }
    done_.push_back(std::move(command));
  }
  std::erase_if(latched_, [this](const Latched& stop) {
    if (stop.pause || !stops_.has_acted(stop.ticket)) return false;
    done_.push_back(std::make_unique<Command>(Command{stop.session, stop.id, 0, 0, {}, false, {}, {}, {}}));
    done_.back()->reply = protocol::Ok{};
    return true;
  });
}

bool Commands::acknowledge_late(Clients& clients, std::int64_t border, Clock::time_point now) {
  bool any = false;
  for (auto& latched : latched_) {
    if (latched.acknowledged || now - latched.since < kPatience) continue;
    latched.acknowledged = any = true;
    auto* client = clients.find(latched.session);
    if (!client) continue;
    client->waiting = false;
    if (latched.id != 0) client->session->send(latched.id, protocol::Ok{border + 1});
  }
  std::erase_if(latched_, [](const Latched& stop) { return !stop.pause && stop.acknowledged; });
  return any;
}

std::vector<std::unique_ptr<Command>> Commands::take_collected() {
  return std::exchange(done_, {});
}

}  // namespace visum::gateway
