#include <cstdio>

#include "clients/visum/common/format.h"
#include "clients/visum/common/json_writer.h"
#include "clients/visum/common/terminal.h"
#include "clients/visum/verbs/verbs.h"

namespace visum::cli {
namespace {

using protocol::ServerStatus;
using protocol::Welcome;

double as_ms(std::int64_t ns) {
  return static_cast<double>(ns) * 1e-6;
}

void write_members(JsonWriter& json, const ServerStatus& status) {
  json.key("lockstep").begin_array();
  for (const auto& member : status.lockstep) {
    json.begin_object().member("client", member.client).member("granted_tick", member.granted_tick);
    json.member("waiting_ns", member.waiting_ns).member("grade", member.grade);
    json.member("note", member.note).end_object();
  }
  json.end_array().key("phases").begin_array();
  for (const auto& phase : status.phases) {
    json.begin_object().member("name", phase.name).member("mean_ns", phase.mean_ns);
    json.member("max_ns", phase.max_ns).end_object();
  }
  json.end_array().key("buses").begin_array();
  for (const auto& bus : status.buses)
    json.begin_object().member("part", bus.part).member("name", bus.name).end_object();
  json.end_array().key("free_running").begin_array();
  for (const auto& client : status.free_running) json.value(client);
  json.end_array();
}

std::string json_of(const Welcome& welcome, const ServerStatus& status) {
  JsonWriter json;
  json.begin_object().member("server", welcome.server).member("scene", welcome.scene);
  json.member("simulated", welcome.simulated)
      .member("clock", status.clock)
      .member("tick_ns", welcome.tick_ns);
  json.member("tick", status.tick).member("sim_time_ns", status.sim_time_ns).member("era", status.era);
  json.member("paused", status.paused).member("frozen", status.frozen);
  json.member("frozen_reason", status.frozen_reason).member("speed", status.speed);
  json.member("real_time_factor", status.real_time_factor).member("overruns", status.overruns);
  json.member("solver_warnings", status.solver_warnings).member("limited_ticks", status.limited_ticks);
  json.key("limited_bodies").begin_array();
  for (const auto& body : status.limited_bodies) json.value(body);
  json.end_array();
  json.member("bus_drops", status.bus_drops);
  json.member("lateness_p50_ns", status.lateness_p50_ns).member("lateness_p999_ns", status.lateness_p999_ns);
  json.member("lateness_max_ns", status.lateness_max_ns).member("state_hash", hex(status.state_hash));
  json.member("sessions", status.sessions).member("refused", status.refused);
  json.member("own_allocations", status.own_allocations);
  json.member("stuck_node", status.stuck_node).member("stuck_ns", status.stuck_ns);
  json.member("working", status.working).member("working_ns", status.working_ns);
  json.member("silent_stops", status.silent_stops).member("late_writes", status.late_writes);
  write_members(json, status);
  return json.end_object().text() + "\n";
}

std::string listed(const std::vector<std::string>& names) {
  std::string text;
  for (const auto& name : names) text += (text.empty() ? "" : ", ") + printable(name);
  return text.empty() ? "none" : text;
}

std::string state_of(const ServerStatus& status) {
  if (!status.stuck_node.empty())
    return "STUCK: " + status.stuck_node + " has not come back for " + seconds(status.stuck_ns);
  if (status.frozen) return "FROZEN: " + status.frozen_reason;
  return status.paused ? "paused" : "running";
}

std::string grade_text(std::uint32_t grade) {
  if (grade == 1) return "L1 (gate)";
  if (grade == 2) return "L2 (time shim)";
  return grade == 4 ? "L4 (steps of its own)" : "L" + std::to_string(grade);
}

std::string waiting_text(const ServerStatus& status) {
  std::string text;
  for (const auto& member : status.lockstep) {
    text += "  " + printable(member.client) + ": " + grade_text(member.grade) +
            ", lets the world run up to tick " + std::to_string(member.granted_tick);
    if (member.waiting_ns > 0) text += ", WAITED FOR since " + fixed(as_ms(member.waiting_ns), 1) + " ms";
    if (!member.note.empty()) text += "; it " + printable(member.note);
    text += "\n";
  }
  if (!text.empty()) text = "clients that step with the world\n" + text;
  for (const auto& client : status.free_running)
    text += (&client == &status.free_running.front() ? "clients that do not step with the world\n  " : "  ") +
            printable(client) + ": L0 (free-running)\n";
  return text;
}

std::string text_of(const Welcome& welcome, const ServerStatus& status) {
  Table table;
  table.row({"server", welcome.server + (welcome.simulated ? "  VIRTUAL" : "  REAL")});
  table.row({"scene", welcome.scene});
  table.row({"state", state_of(status)});
  table.row({"clock", status.clock + (status.clock == "realtime" ? " x " + rounded(status.speed, 4) : "") +
                          ", reached " + rounded(status.real_time_factor, 4)});
  table.row({"time", seconds(status.sim_time_ns) + ", tick " + std::to_string(status.tick) + " of " +
                         rounded(as_ms(welcome.tick_ns), 6) + " ms, era " + std::to_string(status.era)});
  table.row({"overruns", std::to_string(status.overruns) + ", lateness p50 " +
                             fixed(as_ms(status.lateness_p50_ns), 3) + " ms, p99.9 " +
                             fixed(as_ms(status.lateness_p999_ns), 3) + " ms, max " +
                             fixed(as_ms(status.lateness_max_ns), 3) + " ms"});
  if (status.bus_drops > 0)
    table.row(
        {"buses", std::to_string(status.bus_drops) + " frames were dropped that no client read in time"});
  if (status.solver_warnings > 0)
    table.row({"solver", "fell short in " + std::to_string(status.solver_warnings) + " ticks since start"});
  if (!status.working.empty())
    table.row({"tick in progress", status.working + ", for " + seconds(status.working_ns)});
  if (status.silent_stops > 0)
    table.row({"stopped", std::to_string(status.silent_stops) + " times, as no controller could be heard"});
  if (status.late_writes > 0)
    table.row({"writes", std::to_string(status.late_writes) + " dropped, as they were too old"});
  if (status.limited_ticks > 0)
    table.row({"limited", std::to_string(status.limited_ticks) +
                              " ticks met the limit of their work; fell short in the last: " +
                              listed(status.limited_bodies)});
  table.row({"state hash", hex(status.state_hash)});
  table.row({"sessions",
             std::to_string(status.sessions) + ", " + std::to_string(status.refused) + " requests refused"});
  for (const auto& bus : status.buses) table.row({"bus of " + bus.part, bus.name});
  for (const auto& phase : status.phases) {
    table.row({"phase " + phase.name, "mean " + fixed(static_cast<double>(phase.mean_ns) * 1e-3, 1) +
                                          " us, max " + fixed(static_cast<double>(phase.max_ns) * 1e-3, 1) +
                                          " us"});
  }
  return table.text() + waiting_text(status);
}

class StatusVerb : public Verb {
 public:
  void declare(CLI::App& app) override {
    add_link_options(app, link_);
    app.footer("Example:\n  visum status --json");
  }

  int run() override {
    auto link = open_link(link_, protocol::Role::kObserver);
    const auto status = link.request_as<ServerStatus>(protocol::Status{});
    const auto& welcome = link.welcome();
    std::fputs((link_.json ? json_of(welcome, status) : text_of(welcome, status)).c_str(), stdout);
    return 0;
  }

 private:
  LinkOptions link_;
};

}  // namespace

std::unique_ptr<Verb> make_status() {
  return std::make_unique<StatusVerb>();
}

}  // namespace visum::cli
