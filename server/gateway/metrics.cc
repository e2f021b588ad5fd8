#include "server/gateway/metrics.h"

#include <cstdio>
#include <string_view>

namespace visum::gateway {
namespace {

constexpr double kSecondsPerNs = 1e-9;

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.9g", value);
  return text;
}

// A label's value: backslash, quote and line feed are escaped (the format's own rules).
std::string label(std::string_view name, std::string_view value) {
  std::string out = std::string(name) + "=\"";
  for (const char c : value) {
    if (c == '\\' || c == '"') out += '\\';
    out += c == '\n' ? std::string("\\n") : std::string(1, c);
  }
  return out + '"';
}

class Page {
 public:
  void head(const char* name, const char* type, const char* help) {
    name_ = name;
    text_ += std::string("# HELP ") + name + ' ' + help + "\n# TYPE " + name + ' ' + type + '\n';
  }
  void value(double value, const std::string& labels = {}) {
    text_ += name_ + (labels.empty() ? "" : "{" + labels + "}") + ' ' + number(value) + '\n';
  }
  void one(const char* name, const char* type, const char* help, double of) {
    head(name, type, help);
    value(of);
  }
  std::string take() { return std::move(text_); }

 private:
  std::string name_, text_;
};

void write_time(Page& page, const protocol::ServerStatus& status) {
  page.one("visum_ticks", "gauge", "Ticks since the last reset.", static_cast<double>(status.tick));
  page.one("visum_sim_time_seconds", "gauge", "Simulated time since the last reset.",
           static_cast<double>(status.sim_time_ns) * kSecondsPerNs);
  page.one("visum_node_stuck_seconds", "gauge",
           "For how long a plug-in's node has not come back; 0: all have.",
           static_cast<double>(status.stuck_ns) * kSecondsPerNs);
  page.one("visum_era", "counter", "Resets and restores, from 1.", static_cast<double>(status.era));
  page.one("visum_paused", "gauge", "1 while time stands.", status.paused);
  page.one("visum_real_time_factor", "gauge", "Simulated per wall time over the last second.",
           status.real_time_factor);
  page.one("visum_overruns_total", "counter", "Ticks that began more than a tick after their due time.",
           static_cast<double>(status.overruns));
  page.one("visum_solver_warnings_total", "counter",
           "Ticks whose step was cut in halves, ended with its budget, or was complained of by ODE.",
           static_cast<double>(status.solver_warnings));
  page.one("visum_tick_working_seconds", "gauge",
           "For how long a tick has been in one phase; 0: no tick takes long.",
           static_cast<double>(status.working_ns) * kSecondsPerNs);
  page.one("visum_silent_stops_total", "counter",
           "Parts that were stopped because the server could not hear their controllers.",
           static_cast<double>(status.silent_stops));
  page.one("visum_late_writes_total", "counter", "Writes that were dropped because they were too old.",
           static_cast<double>(status.late_writes));
  page.one("visum_limited_ticks_total", "counter",
           "Ticks whose work met a limit, and that ended with the best that was reached.",
           static_cast<double>(status.limited_ticks));
  page.head("visum_tick_lateness_seconds", "gauge", "How late ticks begin, in clock realtime.");
  const auto seconds = [](std::int64_t ns) { return static_cast<double>(ns) * kSecondsPerNs; };
  page.value(seconds(status.lateness_p50_ns), label("quantile", "0.5"));
  page.value(seconds(status.lateness_p999_ns), label("quantile", "0.999"));
  page.value(seconds(status.lateness_max_ns), label("quantile", "1"));
}

void write_phases(Page& page, const protocol::ServerStatus& status) {
  page.head("visum_phase_mean_seconds", "gauge", "Mean time of a tick's phase over the last second.");
  for (const auto& phase : status.phases)
    page.value(static_cast<double>(phase.mean_ns) * kSecondsPerNs, label("phase", phase.name));
  page.head("visum_phase_max_seconds", "gauge", "Longest time of a tick's phase over the last second.");
  for (const auto& phase : status.phases)
    page.value(static_cast<double>(phase.max_ns) * kSecondsPerNs, label("phase", phase.name));
}

void write_clients(Page& page, const Metrics& metrics) {
  page.one("visum_sessions", "gauge", "Clients that said hello.", metrics.status.sessions);
  page.one("visum_lockstep_members", "gauge", "Clients that step with the world.",
           static_cast<double>(metrics.status.lockstep.size()));
  page.head("visum_part_leased", "gauge", "1 where a client commands the part.");
  for (const auto& part : metrics.parts) page.value(!part.lease_owner.empty(), label("part", part.name));
  page.one("visum_lease_losses_total", "counter", "Leases that ended without a release.",
           static_cast<double>(metrics.lease_losses));
  page.one("visum_refused_messages_total", "counter", "Messages answered with an error.",
           static_cast<double>(metrics.status.refused));
  page.one("visum_refused_connections_total", "counter", "Sessions, frames and HTTP requests turned away.",
           static_cast<double>(metrics.refused_connections));
}

}  // namespace

std::string to_prometheus(const Metrics& metrics) {
  Page page;
  write_time(page, metrics.status);
  write_phases(page, metrics.status);
  write_clients(page, metrics);
  page.one("visum_frozen", "gauge", "1 while the world stands after a numerical fault.",
           metrics.status.frozen);
  page.one("visum_faults_total", "counter", "Numerical faults of the world.",
           static_cast<double>(metrics.freezes));
  return page.take();
}

}  // namespace visum::gateway
