#include "clients/agent/remote_agent.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "protocol/config/unknown_name.h"
#include "protocol/plugin/node_settings.h"

namespace visum::agent {
namespace {

constexpr double kUsualPeriod_ms = 10.0;  // the same default as in scenes

const plugin::AgentKind& kind_of(const config::Node& entry, const std::vector<plugin::Library>& libraries) {
  const config::Node kind = entry.get("kind");
  if (const auto* found = plugin::find_agent(libraries, kind.text())) return *found;
  std::vector<std::string> known;
  for (const auto& library : libraries)
    for (const auto& row : library.manifest->agents) known.emplace_back(row.name);
  if (known.empty()) kind.fail("none of the plug-ins in 'plugins' has agents");
  kind.one_of(known);
  throw std::logic_error("one_of takes what find_agent does not");
}

}  // namespace

// The answers to a new agent's questions: its name, settings and parts. It lives only while the agent is
// made.
class RemoteAgent::Context final : public plugin::AgentContext {
 public:
  Context(Client& client, const config::Node& entry, RemoteAgent& agent)
      : client_(client),
        entry_(entry),
        agent_(agent),
        name_(entry.get("name").text()),
        settings_(entry, {"name", "kind", "period_ms", "parts"}) {}

  const std::string& name() const override { return name_; }
  double period_s() const override { return static_cast<double>(agent_.period_ns_) * 1e-9; }
  plugin::Settings& settings() override { return settings_; }
  plugin::PartLink& commanded(std::string_view word) override { return link(word, true); }
  plugin::PartLink& watched(std::string_view word) override { return link(word, false); }
  std::size_t add_output(const plugin::Port& port) override {
    agent_.ports_.push_back(port);
    agent_.outputs_.push_back(port.initial);
    return agent_.ports_.size() - 1;
  }
  void refuse_others() const { settings_.refuse_others(); }

 private:
  plugin::PartLink& link(std::string_view word, bool commanded) {
    const std::string part = entry_.get("parts").get(word).text();
    agent_.links_.push_back(std::make_unique<RemoteLink>(client_, part, commanded));
    return *agent_.links_.back();
  }

  Client& client_;
  const config::Node& entry_;
  RemoteAgent& agent_;
  const std::string name_;
  plugin::NodeSettings settings_;
};

RemoteAgent::RemoteAgent(Client& client, const config::Node& entry,
                         const std::vector<plugin::Library>& libraries) {
  const auto& kind = kind_of(entry, libraries);
  period_ns_ = std::llround(entry.number_or("period_ms", kUsualPeriod_ms, {0.0, 1e6, true}) * 1e6);
  Context context(client, entry, *this);
  agent_ = plugin::make_node(kind, context, entry);
  context.refuse_others();
}

RemoteAgent::~RemoteAgent() = default;

void RemoteAgent::think(std::int64_t time_ns) {
  agent_->think({time_ns, outputs_});
  for (const auto& link : links_) link->end_turn();
}

void RemoteAgent::reset() {
  std::ranges::transform(ports_, outputs_.begin(), &plugin::Port::initial);
  agent_->reset();
}

void RemoteAgent::release() {
  for (const auto& link : links_) link->release();
}

std::string RemoteAgent::outputs_in_words() const {
  std::string words;
  for (std::size_t i = 0; i < ports_.size(); ++i) {
    char value[32];
    std::snprintf(value, sizeof value, " %.4g", outputs_[i]);
    words += (words.empty() ? "" : ", ") + ports_[i].name + value;
    if (!ports_[i].unit.empty()) words += " " + ports_[i].unit;
  }
  return words;
}

config::Node find_entry(const config::Node& root, const std::string& name) {
  const config::Node list = root.get("agents");
  if (name.empty() && list.size() == 1) return list.at(0);
  if (name.empty()) list.fail("has several agents: name one with --agent");
  std::vector<std::string> known;
  for (std::size_t i = 0; i < list.size(); ++i) {
    known.push_back(list.at(i).get("name").text());
    if (known.back() == name) return list.at(i);
  }
  list.fail(config::unknown_name("agent", name, known));
}

std::vector<plugin::Library> open_libraries(const config::Node& root,
                                            const std::vector<std::filesystem::path>& folders) {
  std::vector<plugin::Library> libraries;
  const config::Node list = root.get("plugins");
  for (std::size_t i = 0; i < list.size(); ++i) {
    try {
      libraries.push_back(plugin::open_library(list.at(i).text(), folders));
    } catch (const plugin::Error& error) {
      list.at(i).fail(error.what());
    }
  }
  return libraries;
}

}  // namespace visum::agent
