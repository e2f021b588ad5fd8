#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>

#include "clients/visum/common/exit_code.h"
#include "clients/visum/common/json_writer.h"
#include "clients/visum/run/daemon.h"
#include "clients/visum/verbs/verbs.h"
#include "protocol/config/unknown_name.h"

namespace visum::cli {
namespace {

// A bridge is a program of its own. It is left out of a build where its package is missing.
struct Bridge {
  const char* name;
  const char* program;
  const char* package;  // that it needs beyond those of every build; empty: none
  const char* help;
};
constexpr Bridge kBridges[] = {
    {"finroc", "visum-bridge-finroc", "", "Finroc's tools, finstruct and fingui, over TCP"},
};

std::string program_of(const Bridge& bridge) {
  return run::own_folder() / bridge.program;
}

bool is_built(const Bridge& bridge) {
  return ::access(program_of(bridge).c_str(), X_OK) == 0;
}

std::string why_not_built(const Bridge& bridge) {
  if (is_built(bridge)) return {};
  const std::string program = "there is no " + program_of(bridge);
  return *bridge.package == '\0' ? program : program + "; build it with the package " + bridge.package;
}

const Bridge& find_bridge(const std::string& name) {
  std::vector<std::string> names;
  for (const Bridge& bridge : kBridges) {
    if (name == bridge.name) return bridge;
    names.emplace_back(bridge.name);
  }
  throw ExitError(kUsage, config::unknown_name("bridge", name, names));
}

class BridgeVerb : public Verb {
 public:
  void declare(CLI::App& app) override {
    app_ = &app;
    app.prefix_command();
    app.add_flag("--list", list_, "list the bridges, and which of them were built");
    app.add_flag("--json", json_, "with --list: print JSON instead of text");
    app.footer(
        "`visum bridge NAME [OPTIONS]` starts the bridge NAME. A bridge shows the server's parts to programs "
        "that speak another protocol. `visum bridge NAME "
        "--help` shows its options.\n\nExamples:\n"
        "  visum bridge --list\n  visum bridge finroc --connect 127.0.0.1:1500");
  }

  int run() override {
    if (list_) return print_list();
    auto words = app_->remaining();
    if (words.empty()) throw ExitError(kUsage, "bridge: which one? `visum bridge --list` lists them");
    const Bridge& bridge = find_bridge(words.front());
    if (!is_built(bridge)) {
      throw ExitError(kUsage,
                      std::string("bridge ") + bridge.name + " was not built: " + why_not_built(bridge));
    }
    const std::string program = program_of(bridge);
    words.front() = "visum";  // tells the program to speak of `visum bridge NAME` in its help
    std::vector<char*> argv;
    for (auto& word : words) argv.push_back(word.data());
    argv.push_back(nullptr);
    std::signal(SIGPIPE, SIG_DFL);
    ::execv(program.c_str(), argv.data());
    throw ExitError(kFailed, "cannot run '" + program + "': " + std::strerror(errno));
  }

 private:
  int print_list() const {
    JsonWriter json;
    json.begin_object().key("bridges").begin_array();
    for (const Bridge& bridge : kBridges) {
      const std::string reason = why_not_built(bridge);
      json.begin_object().member("name", bridge.name).member("built", is_built(bridge));
      json.member("reason", reason).end_object();
      if (!json_) std::printf("%-10s %s%s\n", bridge.name, bridge.help, reason.empty() ? "" : " (not built)");
    }
    json.end_array().end_object();
    if (json_) std::puts(json.text().c_str());
    return kDone;
  }

  CLI::App* app_ = nullptr;
  bool list_ = false, json_ = false;
};

}  // namespace

std::unique_ptr<Verb> make_bridge() {
  return std::make_unique<BridgeVerb>();
}

}  // namespace visum::cli
