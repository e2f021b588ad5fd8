#include "tests/gateway/storm/storm.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

#include "server/gateway/gateway.h"
#include "server/gateway/tick_side.h"
#include "server/recording/recorder.h"
#include "server/scene/scene.h"
#include "tests/gateway/storm/client.h"
#include "tests/gateway/storm/wired_session.h"

namespace visum::storm {
namespace {

using gateway::Published;
using scene::ClockKind;

constexpr std::int64_t kSweepMs = 100;
constexpr std::int64_t kKeepaliveMs = 8000;  // after so long the kernel tells that a silent peer is gone
constexpr int kSettlingTurns = 20;

scene::Scene scene_with(ClockKind clock) {
  static const auto loaded =
      scene::load_scene(std::filesystem::path(VISUM_SOURCE_DIR) / "models/scenes/two_link.yaml");
  auto scene = loaded;
  scene.clock = clock;
  scene.lockstep_timeout_ns = 150'000'000;
  return scene;
}

struct Observers final : cycle::Observer {
  Observers(cycle::Observer* first, cycle::Observer* second) : all{first, second} {}
  void took(const recording::TimedInput& input) override {
    for (auto* one : all) one->took(input);
  }
  void ticked() override {
    for (auto* one : all) one->ticked();
  }
  std::array<cycle::Observer*, 2> all;
};

// One daemon, from its start to its end or crash.
class Server {
 public:
  Server(Dice& dice, ClockKind clock, std::int64_t now_ms, const std::filesystem::path& record)
      : dice_(dice),
        simulation_(scene_with(clock)),
        threaded_(clock == ClockKind::kRealtime),
        mailbox_(64),
        tick_side_(simulation_, mailbox_, false),
        gateway_(gateway::static_world(simulation_), {}, mailbox_, tick_side_.stops(), tick_side_.pacer(),
                 [this]() -> const Published& { return latest(); }),
        oracle_(gateway_, simulation_),
        born_ms_(now_ms) {
    const auto steady = [this] { return gateway::Member::Clock::time_point(context_.now); };
    gateway_.lockstep().use_clock(steady);
    gateway_.clients().use_clock(steady);
    if (!record.empty()) {
      recorder_.emplace(simulation_, recording::Origin{}, record);
      both_.emplace(&oracle_, &*recorder_);
      simulation_.set_observer(&*both_);
    }
    publish();
  }

  void accept(std::shared_ptr<Connection> connection, std::int64_t now_ms) {
    lines_.push_back({std::make_unique<WiredSession>(context_, oracle_, ++sessions_, connection), connection,
                      now_ms + kKeepaliveMs + dice_.within(0, kKeepaliveMs)});
  }

  // One millisecond: the work of both sides, in an order that two threads might have had.
  void turn(std::int64_t now_ms) {
    context_.now = std::chrono::milliseconds(now_ms - born_ms_);
    serve_sessions(now_ms);
    if (now_ms % kSweepMs == 0) sweep(now_ms);
    if (gateway_.lockstep().start_asked()) tick_side_.start();
    if (!threaded_) return turn_inline();
    // The tick's thread, and now and then the sessions' in the middle of it.
    empty_mailbox();
    if (published_version_ != tick_side_.version()) publish();
    if (tick_side_.time_runs()) {
      if (dice_.one_in(3)) serve_sessions(now_ms);
      if (dice_.one_in(2)) empty_mailbox();
      tick_side_.tick();
      if (dice_.one_in(3)) serve_sessions(now_ms);
      publish();
    }
    if (!dice_.one_in(10)) gateway_.serve();  // else its thread has not come to it yet
  }

  void settle(std::int64_t now_ms) {
    serve_sessions(now_ms);
    empty_mailbox();
    tick_side_.tick();
    publish();
    gateway_.serve();
  }

  Oracle& oracle() { return oracle_; }
  const cycle::Simulation& simulation() const { return simulation_; }
  void cut_all() {
    for (auto& line : lines_) line.connection->reset = true;
  }

 private:
  struct Line {
    std::unique_ptr<WiredSession> session;
    std::shared_ptr<Connection> connection;
    std::int64_t kept_alive_until_ms;
  };

  // As the daemon's inline loop does it (daemon_inline_loop.cc).
  void turn_inline() {
    const auto version = tick_side_.version();
    empty_mailbox();
    tick_side_.give_back();
    if (version != tick_side_.version()) gateway_.serve();
    if (may_tick()) {
      if (gateway_.complete_writes()) empty_mailbox();
      tick_side_.tick();
    }
    tick_side_.give_back();
    gateway_.serve();
  }
  bool may_tick() {
    if (!tick_side_.time_runs()) {
      gateway_.lockstep().end_waits();
      return false;
    }
    if (simulation_.scene().clock == ClockKind::kFree) return true;
    const auto tick = simulation_.tick_count();
    if (gateway_.lockstep().lets(tick, tick_side_.stepping())) return true;
    gateway_.check_timeouts(tick);
    return false;
  }

  void empty_mailbox() { oracle_.empty_mailbox(tick_side_); }

  void serve_sessions(std::int64_t now_ms) {
    std::vector<WiredSession*> order;
    for (auto& line : lines_) order.push_back(line.session.get());
    dice_.shuffle(order);
    for (auto* session : order) {
      session->turn(now_ms);
      session->tell_closed();
    }
    for (auto* session : order) session->tell_closed();  // those that another one's turn has closed
    std::erase_if(lines_, [](const Line& line) { return line.session->gone(); });
  }

  void sweep(std::int64_t now_ms) {
    for (auto& line : lines_) {
      line.session->sweep();
      if (now_ms > line.kept_alive_until_ms && line.connection.use_count() == 2) line.session->reset();
      line.session->tell_closed();
    }
  }

  void publish() {
    fill(copy_, simulation_, tick_side_.pace(), tick_side_.part_table());
    tick_side_.give_back();
    published_version_ = tick_side_.version();
  }
  const Published& latest() {
    if (!threaded_) fill(copy_, simulation_, tick_side_.pace(), tick_side_.part_table());
    return copy_;
  }

  Dice& dice_;
  cycle::Simulation simulation_;
  std::optional<recording::Recorder> recorder_;
  std::optional<Observers> both_;  // the oracle and the recorder
  const bool threaded_;
  gateway::Mailbox mailbox_;
  gateway::TickSide tick_side_;
  Published copy_;
  std::uint64_t published_version_ = 0;
  gateway::Gateway gateway_;
  Oracle oracle_;
  const protocol::Limits limits_;
  protocol::SessionContext context_{limits_, oracle_, {}, std::chrono::milliseconds(kSweepMs)};
  std::vector<Line> lines_;
  std::uint64_t sessions_ = 0;
  const std::int64_t born_ms_;
};

void add(Oracle::Counts& sum, const Oracle::Counts& more) {
  sum.requests += more.requests;
  sum.refused += more.refused;
  sum.writes += more.writes;
  sum.taken += more.taken;
  sum.losses += more.losses;
}

}  // namespace

Outcome run_storm(std::uint64_t seed, std::int64_t duration_ms, const std::filesystem::path& record) {
  Dice dice(seed);
  Outcome outcome;
  const auto clock = static_cast<ClockKind>(dice.below(scene::kClockNames.size()));
  const bool crashes = dice.one_in(4);
  std::optional<Server> server;
  std::vector<Client> clients;
  const auto note_end = [&] {
    auto& oracle = server->oracle();
    outcome.broken = oracle.broken();
    outcome.digest = outcome.digest * 31 + oracle.digest();
    outcome.ticks += server->simulation().tick_count();
    add(outcome.counts, oracle.counts());
  };
  const auto start = [&](std::int64_t now_ms) {
    server.emplace(dice, clock, now_ms, record);
    ++outcome.servers;
  };
  start(0);
  const auto description = server->simulation().parts()[0].part->description();
  for (int i = 0, count = 2 + static_cast<int>(dice.below(5)); i < count; ++i)
    clients.emplace_back(dice, i, description, [&](bool holds, const std::string& claim) {
      server->oracle().expect(holds, claim);
    });
  std::int64_t now_ms = 1;
  for (; now_ms <= duration_ms && server->oracle().broken().empty(); ++now_ms) {
    for (auto& client : clients) {
      if (auto connection = client.wants_connection()) server->accept(std::move(connection), now_ms);
      client.turn(now_ms);
    }
    server->turn(now_ms);
    if (!crashes || !dice.one_in(4000)) continue;
    server->cut_all();
    note_end();
    if (!outcome.broken.empty()) return outcome;
    for (auto& client : clients) client.server_died();
    start(now_ms);
  }
  for (auto& client : clients) client.leave();
  server->cut_all();
  for (int i = 0; i < kSettlingTurns; ++i) server->settle(now_ms++);
  server->oracle().settled();
  note_end();
  return outcome;
}

}  // namespace visum::storm
