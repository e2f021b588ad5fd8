#include "clients/visum/verbs/verb.h"

#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <CLI/TypeTools.hpp>

#include "clients/visum/common/format.h"

namespace visum::cli {

void add_link_options(CLI::App& app, LinkOptions& options, bool json) {
  app.add_option("--connect", options.connect, "the server's HOST:PORT")
      ->capture_default_str()
      ->envname("VISUM_CONNECT");
  app.add_option("--token-file", options.token_file, "a file with the token, for a server that asks for one");
  const auto add_tls = [&](const char* name, std::string& file, const char* help, const char* variable) {
    app.add_option(name, file, help)->type_name("FILE")->envname(variable);
  };
  add_tls("--tls-ca", options.tls.authority, "TLS: the authority that signed the server's certificate (PEM)",
          "VISUM_TLS_CA");
  add_tls("--tls-cert", options.tls.certificate, "TLS: our certificate (PEM)", "VISUM_TLS_CERT");
  add_tls("--tls-key", options.tls.key, "TLS: our private key (PEM)", "VISUM_TLS_KEY");
  if (json) app.add_flag("--json", options.json, "print JSON instead of text");
}

CLI::Validator number_within(double least, double most) {
  const std::string range = exact(least) + " .. " + exact(most);
  return {[=](std::string& text) {
            double number = 0.0;
            const bool good = CLI::detail::lexical_cast(text, number) && number >= least && number <= most;
            return good ? std::string() : "'" + text + "' is not a number within " + range;
          },
          range};
}

}  // namespace visum::cli
