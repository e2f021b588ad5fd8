// visum: the command line. The table below lists its verbs; each is a file in verbs/.
#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <csignal>
#include <cstdio>
#include <exception>
#include <vector>

#include "clients/visum/common/exit_code.h"
#include "clients/visum/verbs/verbs.h"
#include "protocol/client.h"
#include "protocol/command_line/output.h"
#include "protocol/command_line/parse.h"
#include "protocol/config/config.h"
#include "protocol/config/printable.h"

namespace {

using namespace visum;

struct Row {
  const char* name;
  const char* help;
  std::unique_ptr<cli::Verb> (*make)();
};

constexpr Row kVerbs[] = {
    {"parts", "list the parts that a server offers", cli::make_parts},
    {"describe", "show a part's ports, parameters and blackboards", cli::make_describe},
    {"get", "read ports", cli::make_get},
    {"set", "write controller inputs", cli::make_set},
    {"watch", "follow ports", cli::make_watch},
    {"params", "show a part's parameters", cli::make_params},
    {"param-set", "change a part's parameter", cli::make_param_set},
    {"camera", "write a camera's picture to a file", cli::make_camera},
    {"status", "show time, pace, load, and which clients the world waits for", cli::make_status},
    {"stop", "pull the emergency stop of a part, or of all", cli::make_stop},
    {"pause", "stop time", cli::make_pause},
    {"resume", "let time run", cli::make_resume},
    {"step", "let a paused world do some ticks", cli::make_step},
    {"speedup", "run faster or slower than the wall clock", cli::make_speedup},
    {"reset", "go back to the scene's beginning, in whole or in part", cli::make_reset},
    {"events", "list what has happened in a server, or follow it", cli::make_events},
    {"snapshot", "keep the state of the world", cli::make_snapshot},
    {"restore", "go back to a snapshot", cli::make_restore},
    {"push", "push a body", cli::make_push},
    {"pull", "pull a body to a place", cli::make_pull},
    {"pose", "put a body elsewhere", cli::make_pose},
    {"joints", "put a model's joints elsewhere", cli::make_joints},
    {"spawn", "bring a model with its parts into a world that runs", cli::make_spawn},
    {"remove", "take a model that was spawned, or a body, out of the world", cli::make_remove},
    {"scenes", "list the scenes and scenarios that a server has", cli::make_scenes},
    {"load", "put another scene in the place of the world's", cli::make_load},
    {"fault", "break something on purpose, or end that", cli::make_fault},
    {"faults", "list what can be broken, and what is broken now", cli::make_faults},
    {"check", "say what is wrong with a scene", cli::make_check},
    {"drives", "write a drives file for a model", cli::make_drives},
    {"convert", "write a scene in another format", cli::make_convert},
    {"run", "run a scenario and check it", cli::make_run},
    {"scenario", "let a server run a scenario of its installation", cli::make_scenario},
    {"campaign", "make all runs of a sweep and judge them together", cli::make_campaign},
    {"report", "put the results of a campaign's shards together", cli::make_report},
    {"compare", "compare two recordings, or two campaigns", cli::make_compare},
    {"record", "run a server and record what happens in its world", cli::make_record},
    {"recording", "start or stop a recording of a world that runs", cli::make_recording},
    {"replay", "repeat a recorded run and compare every tick", cli::make_replay},
    {"rewind", "run a server from a moment of a recording on", cli::make_rewind},
    {"export", "write a recording's ports as CSV", cli::make_export},
    {"exec", "run a program with a part's bus in place of its device", cli::make_exec},
    {"mirror", "serve a part once more, with two arms behind it", cli::make_mirror},
    {"modules", "list the modules of connected controllers, or hold one's sensor input", cli::make_modules},
    {"bridge", "let programs that speak another protocol meet the parts", cli::make_bridge},
    {"completion", "print a completion script for a shell", cli::make_completion},
};

int complain(cli::ExitCode code, const char* text) {
  std::fprintf(stderr, "visum: %s\n", config::printable(text, "\t\n").c_str());
  return code;
}

// The exit code for a refused request. An unknown name or a bad value is the user's mistake, as a wrong
// option is.
cli::ExitCode code_of(protocol::ErrorCode code) {
  switch (code) {
    case protocol::ErrorCode::kUnknownName:
    case protocol::ErrorCode::kBadValue:
      return cli::kUsage;
    case protocol::ErrorCode::kTimeout:
      return cli::kLost;
    default:
      return cli::kFailed;
  }
}

int run(cli::Verb& verb) try { return verb.run(); } catch (const cli::ExitError& error) {
  return complain(error.code(), error.what());
} catch (const config::ConfigError& error) {
  return complain(cli::kBadConfig, error.what());
} catch (const protocol::RequestError& error) {
  return complain(code_of(error.code()), error.what());
} catch (const protocol::ConnectionError& error) {
  return complain(cli::kLost, error.what());
} catch (const std::exception& error) {
  return complain(cli::kFailed, error.what());
}

int act(int argc, char** argv) {
  CLI::App app{"Looks at and commands the parts of a Visum server, and runs scenarios", "visum"};
  command_line::add_version(app);
  app.require_subcommand(1);
  app.footer(
      "`visum VERB --help` shows a verb's options and examples.\n"
      "Exit codes: 0 done or passed, 1 refused or failed, 2 bad usage, unknown name or bad value, 3 the "
      "scene or "
      "scenario is wrong, 4 the connection or a controller was lost, 5 a replay differs, 6 "
      "what the run claims could not be established, 124 timed out, 130 interrupted.");
  std::vector<std::pair<CLI::App*, std::unique_ptr<cli::Verb>>> verbs;
  for (const Row& row : kVerbs) {
    verbs.emplace_back(app.add_subcommand(row.name, row.help), row.make());
    verbs.back().second->declare(*verbs.back().first);
  }
  if (const auto code = command_line::parse(app, argc, argv)) return *code;
  for (const auto& [command, verb] : verbs) {
    if (command->parsed()) return run(*verb);
  }
  return cli::kUsage;
}

}  // namespace

int main(int argc, char** argv) {
  std::signal(SIGPIPE, SIG_IGN);
  command_line::leave(command_line::finish("visum", act(argc, argv)));
}
