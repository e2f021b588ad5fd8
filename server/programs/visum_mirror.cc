// visum-mirror: serves a part once more, with two arms behind it. Both get the commands; the controller sees
// the primary.
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <csignal>
#include <string>

#include "protocol/command_line/parse.h"
#include "protocol/config/config.h"
#include "protocol/token_file.h"
#include "server/cycle/simulation.h"
#include "server/gateway/daemon.h"
#include "server/mirror/mirror_parts.h"
#include "server/programs/command_line.h"
#include "server/programs/program.h"

namespace {

using namespace visum;

struct Options {
  std::string primary, shadow;
  std::string part = "arm";
  std::string arm_token_file;
  protocol::TlsFiles arm_tls;
  double speedup = 1.0;
  programs::OutputOptions output;
  programs::HttpArguments http;
  mirror::MirrorBounds bounds;
  gateway::DaemonOptions of_daemon;
};

// A scene of two parts and no bodies.
scene::Scene scene_of(const mirror::Mirror& mirror, const Options& options) {
  const auto nothing = config::load_text("{}", "mirror");
  const double tick_s = static_cast<double>(mirror.tick_ns()) * 1e-9;
  scene::Scene scene;
  scene.name = "mirror of " + options.primary + " and " + options.shadow;
  scene.world.tick_ns = mirror.tick_ns();
  scene.parts.push_back({"arm", {options.part, nothing, {}, tick_s}, {}});
  scene.parts.push_back({"divergence", {options.part + "_divergence", nothing, {}, tick_s}, {}});
  scene.clock = scene::ClockKind::kRealtime;
  scene.speed = options.speedup;
  return scene;
}

int run(Options options) {
  const auto token = protocol::read_token_file(options.arm_token_file, protocol::Role::kController);
  mirror::Mirror mirror({options.primary, options.shadow}, options.part, {token, options.arm_tls});
  mirror.bounds() = options.bounds;
  cycle::Simulation simulation(scene_of(mirror, options), [&](const std::string& kind,
                                                              const hwparts::PartContext& context) {
    return kind == "arm" ? mirror::make_mirrored_arm(mirror) : mirror::make_divergence(mirror, context.name);
  });
  options.of_daemon.program = "visum-mirror";
  options.of_daemon.simulated = mirror.simulated();
  options.of_daemon.has_world = false;
  options.of_daemon.run_at_once = true;
  options.of_daemon.http = options.http.settled(options.of_daemon);
  options.of_daemon.show = [&](gateway::Published& published) { mirror.show_world(published); };
  options.of_daemon.wait = [&](std::chrono::steady_clock::time_point due) {
    do {
      mirror.pump();
      mirror.wait_until(due);
    } while (std::chrono::steady_clock::now() < due);
  };
  gateway::Daemon daemon(simulation, options.of_daemon);
  const int signal = programs::run_until_signal(daemon, simulation, options.of_daemon, options.output.json);
  spdlog::info("ended");
  return signal == SIGINT ? programs::kInterrupted : programs::kPassed;
}

void declare_arms(CLI::App& app, Options& options) {
  app.add_option("--primary", options.primary, "the arm that the controller sees")
      ->required()
      ->type_name("HOST:PORT");
  app.add_option("--shadow", options.shadow, "the arm that follows")->required()->type_name("HOST:PORT");
  app.add_option("--part", options.part, "the part's name, the same on both servers")->capture_default_str();
  app.add_option("--arm-token-file", options.arm_token_file,
                 "a file with the token for both servers, if they ask for one: the token alone, or lines of "
                 "\"ROLE TOKEN\"");
  const auto add_tls = [&](const char* name, std::string& file, const char* help, const char* variable) {
    app.add_option(name, file, help)->type_name("FILE")->envname(variable);
  };
  add_tls("--arm-tls-ca", options.arm_tls.authority,
          "TLS to both arms: the authority that signed their certificates (PEM)", "VISUM_TLS_CA");
  add_tls("--arm-tls-cert", options.arm_tls.certificate, "TLS to both arms: our certificate (PEM)",
          "VISUM_TLS_CERT");
  add_tls("--arm-tls-key", options.arm_tls.key, "TLS to both arms: our private key (PEM)", "VISUM_TLS_KEY");
}

void declare(CLI::App& app, Options& options) {
  declare_arms(app, options);
  app.add_option("--angle-limit", options.bounds.angle_limit_rad,
                 "halt both arms when they are more than this apart, in rad; 0: never")
      ->capture_default_str()
      ->check(CLI::Range(0.0, 1e3));
  app.add_option("--position-limit", options.bounds.position_limit_m,
                 "halt both arms when they are more than this apart, in m; 0: never")
      ->capture_default_str()
      ->check(CLI::Range(0.0, 1e3));
  programs::declare_common(app, options.of_daemon, options.output);
  programs::declare_http(app, options.of_daemon, options.http);
  app.add_option("--speedup", options.speedup, "how much faster than the wall clock the arms' time runs")
      ->capture_default_str()
      ->check(CLI::Range(1e-3, 1e3));
  command_line::add_version(app);
  app.footer(
      "Typically the primary is the real arm, and the virtual arm is its shadow. The part arm_divergence "
      "says "
      "how far the two are apart; its parameters switch the primary and set the limits. The page shows the "
      "world of the primary, or of the shadow if only the shadow has one, and the other arm as a ghost.\n"
      "Example:\n"
      "  visum mirror --primary 127.0.0.1:1501 --shadow 127.0.0.1:1500 --port 1502\n"
      "Exit codes: 0 ended in good order, 2 bad usage or an arm that cannot be reached, 130 interrupted.");
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  const auto name = command_line::typed_name(argv[0], "mirror", "visum-mirror");
  CLI::App app{"Serves a part once more, with two arms behind it", name};
  declare(app, options);
  return programs::run_command(app, {argc, argv, name}, "visum-mirror", options.output,
                               [&] { return run(options); });
}
