#include <chrono>
#include <cstdio>
#include <optional>
#include <utility>

#include "clients/visum/common/exit_code.h"
#include "clients/visum/common/format.h"
#include "clients/visum/common/interrupt.h"
#include "clients/visum/common/json_writer.h"
#include "clients/visum/verbs/verbs.h"
#include "protocol/command_line/one_of.h"
#include "protocol/config/printable.h"

namespace visum::cli {
namespace {

using protocol::ScenarioState;
using protocol::ScenarioVerdict;

void print_json(const ScenarioState& state) {
  JsonWriter json;
  json.begin_object().member("name", state.name).member("running", state.running).key("verdict");
  const bool judged = state.verdict != ScenarioVerdict::kUnspecified;
  judged ? json.value(protocol::to_string(state.verdict)) : json.null();
  json.key("exit_code");
  judged ? json.value(state.exit_code) : json.null();
  json.member("text", state.text).key("checks").begin_array();
  for (const auto& check : state.checks)
    json.begin_object()
        .member("check", check.name)
        .member("passed", check.passed)
        .member("text", check.text)
        .end_object();
  json.end_array().member("state_hash", hex(state.state_hash));
  std::puts(json.end_object().text().c_str());
}

void print(const ScenarioState& state) {
  if (state.name.empty()) {
    std::puts("no scenario has run");
    return;
  }
  std::printf("%s: %s\n", state.name.c_str(),
              state.running ? "runs" : (protocol::to_string(state.verdict) + (", " + state.text)).c_str());
  for (const auto& check : state.checks)
    std::printf("  %s  %s: %s\n", check.passed ? "passed" : "FAILED", config::printable(check.name).c_str(),
                config::printable(check.text).c_str());
  if (state.state_hash != 0) std::printf("  state hash %s\n", hex(state.state_hash).c_str());
}

class ScenarioVerb : public Verb {
 public:
  void declare(CLI::App& app) override {
    app.add_option("WHAT", what_, "start, stop or status")
        ->required()
        ->check(command_line::one_of({"start", "stop", "status"}));
    app.add_option("NAME", name_, "start: a scenario of the server's installation, such as pick_and_place");
    app.add_option("--timeout", timeout_s_,
                   "start: seconds of wall time after which the server ends it; default: an hour")
        ->check(number_within(1.0, 86'400.0));
    app.add_flag(
        "--wait", wait_,
        "start: show its lines and checks until it ends, and exit with its exit code; Ctrl-C stops it");
    add_link_options(app, link_);
    app.footer(
        "Lets a server run a scenario of its installation, beside its own world. The scenario has a world of "
        "its own, as with `visum run`, and the server tells as events what happens in it (`visum events "
        "--follow`). One scenario runs at a time. Starting and stopping need the role admin.\n"
        "Exit codes with --wait: those of `visum run`.\n\nExamples:\n"
        "  visum scenario start pick_and_place --wait\n"
        "  visum scenario start mobile_arm --timeout 600\n"
        "  visum scenario status --json\n  visum scenario stop");
  }

  int run() override {
    const bool starts = what_ == "start";
    if (starts == name_.empty())
      throw ExitError(kUsage, starts ? "which scenario? visum scenario start NAME"
                                     : what_ + " takes no name: one scenario runs at a time");
    if (!starts && (wait_ || timeout_s_ > 0.0))
      throw ExitError(kUsage, "--wait and --timeout are for `visum scenario start`");
    auto link = open_link(link_, what_ == "status" ? protocol::Role::kObserver : protocol::Role::kAdmin);
    if (what_ == "stop") link.request(protocol::StopScenario{});
    if (what_ == "status") show(link.request_as<ScenarioState>(protocol::ReadScenario{}));
    return starts ? start(link) : kDone;
  }

 private:
  void show(const ScenarioState& state) const { link_.json ? print_json(state) : print(state); }

  int start(protocol::Connection& link) const {
    if (wait_) {
      catch_interrupts();
      link.request(protocol::SubscribeEvents{});
    }
    link.request(protocol::RunScenario{name_, static_cast<std::int64_t>(timeout_s_ * 1e9)});
    return wait_ ? follow(link) : kDone;
  }

  // Until it has ended. The server bounds that.
  int follow(protocol::Connection& link) const {
    bool stopped = false;
    auto state = link.request_as<ScenarioState>(protocol::ReadScenario{});
    while (state.running) {
      if (interrupted() && !std::exchange(stopped, true)) link.request(protocol::StopScenario{});
      tell(link.next(std::chrono::milliseconds(100)));
      state = link.request_as<ScenarioState>(protocol::ReadScenario{});
    }
    while (const auto last = link.next_kept()) tell(last);
    show(state);
    return state.exit_code;
  }

  void tell(const std::optional<protocol::Reply>& message) const {
    const auto* event = message ? std::get_if<protocol::Event>(&*message) : nullptr;
    if (event && event->source == name_ && event->kind != "scenario")
      std::fprintf(stderr, "%s\n", config::printable(event->text).c_str());
  }

  LinkOptions link_;
  std::string what_, name_;
  double timeout_s_ = 0.0;
  bool wait_ = false;
};

}  // namespace

std::unique_ptr<Verb> make_scenario() {
  return std::make_unique<ScenarioVerb>();
}

}  // namespace visum::cli
