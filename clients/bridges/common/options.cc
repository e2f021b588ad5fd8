#include "clients/bridges/common/options.h"

#include <CLI/CLI.hpp>
#include <cstdio>

#include "clients/visum/common/exit_code.h"
#include "clients/visum/common/json_writer.h"

namespace visum::bridge {

ClientOptions Options::client(const std::string& bridge) const {
  ClientOptions client;
  client.name = bridge + " bridge";
  client.token_file = token_file;
  client.tls_ca = tls_ca;
  client.tls_cert = tls_cert;
  client.tls_key = tls_key;
  return client;
}

void declare(CLI::App& app, Options& options, const std::string& protocol) {
  app.add_option("--connect", options.connect, "the server's HOST:PORT")
      ->capture_default_str()
      ->envname("VISUM_CONNECT");
  app.add_option("--token-file", options.token_file, "a file with the token, for a server that asks for one");
  const auto add_tls = [&](const char* name, std::string& file, const char* help, const char* variable) {
    app.add_option(name, file, help)->type_name("FILE")->envname(variable);
  };
  add_tls("--tls-ca", options.tls_ca, "TLS to the server: the authority that signed its certificate (PEM)",
          "VISUM_TLS_CA");
  add_tls("--tls-cert", options.tls_cert, "TLS to the server: our certificate (PEM)", "VISUM_TLS_CERT");
  add_tls("--tls-key", options.tls_key, "TLS to the server: our private key (PEM)", "VISUM_TLS_KEY");
  app.add_option("--port", options.port,
                 "TCP port for " + protocol +
                     " peers; 0: any free one; default: the usual one, or the next free one above")
      ->check(CLI::Range(0, 65535));
  app.add_option("--listen", options.listen,
                 "address to listen on for peers; one beyond loopback needs --no-authentication")
      ->capture_default_str();
  app.add_flag("--no-authentication", options.no_authentication,
               "allow an address beyond loopback, though " + protocol +
                   " asks nobody for a password: everybody who reaches it may command the parts");
  auto* lockstep = app.add_flag("--lockstep", options.lockstep,
                                "the world waits for the messages that --gate names, or for a step");
  app.add_option("--gate", options.gates,
                 "a controller input as PART/PORT; the world goes on for a period once each gate has been "
                 "written; repeatable")
      ->needs(lockstep);
  app.add_option("--period", options.period_ms, "with --lockstep: the period in ms")
      ->capture_default_str()
      ->needs(lockstep)
      ->check(CLI::Range(1e-3, 1e6));
  app.add_flag("--json", options.json, "print the ready line as JSON");
}

void check_address(const Options& options, const std::string& protocol) {
  const bool loopback = options.listen.starts_with("127.") || options.listen == "::1";
  if (loopback || options.no_authentication) return;
  throw cli::ExitError(cli::kUsage, "--listen: '" + options.listen + "' is beyond loopback, and " + protocol +
                                        " has no authentication; add --no-authentication if everybody who "
                                        "reaches this address may command the parts");
}

void print_ready(const Options& options, const std::string& bridge, std::uint16_t port,
                 const std::vector<std::string>& parts) {
  std::string text;
  if (options.json) {
    cli::JsonWriter json;
    json.begin_object().member("ready", true).member("bridge", bridge).member("port", port);
    json.member("connect", options.connect).key("parts").begin_array();
    for (const std::string& part : parts) json.value(part);
    json.end_array().end_object();
    text = json.text();
  } else {
    text = bridge + " bridge on " + options.listen + ":" + std::to_string(port) + " for the server at " +
           options.connect + ", parts:";
    for (const std::string& part : parts) text += " " + part;
  }
  std::puts(text.c_str());
  std::fflush(stdout);
}

}  // namespace visum::bridge
