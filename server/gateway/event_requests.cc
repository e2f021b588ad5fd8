#include "server/gateway/event_requests.h"

#include <utility>

#include "protocol/config/printable.h"
#include "protocol/recording/reset_scope_words.h"

namespace visum::gateway {
namespace {

using protocol::ErrorCode;
using protocol::EventLevel;

// Kind and text of the event for a command that was done; an empty kind: it is not told.
struct Told {
  const protocol::Reply& reply;

  std::pair<std::string, std::string> operator()(const protocol::Pause&) const {
    return {"pause", "time stands still"};
  }
  std::pair<std::string, std::string> operator()(const protocol::Resume&) const {
    return {"resume", "time runs"};
  }
  std::pair<std::string, std::string> operator()(const protocol::Reset& reset) const {
    return {"reset", std::string("back to the beginning: ") + recording::in_words(reset.scope)};
  }
  std::pair<std::string, std::string> operator()(const protocol::TakeSnapshot& taken) const {
    const auto* done = std::get_if<protocol::SnapshotTaken>(&reply);
    const std::string number = done ? std::to_string(done->snapshot) : "";
    return {"snapshot", "snapshot " + number + (taken.name.empty() ? "" : ", kept as '" + taken.name + "'")};
  }
  std::pair<std::string, std::string> operator()(const protocol::RestoreSnapshot& restored) const {
    return {"restore", "back to snapshot " + (restored.name.empty() ? std::to_string(restored.snapshot)
                                                                    : "'" + restored.name + "'")};
  }
  std::pair<std::string, std::string> operator()(const protocol::SpawnModel&) const {
    const auto* done = std::get_if<protocol::ModelSpawned>(&reply);
    return {"spawn", "the model '" + (done ? done->name : "") + "' came"};
  }
  std::pair<std::string, std::string> operator()(const protocol::RemoveModel& removed) const {
    return {"remove", "the model '" + removed.name + "' went"};
  }
  std::pair<std::string, std::string> operator()(const protocol::LoadScene& loaded) const {
    return {"load", "the scene '" + loaded.scene + "' was loaded"};
  }
  std::pair<std::string, std::string> operator()(const protocol::StartRecording& recording) const {
    return {"recording", "recording '" + recording.name + "' has begun"};
  }
  std::pair<std::string, std::string> operator()(const protocol::StopRecording&) const {
    return {"recording", "the recording has ended"};
  }
  template <typename Other>
  std::pair<std::string, std::string> operator()(const Other&) const {
    return {};
  }
};

}  // namespace

void EventRequests::handle(const Call& call, const protocol::SubscribeEvents& request) {
  const auto least = request.level == EventLevel::kUnspecified ? EventLevel::kInfo : request.level;
  call.client.events = least;
  call.reply(clients_.feed().kept(least));
}

void EventRequests::handle(const Call& call, const protocol::UnsubscribeEvents&) {
  if (!call.client.events) return call.fail(ErrorCode::kWrongState, "this session has no events subscribed");
  call.client.events.reset();
  call.reply(protocol::Ok{});
}

void EventRequests::handle(const Call& call, const protocol::Announce& request) {
  if (request.text.empty() || request.text.size() > EventFeed::kMostBytes)
    return call.fail(ErrorCode::kBadValue,
                     "text must have 1 to " + std::to_string(EventFeed::kMostBytes) + " bytes");
  const std::string kind = request.kind.empty() ? "line" : request.kind;
  if (kind != "line" && kind != "check")
    return call.fail(ErrorCode::kBadValue, "kind must be line or check, is '" + kind + "'");
  const auto level = request.level == EventLevel::kUnspecified ? EventLevel::kInfo : request.level;
  clients_.tell(
      {kind, request.text, {}, clients_.known_era(), call.now.tick, level, call.session.client_name()});
  call.reply(protocol::Ok{});
}

void EventRequests::tell_done(const protocol::Request& request, const protocol::Reply& reply,
                              const std::string& client, const Published& now) {
  auto [kind, text] = std::visit(Told{reply}, request);
  if (!kind.empty())
    clients_.tell(
        {std::move(kind), std::move(text), {}, clients_.known_era(), now.tick, EventLevel::kInfo, client});
}

void EventRequests::serve(const Published& now) {
  clients_.tell_of_lost_events(now.tick);
  if (!log_) return;
  const auto dropped = log_->take(lines_);
  for (auto& line : lines_)
    clients_.tell({"log", config::printable(line.text), {}, clients_.known_era(), now.tick, line.level});
  if (dropped != 0)
    clients_.tell({"events_lost",
                   std::to_string(dropped) + " lines of the log were left out",
                   {},
                   clients_.known_era(),
                   now.tick});
}

}  // namespace visum::gateway
