// The words that all server programs understand, and their way from the command line to run() and out.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "server/gateway/daemon.h"

namespace CLI {
class App;
}

namespace visum::programs {

// What is said, and how much of it.
struct OutputOptions {
  int verbosity = 2;  // 0 errors, 1 warnings, 2 news, 3 details
  bool json = false;  // one line when ready
};

// Where plug-ins of scenes may come from, and how long one of their calls may take.
struct PluginOptions {
  std::vector<std::string> folders;
  double node_timeout_s = 10.0;  // 0: for ever
  std::chrono::milliseconds node_timeout() const {
    return std::chrono::milliseconds(static_cast<std::int64_t>(node_timeout_s * 1e3));
  }
};
// --plugins; and --node-timeout, where their code runs.
void declare_plugins(CLI::App& app, PluginOptions& words);
void declare_node_timeout(CLI::App& app, PluginOptions& words);

// --listen, --port, --token-file and --tls-...: where it can be reached, and by whom.
void declare_doors(CLI::App& app, gateway::DaemonOptions& daemon);
// Those, --iterations, --json and -v.
void declare_common(CLI::App& app, gateway::DaemonOptions& daemon, OutputOptions& talk);

// The port of the page, /metrics and /healthz, as a user said it.
struct HttpArguments {
  std::string port;  // or "off"; empty: not given
  // What that means: without a word the usual port, or any free one where that is taken or --port leaves the
  // choice too; with the page beside this program, unless another is named.
  gateway::HttpOptions settled(const gateway::DaemonOptions& daemon) const;
};
// --http, --http-host and --page.
void declare_http(CLI::App& app, gateway::DaemonOptions& daemon, HttpArguments& words);

// Reads the words, sets up the log as `name`, and returns what run() does, or the exit code of its failure.
int run_command(CLI::App& app, int argc, char** argv, const std::string& name, const OutputOptions& talk,
                const std::function<int()>& run);

}  // namespace visum::programs
