#include "server/recording/event_list.h"

#include <charconv>
#include <type_traits>
#include <utility>
#include <variant>

#include "protocol/config/printable.h"
#include "protocol/recording/loaded_scene.h"
#include "protocol/recording/reset_scope_words.h"
#include "protocol/recording/spawned_model.h"

namespace visum::recording {
namespace {

using protocol::EventLevel;

constexpr std::string_view kEmergencyStop = "Emergency Stop";

EventLevel level_of(std::string_view name) {
  if (name == "trace" || name == "debug") return EventLevel::kDebug;
  if (name == "warning") return EventLevel::kWarning;
  return name == "error" || name == "critical" ? EventLevel::kError : EventLevel::kInfo;
}

std::string text_of(double number) {
  char text[32];
  return {text, std::to_chars(text, text + sizeof text, number).ptr};
}

std::string text_of(const protocol::ParameterValue& value) {
  return std::visit(
      [](const auto& held) -> std::string {
        using Held = std::decay_t<decltype(held)>;
        if constexpr (std::is_same_v<Held, std::string>)
          return held;
        else if constexpr (std::is_same_v<Held, bool>)
          return held ? "on" : "off";
        else if constexpr (std::is_same_v<Held, double>)
          return text_of(held);
        else
          return std::to_string(held);
      },
      value);
}

struct Words {
  std::string kind, text;
  std::string_view part = {};
  EventLevel level = EventLevel::kInfo;
};

// An empty kind: it is left out.
struct Teller {
  Words operator()(const LoseController& lost) const {
    return {"lease_lost", "the controller was lost", lost.part, EventLevel::kWarning};
  }
  Words operator()(const SetParameter& set) const {
    const bool stop = set.name == kEmergencyStop;
    return {stop ? "emergency_stop" : "parameter", std::string(set.name) + " = " + text_of(set.value),
            set.part, stop ? EventLevel::kWarning : EventLevel::kInfo};
  }
  Words operator()(const Reset& reset) const {
    return {"reset", std::string("back to the beginning: ") + in_words(reset.scope)};
  }
  Words operator()(const TakeSnapshot& taken) const {
    return {"snapshot", "snapshot " + std::to_string(taken.number)};
  }
  Words operator()(const RestoreSnapshot& restored) const {
    return {"restore", "back to snapshot " + std::to_string(restored.number)};
  }
  Words operator()(const RestoreState&) const { return {"restore", "back to a snapshot on disk"}; }
  Words operator()(const AddBody&) const { return {"world_changed", "a body came"}; }
  Words operator()(const RemoveBody& gone) const {
    return {"world_changed", "'" + std::string(gone.name) + "' went"};
  }
  Words operator()(const SpawnModel& came) const {
    return {"spawn", "the model '" + came.model->name + "' came"};
  }
  Words operator()(const RemoveModel& gone) const {
    return {"remove", "the model '" + std::string(gone.name) + "' went"};
  }
  Words operator()(const LoadScene& loaded) const {
    return {"load", "the scene '" + loaded.scene->name + "' was loaded"};
  }
  Words operator()(const InjectFault& fault) const {
    std::string text(fault.kind);
    for (const double number : fault.numbers) text += " " + text_of(number);
    return {"fault", text, fault.part, EventLevel::kWarning};
  }
  Words operator()(const ClearFault& cleared) const {
    return {"fault_cleared", cleared.kind.empty() ? "all" : std::string(cleared.kind), cleared.part};
  }
  template <typename Other>
  Words operator()(const Other&) const {
    return {};
  }
};

}  // namespace

void EventList::take(const RecordingFile::Item& item, std::uint64_t position) {
  position_ = position;
  if (const auto* input = std::get_if<const TimedInput*>(&item)) take(**input);
  if (const auto* tick = std::get_if<const Tick*>(&item)) take(**tick);
  if (const auto* line = std::get_if<const LogLine*>(&item))
    add("log", (*line)->text, {}, level_of((*line)->level));
}

void EventList::take(const TimedInput& input) {
  const auto [kind, text, part, level] = std::visit(Teller{}, input.input);
  if (!kind.empty()) add(kind, text, part, level);
}

void EventList::take(const Tick& tick) {
  tick_ = tick.tick;
  sim_time_ns_ = tick.sim_time_ns;
  era_ = tick.era;
  if (!tick.fault.empty()) add("frozen", tick.fault, {}, EventLevel::kError);
}

void EventList::add(std::string kind, std::string_view text, std::string_view part, EventLevel level) {
  if (events_.size() >= kMostEvents) {
    ++left_out_;
    return;
  }
  events_.push_back({position_,
                     {std::move(kind),
                      config::printable(text.substr(0, kMostBytes)),
                      std::string(part),
                      era_,
                      tick_,
                      level,
                      {},
                      sim_time_ns_}});
}

}  // namespace visum::recording
