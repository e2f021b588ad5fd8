#include "server/programs/command_line.h"

#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>

#include "server/gateway/page_files.h"
#include "server/programs/program.h"

namespace visum::programs {
namespace {

std::string check_http(const std::string& text) {
  if (text == "off") return {};
  const bool digits =
      !text.empty() && text.size() <= 5 && text.find_first_not_of("0123456789") == std::string::npos;
  return digits && std::stoi(text) <= 65535 ? std::string() : "must be a port from 0 to 65535, or off";
}

// All three, or none: to speak TLS to clients that are not known would be half of it.
void declare_tls(CLI::App& app, protocol::TlsFiles& tls) {
  auto* certificate = app.add_option("--tls-cert", tls.certificate,
                                     "speak TLS 1.3 only, with this certificate (PEM), HTTP's port, too: "
                                     "https, wss");
  auto* key = app.add_option("--tls-key", tls.key, "its private key, ours alone to read");
  auto* authority =
      app.add_option("--tls-ca", tls.authority, "who must have signed the certificates of clients");
  for (auto* option : {certificate, key, authority})
    option->type_name("FILE")->check(CLI::ExistingFile)->needs(certificate)->needs(key)->needs(authority);
}

}  // namespace

void declare_node_timeout(CLI::App& app, PluginOptions& words) {
  app.add_option("--node-timeout", words.node_timeout_s,
                 "seconds that a plug-in's call may take: then it hangs, and this ends with exit code 124; "
                 "0: for ever")
      ->capture_default_str()
      ->check(CLI::IsMember({0.0}) | CLI::Range(0.1, 86400.0));
}

void declare_plugins(CLI::App& app, PluginOptions& words) {
  app.add_option("--plugins", words.folders,
                 "a folder that plug-ins of the scene may come from, before the installed one; repeatable")
      ->type_name("FOLDER")
      ->check(CLI::ExistingDirectory);
}

void declare_doors(CLI::App& app, gateway::DaemonOptions& daemon) {
  app.add_option("--listen", daemon.address, "address to listen on; beyond loopback with --token-file only")
      ->capture_default_str();
  app.add_option("--port", daemon.port, "TCP port; 0: any free one")->capture_default_str();
  app.add_option(
      "--token-file", daemon.token_file,
      "lines of \"ROLE TOKEN\" or \"ROLE CN=NAME\"; clients then need a token, or such a certificate");
  declare_tls(app, daemon.tls);
}

void declare_common(CLI::App& app, gateway::DaemonOptions& daemon, OutputOptions& talk) {
  declare_doors(app, daemon);
  app.add_option("--iterations", daemon.iterations, "end after so many ticks")->check(CLI::NonNegativeNumber);
  app.add_flag("--json", talk.json, "print one line of JSON when ready");
  app.add_option("-v", talk.verbosity, "0 errors, 1 warnings, 2 news, 3 details")->check(CLI::Range(0, 3));
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
  if (http.page.empty()) spdlog::warn("no page beside this program: HTTP has /healthz and /metrics only");
  return http;
}

void declare_http(CLI::App& app, gateway::DaemonOptions& daemon, HttpArguments& words) {
  app.add_option(
         "--http", words.port,
         "port of the page, /metrics and /healthz; 0: any free one; off. Default: 8080, or any free one "
         "where that is taken or --port is 0")
      ->type_name("PORT|off")
      ->check(check_http);
  app.add_option(
         "--http-host", daemon.http.hosts,
         "a further name under which browsers may ask for the page; :PORT where they see another one than "
         "--http; may be repeated")
      ->type_name("NAME[:PORT]");
  app.add_option("--page", daemon.http.page, "folder of the page's files, instead of the one found")
      ->type_name("FOLDER");
}

int run_command(CLI::App& app, int argc, char** argv, const std::string& name, const OutputOptions& talk,
                const std::function<int()>& run) {
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? kPassed : kUsage;
  }
  set_up_log(name, talk.verbosity);
  return exit_code_of(run);
}

}  // namespace visum::programs
