// The options that the server programs share, and the way from the command line to a program's work and its
// exit code. Main thread only.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "server/gateway/daemon.h"
#include "server/scene/packages.h"

namespace CLI {
class App;
}

namespace visum::programs {

// How much a program prints, and in which form.
struct OutputOptions {
  int verbosity = 2;  // 0 errors, 1 warnings, 2 news, 3 details
  bool json = false;  // the result, or "ready", as one line of JSON on stdout
};

// Where plug-ins of scenes may come from, and how long one of their calls may take.
struct PluginOptions {
  std::vector<std::string> folders;
  double node_timeout_s = 10.0;  // 0: no limit
  std::chrono::milliseconds node_timeout() const {
    return std::chrono::milliseconds(static_cast<std::int64_t>(node_timeout_s * 1e3));
  }
};
// Adds --plugins.
void declare_plugins(CLI::App& app, PluginOptions& plugins);
// Adds --package NAME=PATH: where the packages lie that models name. Fills `packages` as it reads the words.
void declare_packages(CLI::App& app, scene::Packages& packages);
// Adds --no-cache. Without it, what slow readers make of a scene's files is kept for later runs.
void declare_cache(CLI::App& app);
// Adds --node-timeout, for programs that run the plug-ins' code.
void declare_node_timeout(CLI::App& app, PluginOptions& plugins);

// Adds --listen, --port, --token-file and the three --tls options: where clients reach the program, and who
// may.
void declare_doors(CLI::App& app, gateway::DaemonOptions& daemon);
// Adds those, --session-silence-ms, --command-age-ms, --iterations, --json and -v.
void declare_common(CLI::App& app, gateway::DaemonOptions& daemon, OutputOptions& output);

// The port of the page, /metrics and /healthz, as the user gave it.
struct HttpArguments {
  std::string port;  // a number, or "off"; empty: not given
  // Fills in what the user left open. Without --http that is the usual port, or any free one if the usual one
  // is taken or --port is 0. Without --page it is the page that stands beside this program.
  gateway::HttpOptions settled(const gateway::DaemonOptions& daemon) const;
};
// Adds --http, --http-host and --page.
void declare_http(CLI::App& app, gateway::DaemonOptions& daemon, HttpArguments& http);

// The words that a program, or one of its verbs, was started with.
struct Command {
  int argc;
  char** argv;       // argv[0] is the program or the verb
  std::string name;  // for --help: "visum check", as the user typed it
};

// Reads the words into the app, sets up the log as `log_name`, and calls run(). Returns what run() returns,
// or the exit code for what it throws (exit_code_of), or kOutputLost (output.h).
int run_command(CLI::App& app, const Command& command, const std::string& log_name,
                const OutputOptions& output, const std::function<int()>& run);

}  // namespace visum::programs
