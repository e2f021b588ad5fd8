#include "server/programs/command_line.h"

#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>

#include "protocol/command_line/output.h"
#include "protocol/command_line/parse.h"
#include "server/gateway/page_files.h"
#include "server/programs/program.h"
#include "server/scene/answer_cache.h"

namespace visum::programs {
namespace {

std::string check_http(const std::string& text) {
  if (text == "off") return {};
  const bool digits =
      !text.empty() && text.size() <= 5 && text.find_first_not_of("0123456789") == std::string::npos;
  return digits && std::stoi(text) <= 65535 ? std::string() : "must be a port from 0 to 65535, or off";
}

// All three files or none: TLS without knowing the clients would protect only half.
void declare_tls(CLI::App& app, protocol::TlsFiles& tls) {
  auto* certificate = app.add_option("--tls-cert", tls.certificate,
                                     "speak TLS 1.3 only, with this certificate (PEM); also on the "
                                     "port of HTTP (https, wss)");
  auto* key =
      app.add_option("--tls-key", tls.key, "the private key of --tls-cert; no other user may read the file");
  auto* authority = app.add_option("--tls-ca", tls.authority,
                                   "the authority that must have signed the clients' certificates (PEM)");
  for (auto* option : {certificate, key, authority})
    option->type_name("FILE")->check(CLI::ExistingFile)->needs(certificate)->needs(key)->needs(authority);
}

// When a server in real time trusts commands no more.
void declare_guards(CLI::App& app, gateway::DaemonOptions& daemon) {
  const auto add = [&](const char* name, std::chrono::milliseconds& value, const char* help) {
    app.add_option_function<int>(
           name, [&value](const int& ms) { value = std::chrono::milliseconds(ms); }, help)
        ->default_str(std::to_string(value.count()))
        ->type_name("MS")
        ->check(CLI::Range(0, 60'000));
  };
  add("--session-silence-ms", daemon.session_silence,
      "in real time: once the sessions have been held up for so many milliseconds of wall time, stop the "
      "parts "
      "that they command; 0: never");
  add("--command-age-ms", daemon.command_age,
      "in real time: drop writes that are older than so many milliseconds of wall time; 0: none");
  app.add_option("--realtime-priority", daemon.realtime_priority,
                 "in real time: put the thread of the ticks before all ordinary programs of this machine "
                 "(SCHED_FIFO with this priority). A world that cannot keep up then takes a whole processor")
      ->type_name("1..99")
      ->check(CLI::Range(1, 99));
}

}  // namespace

void declare_packages(CLI::App& app, scene::Packages& packages) {
  app.add_option_function<std::vector<std::string>>(
         "--package",
         [&packages](const std::vector<std::string>& words) {
           for (const std::string& word : words) {
             const std::size_t equals = word.find('=');
             if (equals == 0 || equals == std::string::npos || equals + 1 == word.size())
               throw CLI::ValidationError("--package", "must be NAME=PATH, is '" + word + "'");
             packages.given[word.substr(0, equals)] = word.substr(equals + 1);
           }
         },
         "where the package NAME lies that the meshes of models name; repeatable")
      ->type_name("NAME=PATH")
      ->allow_extra_args(false);
}

void declare_cache(CLI::App& app) {
  scene::keep_answers_in(scene::usual_cache_folder());
  app.add_flag_callback(
      "--no-cache", [] { scene::keep_answers_in({}); },
      "neither use nor keep converted meshes of earlier runs (~/.cache/visum)");
}

void declare_node_timeout(CLI::App& app, PluginOptions& plugins) {
  app.add_option("--node-timeout", plugins.node_timeout_s,
                 "seconds that one call of a plug-in may take; a longer call counts as hanging, and the "
                 "program ends with exit code 124; 0: no limit")
      ->capture_default_str()
      ->check(CLI::IsMember({0.0}) | CLI::Range(0.1, 86400.0));
}

void declare_plugins(CLI::App& app, PluginOptions& plugins) {
  app.add_option("--plugins", plugins.folders,
                 "a folder to look for the scene's plug-ins in, before the installed one; repeatable")
      ->type_name("FOLDER")
      ->check(CLI::ExistingDirectory);
}

void declare_doors(CLI::App& app, gateway::DaemonOptions& daemon) {
  app.add_option("--listen", daemon.address, "address to listen on; one beyond loopback needs --token-file")
      ->capture_default_str();
  app.add_option("--port", daemon.port, "TCP port; 0: any free one")->capture_default_str();
  app.add_option(
      "--token-file", daemon.token_file,
      "a file with lines of \"ROLE TOKEN\" or \"ROLE CN=NAME\"; clients then need such a token, or a "
      "certificate with that name");
  declare_tls(app, daemon.tls);
}

void declare_common(CLI::App& app, gateway::DaemonOptions& daemon, OutputOptions& output) {
  declare_doors(app, daemon);
  declare_guards(app, daemon);
  app.add_option("--iterations", daemon.iterations, "end after this many ticks")
      ->check(CLI::NonNegativeNumber);
  app.add_flag("--json", output.json, "print one line of JSON when ready");
  app.add_option("-v", output.verbosity, "how much to log: 0 errors, 1 warnings, 2 news, 3 details")
      ->check(CLI::Range(0, 3));
}

gateway::HttpOptions HttpArguments::settled(const gateway::DaemonOptions& daemon) const {
  gateway::HttpOptions http = daemon.http;
  http.on = port != "off";
  if (!http.on) return http;
  const bool given = !port.empty();
  if (given) http.port = static_cast<std::uint16_t>(std::stoi(port));
  if (!given && daemon.port == 0) http.port = 0;
  http.any_if_taken = !given;
  if (http.page.empty()) http.page = gateway::find_page_folder();
  if (http.page.empty())
    spdlog::warn(
        "found no page beside this program, so HTTP serves /healthz and /metrics only; "
        "--page names its folder");
  return http;
}

void declare_http(CLI::App& app, gateway::DaemonOptions& daemon, HttpArguments& http) {
  app.add_option(
         "--http", http.port,
         "port of the page, /metrics and /healthz; 0: any free one; off: none. Default: 8080, or any free "
         "one if 8080 is taken or --port is 0")
      ->type_name("PORT|off")
      ->check(check_http);
  app.add_option(
         "--http-host", daemon.http.hosts,
         "a further name under which browsers may ask for the page, with :PORT if they see another port than "
         "--http; repeatable")
      ->type_name("NAME[:PORT]");
  app.add_option("--page", daemon.http.page,
                 "folder of the page's files; default: the one beside this program")
      ->type_name("FOLDER");
}

int run_command(CLI::App& app, const Command& command, const std::string& log_name,
                const OutputOptions& output, const std::function<int()>& run) {
  if (const auto code = command_line::parse(app, command.argc, command.argv))
    return command_line::finish(log_name, *code);
  set_up_log(log_name, output.verbosity);
  const int code = exit_code_of(run);
  end_log();
  return command_line::finish(log_name, code);
}

}  // namespace visum::programs
