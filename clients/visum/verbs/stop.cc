#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <cstdio>
#include <exception>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>
#include <thread>

#include "clients/visum/common/exit_code.h"
#include "clients/visum/common/json_writer.h"
#include "clients/visum/verbs/verbs.h"
#include "protocol/part_description.h"
#include "protocol/stop_call.h"

namespace visum::cli {
namespace {

using protocol::StopNews;
using protocol::StopRefusal;
using std::chrono::milliseconds;
using State = StopNews::State;

constexpr milliseconds kAlone{30};      // without an answer by then, a session is tried as well
constexpr milliseconds kAtMost{3'000};  // the whole wait

// Orders the stop by datagrams, on a thread of its own that ends with it, and after kAtMost.
class Order {
 public:
  Order(const std::string& host, std::uint16_t port, const std::string& part, const std::string& token)
      : thread_([=, this](const std::stop_token& end) { run(host, port, part, token, end); }) {}

  // The news so far: once the order has come as far as `state`, or further, or after `at_most`.
  StopNews await(State state, milliseconds at_most) {
    std::unique_lock lock(mutex_);
    changed_.wait_for(lock, at_most, [&] { return over_ || news_.state >= state; });
    return news_;
  }
  // Where the thread is done. Throws what the order threw.
  StopNews await_end() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return over_; });
    if (failure_) std::rethrow_exception(failure_);
    return news_;
  }

 private:
  void run(const std::string& host, std::uint16_t port, const std::string& part, const std::string& token,
           const std::stop_token& end) {
    std::exception_ptr failure;
    try {
      protocol::call_stop(
          host, port, part, token, kAtMost, [this](const StopNews& news) { tell(news); }, end);
    } catch (...) {
      failure = std::current_exception();
    }
    const std::lock_guard lock(mutex_);
    failure_ = failure;
    over_ = true;
    changed_.notify_all();
  }
  void tell(const StopNews& news) {
    const std::lock_guard lock(mutex_);
    news_ = news;
    changed_.notify_all();
  }

  std::mutex mutex_;
  std::condition_variable changed_;
  StopNews news_;
  std::exception_ptr failure_;
  bool over_ = false;
  std::jthread thread_;  // last: it uses the others
};

const char* text_of(StopRefusal why) {
  switch (why) {
    case StopRefusal::kProof:
      return "the token is missing or wrong; --token-file names a file with one";
    case StopRefusal::kBusy:
      return "stopped, but too many such orders wait for the tick to tell when";
    default:
      return "the server refused";
  }
}

class StopVerb : public Verb {
 public:
  void declare(CLI::App& app) override {
    app.add_option("PART", part_, "the part to stop; default: all parts");
    add_link_options(app, link_);
    app.footer(
        "Pulls the emergency stop. The order goes by UDP to the server's port, so that no other client can "
        "hold it up; a server that gives no answer there, or that knows its clients by certificates only, "
        "gets it in a session. Parts without an emergency stop stop as they do when their controller is "
        "lost.\n"
        "To release it: visum param-set PART \"Emergency Stop\" false\n\n"
        "Exit codes: 0 it has acted, or it is latched and acts at the end of a tick that takes long, during "
        "which nothing moves; 1 refused, 2 bad usage or no such part, 4 no answer.\n\n"
        "Examples:\n  visum stop\n  visum stop arm --connect lab:1500");
  }

  int run() override {
    // The role of the token does not matter: every client may stop parts.
    const auto token = read_token(link_, protocol::Role::kObserver);
    const auto [host, port] = server_of(link_);
    begun_ = Clock::now();
    Order order(host, port, part_, token);
    const auto first = order.await(State::kAnswered, kAlone);
    const bool needs_session = first.state == State::kRefused && first.refusal == StopRefusal::kSession;
    if (needs_session) std::fputs("this server takes stops in sessions only\n", stderr);
    if (needs_session || first.state == State::kSilent) {
      const auto problem = stop_in_session();
      if (problem.empty()) return 0;
      if (needs_session) throw ExitError(kLost, problem);
    }
    const auto state = order.await(State::kLatched, kAtMost).state;
    if (state == State::kLatched || state == State::kActed) print_latched();
    return report(order.await_end());
  }

 private:
  // Stops the parts in an ordinary session. Returns what was in the way, or "".
  std::string stop_in_session() try {
    auto session = open_link(link_, protocol::Role::kObserver);
    std::vector<std::string> parts{part_};
    if (part_.empty()) {
      parts.clear();
      for (const auto& part : session.request_as<protocol::PartList>(protocol::ListParts{}).parts)
        parts.push_back(part.name);
    }
    std::string without;
    std::int64_t acts_at = 0;
    for (const auto& part : parts) {
      const auto description = describe_part(session, part).description;
      if (!has_stop(description)) {
        if (!part_.empty() || !description.controller_inputs.empty()) without += " '" + part + "'";
        continue;
      }
      const auto done =
          session.request_as<protocol::Ok>(protocol::SetParameter{part, protocol::kEmergencyStop, true});
      acts_at = std::max(acts_at, done.acts_at_tick);
    }
    if (!without.empty()) return "no emergency stop, which a session could pull:" + without;
    print_latched();
    print("session", acts_at == 0, std::nullopt);
    return {};
  } catch (const protocol::RequestError& error) {
    return error.what();
  } catch (const protocol::ConnectionError& error) {
    return error.what();
  }

  static bool has_stop(const protocol::PartDescription& part) {
    return std::ranges::find(part.parameters, protocol::kEmergencyStop, &protocol::Parameter::name) !=
           part.parameters.end();
  }

  int report(const StopNews& news) const {
    switch (news.state) {
      case State::kSilent:
        throw ExitError(kLost, "no server at " + link_.connect + " answered");
      case State::kAnswered:
        throw ExitError(kLost, "the server at " + link_.connect + " did not confirm the stop");
      case State::kRefused:
        if (news.refusal == StopRefusal::kPart)
          throw ExitError(kUsage, "there is no part '" + part_ + "'; `visum parts` lists them");
        throw ExitError(kFailed, text_of(news.refusal));
      case State::kLatched:
      case State::kActed:
        const bool acted = news.state == State::kActed;
        print("datagram", acted, acted ? std::optional(news.tick) : std::nullopt);
    }
    return 0;
  }

  // At once, before it has acted.
  void print_latched() const {
    if (link_.json) return;
    const auto what = part_.empty() ? std::string("all parts") : "'" + part_ + "'";
    std::printf("latched: the emergency stop of %s\n", what.c_str());
    std::fflush(stdout);
  }

  // `tick`: at which it acted; none: not known.
  void print(const char* way, bool acted, std::optional<std::int64_t> tick) const {
    if (link_.json) {
      JsonWriter json;
      json.begin_object().member("part", part_).member("way", way).member("latched", true);
      json.member("acted", acted);
      if (tick) json.member("tick", *tick);
      json.member("took_ms", std::chrono::duration<double, std::milli>(Clock::now() - begun_).count());
      json.end_object();
      std::printf("%s\n", json.text().c_str());
      return;
    }
    if (tick)
      std::printf("acted at tick %lld\n", static_cast<long long>(*tick));
    else if (acted)
      std::puts("acted");
    else
      std::puts(
          "it acts at the end of the tick that the server is in, which takes long; nothing moves meanwhile");
  }

  using Clock = std::chrono::steady_clock;
  LinkOptions link_;
  std::string part_;
  Clock::time_point begun_;
};

}  // namespace

std::unique_ptr<Verb> make_stop() {
  return std::make_unique<StopVerb>();
}

}  // namespace visum::cli
