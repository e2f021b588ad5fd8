// visum-bridge-finroc: shows a server's parts to Finroc's tools, finstruct and fingui. `visum bridge finroc`
// starts it.
#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <exception>
#include <optional>

#include "clients/bridges/common/options.h"
#include "clients/bridges/common/peer_loop.h"
#include "clients/bridges/common/plant.h"
#include "clients/bridges/finroc/mapping.h"
#include "clients/bridges/finroc/session.h"
#include "clients/visum/common/exit_code.h"
#include "clients/visum/common/interrupt.h"
#include "protocol/command_line/output.h"
#include "protocol/command_line/parse.h"

namespace {

using namespace visum;

constexpr std::uint16_t kUsualPort = 4444;
constexpr std::chrono::milliseconds kMostOften{10}, kIdle{500};

int serve(const bridge::Options& options) {
  spdlog::set_default_logger(spdlog::stderr_logger_mt("finroc"));  // standard output is for the ready line
  bridge::check_address(options, "Finroc");
  bridge::Plant plant(options.connect, options.client("finroc"));
  std::optional<bridge::Cycle> cycle;
  if (options.lockstep) cycle.emplace(plant, std::llround(options.period_ms * 1e6), options.gates);
  finroc::Board board;
  finroc::Mapping mapping(plant, board, cycle ? &*cycle : nullptr);
  bridge::Door door(options.listen, options.port, kUsualPort);
  const finroc::Greeting own{"visum-" + std::to_string(door.port()),
                             door.port(),
                             1,
                             "Visum: " + plant.client().server().scene,
                             finroc::Structure::kNone,
                             0};
  bridge::PeerLoop loop(door,
                        [&](const std::string&) { return std::make_unique<finroc::Session>(board, own); });
  cli::catch_interrupts();
  bridge::print_ready(options, "finroc", door.port(), plant.names());
  auto refresh_at = bridge::Clock::now();
  while (!cli::interrupted()) {
    // Twice as often as values are wanted, so that none is late by a whole interval.
    const auto every = std::clamp(loop.follows_every() / 2, kMostOften, kIdle);
    const bool running = cycle && cycle->is_running();
    refresh_at = std::min(refresh_at, bridge::Clock::now() + every);  // a peer may have asked for more
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(refresh_at - bridge::Clock::now());
    loop.wait(running ? std::chrono::milliseconds(0) : std::max(left, std::chrono::milliseconds(0)));
    const auto now = bridge::Clock::now();
    const bool news = cycle && cycle->work();
    // Also while nobody follows: a lost server must end the bridge. While the world runs its period, the
    // server answers nothing else.
    if (news || (now >= refresh_at && !(cycle && cycle->is_running()))) {
      mapping.refresh(now);
      refresh_at = std::max(refresh_at + every, now);
    }
    loop.send(now);
  }
  return cli::kInterrupted;
}

int complain(int code, const char* text) {
  std::fprintf(stderr, "visum bridge finroc: %s\n", text);
  return code;
}

int act(int argc, char** argv) {
  bridge::Options options;
  CLI::App app{"Shows a server's parts to Finroc's tools, finstruct and fingui",
               command_line::typed_name(argv[0], "bridge finroc", "visum-bridge-finroc")};
  bridge::declare(app, options, "Finroc");
  command_line::add_version(app);
  app.footer(
      "Finroc is the public successor of MCA2: finstruct is what became of mcabrowser, fingui of mcagui. "
      "Connect them to the port that the ready line names.\n\n"
      "Example:\n  visumd models/scenes/amtec_arm.yaml &\n  visum bridge finroc\n\n"
      "Exit codes: 1 the server refused, 2 bad usage or the port is taken, 4 the connection to the server "
      "was "
      "lost, 130 interrupted.");
  if (const auto code = command_line::parse(app, argc, argv)) return *code;
  try {
    return serve(options);
  } catch (const cli::ExitError& error) {
    return complain(error.code(), error.what());
  } catch (const Error& error) {
    const bool usage = error.code() == ErrorCode::kMisuse;
    const bool lost = error.code() == ErrorCode::kConnection;
    return complain(usage ? cli::kUsage : lost ? cli::kLost : cli::kFailed, error.what());
  } catch (const std::exception& error) {
    return complain(cli::kFailed, error.what());
  }
}

}  // namespace

int main(int argc, char** argv) {
  return visum::command_line::finish("visum bridge finroc", act(argc, argv));
}
