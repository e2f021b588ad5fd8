// visum-agent: runs an agent of a scene file as a client, in front of the parts of a world or of real ones.
// The daemon runs the same library for the agents of its own scene.
#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdio>
#include <exception>
#include <limits>

#include "clients/agent/remote_agent.h"
#include "protocol/command_line/output.h"
#include "protocol/command_line/parse.h"
#include "protocol/config/config.h"

namespace {

using namespace visum;

struct Options {
  std::string scene, agent;
  std::string connect = "127.0.0.1:1500";
  std::string token_file;
  double time_s = 0.0;
  std::vector<std::string> plugins;
};

void run(const Options& options) {
  const config::Node root = config::load_file(options.scene);
  const config::Node entry = agent::find_entry(root, options.agent);
  const auto libraries = agent::open_libraries(root, plugin::plugin_folders(options.plugins));
  Client client(options.connect, {.name = entry.get("name").text(), .token_file = options.token_file});
  agent::RemoteAgent agent(client, entry, libraries);
  client.join();
  std::int64_t left_ns =
      options.time_s > 0.0 ? std::llround(options.time_s * 1e9) : std::numeric_limits<std::int64_t>::max();
  std::int64_t begin_ns = client.time_ns();
  while (left_ns > 0) {
    agent.think(client.time_ns() - begin_ns);
    const auto era = client.era();
    const std::int64_t before_ns = client.time_ns();
    client.advance_ns(agent.period_ns());
    if (client.era() == era) {
      left_ns -= client.time_ns() - before_ns;
    } else {  // the world was reset, so times before and after cannot be compared
      left_ns -= agent.period_ns();
      agent.reset();
      begin_ns = client.time_ns();
    }
  }
  agent.release();
  client.leave();
  std::printf("done: %s\n", agent.outputs_in_words().c_str());
}

void declare(CLI::App& app, Options& options) {
  app.add_option("scene", options.scene,
                 "a scene file with 'plugins' and 'agents'; the rest of it is ignored")
      ->required()
      ->type_name("SCENE.yaml");
  app.add_option("--agent", options.agent, "the agent's name; needed if the file has several agents");
  app.add_option("--connect", options.connect, "the server of the parts, as HOST:PORT")
      ->capture_default_str();
  app.add_option("--token-file", options.token_file, "a file with the token, for a server that asks for one");
  app.add_option("--time", options.time_s, "end after this many simulated seconds; default: never")
      ->check(CLI::PositiveNumber);
  app.add_option("--plugins", options.plugins,
                 "a folder to look for plug-ins in, before the installed one; repeatable")
      ->type_name("FOLDER")
      ->check(CLI::ExistingDirectory);
  app.footer(
      "Example:\n"
      "  visumd models/scenes/explorer.yaml --clock free &\n"
      "  visum-agent models/scenes/explorer_agent.yaml --time 60\n"
      "The world of this example has no agent of its own; visum-agent brings it.\n"
      "Exit codes: 0 the time is over, 1 the agent or the connection failed, 2 bad usage, 3 the file is "
      "wrong.");
  command_line::add_version(app);
}

int act(int argc, char** argv) {
  Options options;
  CLI::App app{"Runs an agent of a scene file as a client", "visum-agent"};
  declare(app, options);
  if (const auto code = command_line::parse(app, argc, argv)) return *code;
  try {
    run(options);
    return 0;
  } catch (const config::ConfigError& error) {
    std::fprintf(stderr, "visum-agent: %s\n", error.what());
    return 3;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "visum-agent: %s\n", error.what());
    return 1;
  }
}

}  // namespace

int main(int argc, char** argv) {
  return visum::command_line::finish("visum-agent", act(argc, argv));
}
