// visum: the command line. Its verbs stand in the table below; each is a file in verbs/.
#include <poll.h>
#include <unistd.h>

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
#include "protocol/config/config.h"

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
    {"status", "show time, pace, load, and who is waited for", cli::make_status},
    {"pause", "stop time", cli::make_pause},
    {"resume", "let time run", cli::make_resume},
    {"step", "let a paused world do some ticks", cli::make_step},
    {"speedup", "run faster or slower than the wall clock", cli::make_speedup},
    {"reset", "go back to the scene's beginning", cli::make_reset},
    {"snapshot", "keep the state of the world", cli::make_snapshot},
    {"restore", "go back to a snapshot", cli::make_restore},
    {"push", "push a body", cli::make_push},
    {"fault", "break something on purpose, or end that", cli::make_fault},
    {"faults", "list what can be broken, and what is", cli::make_faults},
    {"check", "say what is wrong with a scene", cli::make_check},
    {"convert", "write a scene in another format", cli::make_convert},
    {"run", "run a scenario and check it", cli::make_run},
    {"record", "run a server and write down what happens: FILE.mcap SCENE.yaml [OPTIONS]", cli::make_record},
    {"replay", "go through a recording again and compare every tick", cli::make_replay},
    {"rewind", "run a server from a moment of a recording on: FILE.mcap --at SECONDS", cli::make_rewind},
    {"export", "write a recording's ports as CSV", cli::make_export},
    {"exec", "run a program with a part's bus where it looks for its device", cli::make_exec},
    {"mirror", "serve a part once more, with two arms behind it", cli::make_mirror},
    {"completion", "print a completion script for a shell", cli::make_completion},
};

int complain(cli::ExitCode code, const char* text) {
  std::fprintf(stderr, "visum: %s\n", text);
  return code;
}

// Wrong names and values are the user's, as wrong options are.
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

// Whether all that was printed has arrived. A pipe whose reader has seen enough (| head) is no failure.
bool is_printed() {
  if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0) return true;
  pollfd reader{STDOUT_FILENO, 0, 0};
  return ::poll(&reader, 1, 0) == 1 && (reader.revents & (POLLERR | POLLHUP)) != 0;
}

int act(int argc, char** argv) {
  CLI::App app{"visum: looks at and commands the parts of a Visum server, and runs scenarios"};
  app.set_version_flag("--version", "visum " VISUM_VERSION);
  app.require_subcommand(1);
  app.footer(
      "`visum VERB --help` shows a verb's options and examples.\n"
      "Exit codes: 0 done or passed, 1 refused or failed, 2 bad usage, unknown names and values, 3 scene or "
      "scenario\n"
      "wrong, 4 connection or controller lost, 5 a replay differs, 6 the host was too slow for real time,\n"
      "124 timed out, 130 interrupted.");
  std::vector<std::pair<CLI::App*, std::unique_ptr<cli::Verb>>> verbs;
  for (const Row& row : kVerbs) {
    verbs.emplace_back(app.add_subcommand(row.name, row.help), row.make());
    verbs.back().second->declare(*verbs.back().first);
  }
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? cli::kDone : cli::kUsage;
  }
  for (const auto& [command, verb] : verbs) {
    if (command->parsed()) return run(*verb);
  }
  return cli::kUsage;
}

}  // namespace

int main(int argc, char** argv) {
  std::signal(SIGPIPE, SIG_IGN);
  const int code = act(argc, argv);
  return code != cli::kDone || is_printed() ? code
                                            : complain(cli::kFailed, "standard output: cannot be written");
}
