#include <cstdio>

#include "clients/visum/common/interrupt.h"
#include "clients/visum/common/json_writer.h"
#include "clients/visum/verbs/verbs.h"
#include "protocol/command_line/one_of.h"
#include "protocol/config/printable.h"

namespace visum::cli {
namespace {

using protocol::Event;
using protocol::EventLevel;

constexpr EventLevel kLevels[] = {EventLevel::kDebug, EventLevel::kInfo, EventLevel::kWarning,
                                  EventLevel::kError};

class EventsVerb : public Verb {
 public:
  void declare(CLI::App& app) override {
    app.add_flag("--follow", follow_, "go on with what happens, until Ctrl-C or the server's end");
    app.add_option("--level", level_, "the least level")
        ->capture_default_str()
        ->check(command_line::one_of({"debug", "info", "warning", "error"}));
    add_link_options(app, link_);
    app.footer(
        "Lists what has happened in a server: its log, leases, faults, resets, freezes, what clients "
        "announce. "
        "The server keeps the newest 1000. With --json each event is a line.\n\nExamples:\n"
        "  visum events\n  visum events --follow --json");
  }

  int run() override {
    catch_interrupts();
    auto link = open_link(link_, protocol::Role::kObserver);
    protocol::SubscribeEvents subscribe;
    for (const auto level : kLevels)
      if (level_ == protocol::to_string(level)) subscribe.level = level;
    for (const auto& event : link.request_as<protocol::EventList>(subscribe).events) show(event);
    while (follow_ && !interrupted()) {
      const auto message = link.next(std::chrono::milliseconds(100));
      const auto* event = message ? std::get_if<Event>(&*message) : nullptr;
      if (!event) continue;
      show(*event);
      if (event->kind == "shutdown") break;
    }
    return 0;
  }

 private:
  void show(const Event& event) const {
    if (link_.json) {
      JsonWriter json;
      json.begin_object().member("tick", event.tick).member("sim_time_ns", event.sim_time_ns);
      json.member("era", event.era).member("level", protocol::to_string(event.level));
      json.member("kind", event.kind).member("source", event.source).member("text", event.text);
      std::puts(json.end_object().text().c_str());
    } else {
      std::printf("%10.3f s  %-7s  %-14s  %s: %s\n", static_cast<double>(event.sim_time_ns) * 1e-9,
                  protocol::to_string(event.level), config::printable(event.kind).c_str(),
                  config::printable(event.source).c_str(), config::printable(event.text).c_str());
    }
    std::fflush(stdout);
  }

  LinkOptions link_;
  bool follow_ = false;
  std::string level_ = "info";
};

}  // namespace

std::unique_ptr<Verb> make_events() {
  return std::make_unique<EventsVerb>();
}

}  // namespace visum::cli
