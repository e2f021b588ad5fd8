#include "protocol/config/profile.h"

#include <algorithm>
#include <cstdio>
#include <ostream>
#include <utility>

namespace visum::config {
namespace {

std::int64_t now_ns() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(Profile::Clock::now().time_since_epoch())
      .count();
}

// Names of phases are ours or those of clients, which may hold anything.
std::string plain_json(std::string_view text) {
  std::string json = "\"";
  for (const char c : text) {
    const bool plain = static_cast<unsigned char>(c) >= 0x20 && c != '"' && c != '\\';
    json += plain ? c : '_';
  }
  return json + "\"";
}

}  // namespace

Profile::Profile(std::size_t most_spans)
    : most_spans_(most_spans),
      names_{"load",      "gateway", "wait",      "parts", "agents", "drives",
             "collision", "physics", "recording", "hash",  "end"},
      began_ns_(now_ns()),
      since_ns_(began_ns_) {
  sums_[kLoad].times = 1;
  if (most_spans_ > 0) spans_.push_back({began_ns_, kLoad});
}

Profile::Phase Profile::add(std::string_view name) {
  const auto found = std::find(names_.begin(), names_.end(), name);
  if (found != names_.end()) return static_cast<Phase>(found - names_.begin());
  if (names_.size() == kMostPhases) return kWait;
  names_.emplace_back(name);
  return static_cast<Phase>(names_.size() - 1);
}

void Profile::count_until(std::int64_t now) {
  sums_[phase_].ns += now - since_ns_;
  since_ns_ = now;
}

Profile::Phase Profile::enter(Phase phase) {
  if (phase == phase_) return phase;
  count_until(now_ns());
  ++sums_[phase].times;
  if (spans_.size() < most_spans_)
    spans_.push_back({since_ns_, phase});
  else if (most_spans_ > 0)
    ++left_out_;
  return std::exchange(phase_, phase);
}

void Profile::tick_begins() {
  if (ticks_ > 0) return;
  count_until(now_ns());
  first_tick_ns_ = since_ns_;
  at_first_tick_ = sums_;
}

void Profile::tick_ended() {
  count_until(now_ns());
  ++ticks_;
  last_tick_ns_ = since_ns_;
  at_last_tick_ = sums_;
}

std::vector<Profile::Time> Profile::run() const {
  return times_of(at_first_tick_, at_last_tick_);
}

std::vector<Profile::Time> Profile::times_of(const Sums& from, const Sums& to) const {
  std::vector<Time> times;
  for (std::size_t i = 0; i < names_.size(); ++i)
    if (to[i].ns > from[i].ns)
      times.push_back({names_[i], to[i].ns - from[i].ns, to[i].times - from[i].times});
  return times;
}

// A span ends where the next one begins. The last one ends where spans were left out, or now.
void Profile::write_spans(std::ostream& out, std::int64_t process) const {
  const auto end = left_out_ > 0 || spans_.empty() ? since_ns_ : now_ns();
  char line[256];
  for (std::size_t i = 0; i < spans_.size(); ++i) {
    const bool last = i + 1 == spans_.size();
    if (last && left_out_ > 0) break;
    const auto until = last ? end : spans_[i + 1].from_ns;
    std::snprintf(line, sizeof line, R"(,"ph":"X","ts":%.3f,"dur":%.3f,"pid":%lld,"tid":%lld})",
                  static_cast<double>(spans_[i].from_ns) * 1e-3,
                  static_cast<double>(until - spans_[i].from_ns) * 1e-3, static_cast<long long>(process),
                  static_cast<long long>(process));
    out << "{\"name\":" << plain_json(names_[spans_[i].phase]) << line << ",\n";
  }
}

std::string name_events(std::int64_t process, std::string_view name, std::string_view thread) {
  const auto number = std::to_string(process);
  const auto event = [&number](const char* kind, std::string_view value) {
    return std::string(R"({"name":")") + kind + R"(","ph":"M","pid":)" + number + R"(,"tid":)" + number +
           R"(,"args":{"name":)" + plain_json(value) + "}},\n";
  };
  return event("process_name", name) + event("thread_name", thread);
}

}  // namespace visum::config
