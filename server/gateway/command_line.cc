#include "server/gateway/command_line.h"

#include <CLI/CLI.hpp>

#include "server/gateway/program.h"

namespace visum::gateway {

void declare_plugins(CLI::App& app, std::vector<std::string>& folders) {
  app.add_option("--plugins", folders,
                 "a folder that plug-ins of the scene may come from, before the installed one; repeatable")
      ->type_name("FOLDER")
      ->check(CLI::ExistingDirectory);
}

void declare_common(CLI::App& app, DaemonOptions& daemon, Talk& talk) {
  app.add_option("--listen", daemon.address, "address to listen on; beyond loopback with --token-file only")
      ->capture_default_str();
  app.add_option("--port", daemon.port, "TCP port; 0: any free one")->capture_default_str();
  app.add_option("--token-file", daemon.token_file, "lines of \"ROLE TOKEN\"; clients then need one");
  app.add_flag("--json", talk.json, "print one line of JSON when ready");
  app.add_option("-v", talk.verbosity, "0 errors, 1 warnings, 2 news, 3 details")->check(CLI::Range(0, 3));
}

int run_command(CLI::App& app, int argc, char** argv, const std::string& name, const Talk& talk,
                const std::function<int()>& run) {
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? kPassed : kUsage;
  }
  set_up_log(name, talk.verbosity);
  return exit_code_of(run);
}

}  // namespace visum::gateway
