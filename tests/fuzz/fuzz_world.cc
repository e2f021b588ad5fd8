// Any bytes as requests of four sessions to a gateway with a real world behind it, and ticks between them.
// Models come and go, bodies are pulled, put elsewhere, broken and taken back. Whatever comes, the sessions
// are answered as the protocol says, the world stays finite or freezes, a snapshot restores it to the bit,
// and a fresh world that takes the same inputs ends with the same bits.
//
// An input: a byte that chooses the clock, then steps. The two low bits of a step's first byte name the
// session (world_input.h), the next two what it is: a request, with its length in two bytes; ticks; or the
// session ends and comes back. There are no sockets. The one thread, which reads bodies and models, is waited
// for before anything else happens.
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <filesystem>
#include <memory>
#include <semaphore>
#include <vector>

#include "protocol/codec.h"
#include "protocol/recording/records.h"
#include "protocol/session_core.h"
#include "server/cycle/apply_input.h"
#include "server/gateway/gateway.h"
#include "server/gateway/tick_side.h"
#include "server/recording/archive.h"
#include "server/scene/scene.h"
#include "tests/fuzz/answering.h"
#include "tests/fuzz/world_input.h"

namespace {

using namespace visum;
using scene::ClockKind;
using testing::fail;
using testing::WorldStep;

constexpr int kMostSteps = 64, kMostTicks = 200;
constexpr std::chrono::seconds kPatience{60};  // with the thread that reads models

std::filesystem::path folder_of_files() {
  return std::filesystem::temp_directory_path() / ("visum_fuzz_world_" + std::to_string(::getpid()));
}

scene::Scene scene_with(ClockKind clock) {
  static const auto loaded =
      scene::load_scene(std::filesystem::path(VISUM_SOURCE_DIR) / "tests/fuzz/world/scenes/fuzz_world.yaml");
  auto scene = loaded;
  scene.clock = clock;
  return scene;
}

// Everything that a world took, in order, as a recording holds it.
struct Course final : cycle::Observer {
  void took(const recording::TimedInput& input) override { encode(input, steps.emplace_back()); }
  void ticked() override { steps.emplace_back(); }

  std::vector<std::vector<std::byte>> steps;  // empty: a tick
};

class WorldSession final : public protocol::SessionCore {
 public:
  using SessionCore::SessionCore;

  void feed(std::span<const std::byte> bytes) {
    while (!bytes.empty() && !closing()) {
      const auto space = room();
      const auto count = std::min(space.size(), bytes.size());
      if (count == 0) return;
      std::copy_n(bytes.begin(), count, space.begin());
      in().commit(count);
      bytes = bytes.subspan(count);
      while (handle_frames() == Appetite::kTurn) flush();
    }
    settle();
  }
  void leave(bool in_good_order) {
    in_good_order ? peer_closed() : close(protocol::CloseReason::kLost);
    settle();
  }
  void settle() {
    flush();
    tell_room();
    tell_closed();
  }
  void asked(std::uint64_t id) { open_ += id != 0; }

  void send(std::uint64_t reply_to, const protocol::Reply& reply) override {
    const bool answers = reply_to != 0 && !std::holds_alternative<protocol::Welcome>(reply);
    if (answers && open_-- == 0) fail("an answer that nobody asked for");
    SessionCore::send(reply_to, reply);
  }
  // An exception of the handler ends up here, and closes the session.
  void log(protocol::LogLevel level, const std::string& text) override {
    if (level == protocol::LogLevel::kError) fail(text.c_str());
    SessionCore::log(level, text);
  }

 private:
  void wake() override {}
  void flush() override {
    while (!out().empty()) out().written(out().front().size());
  }

  std::uint64_t open_ = 0;  // requests with a number that have no answer yet
};

// Counts the requests on their way to the gateway.
class Judge final : public protocol::SessionHandler {
 public:
  explicit Judge(gateway::Gateway& judged) : judged_(judged) {}
  protocol::Role on_hello(protocol::Session& session, const protocol::Hello& hello,
                          protocol::Welcome& welcome, protocol::Error& refusal) override {
    return judged_.on_hello(session, hello, welcome, refusal);
  }
  void on_request(protocol::Session& session, std::uint64_t id, const protocol::Request& request) override {
    static_cast<WorldSession&>(session).asked(id);
    judged_.on_request(session, id, request);
  }
  void on_close(protocol::Session& session, protocol::CloseReason reason) override {
    judged_.on_close(session, reason);
  }
  void on_notify() override {}
  void on_room(protocol::Session& session) override { judged_.on_room(session); }

 private:
  gateway::Gateway& judged_;
};

class World {
 public:
  explicit World(ClockKind clock)
      : simulation_(scene_with(clock)),
        archive_(folder_of_files(), origin_),
        mailbox_(64),
        tick_side_(simulation_, mailbox_, false, &archive_),
        gateway_(static_world(), {}, mailbox_, tick_side_.stops(), tick_side_.pacer(),
                 [this]() -> const gateway::Published& { return copy_; }),
        judge_(gateway_) {
    simulation_.set_observer(&course_);
    tick_side_.serve_models(models(), {});
    tick_side_.on_change_ready([this] { ready_.release(); });
    const auto steady = [this] { return gateway::Member::Clock::time_point(context_.now); };
    gateway_.lockstep().use_clock(steady);
    gateway_.clients().use_clock(steady);
    publish();
    for (std::size_t i = 0; i < sessions_.size(); ++i) connect(i);
  }
  ~World() {
    tick_side_.end_changes();
    simulation_.set_observer(nullptr);
  }
  World(const World&) = delete;
  World& operator=(const World&) = delete;

  void take(const WorldStep& step) {
    context_.now += std::chrono::milliseconds(1);
    auto& session = *sessions_[step.session];
    switch (step.kind) {
      case WorldStep::Kind::kRequest:
        session.feed(step.frame);
        settle();
        if (session.closing()) connect(step.session);
        break;
      case WorldStep::Kind::kTicks:
        for (int i = 0; i < step.ticks && ticks_ < kMostTicks; ++i) tick();
        break;
      case WorldStep::Kind::kLeave:
        session.leave(step.in_good_order);
        settle();
        connect(step.session);
        break;
    }
  }

  // To be called at the end. Nothing may come afterwards.
  void judge() {
    for (auto& session : sessions_) session->leave(true);
    settle();
    simulation_.set_observer(nullptr);
    std::string offender;
    if (!simulation_.frozen() && !world::is_sane(simulation_.model(), simulation_.state(), &offender))
      fail(("a world goes on that is not sane: " + offender).c_str());
    compare_with_a_fresh_one();
    restore();
  }

 private:
  static std::filesystem::path models() {
    return std::filesystem::path(VISUM_SOURCE_DIR) / "tests/fuzz/world";
  }
  gateway::StaticWorld static_world() const {
    auto world = gateway::static_world(simulation_);
    world.models = models();
    world.server = "fuzz";
    return world;
  }

  void connect(std::size_t which) {
    sessions_[which] = std::make_unique<WorldSession>(context_, ++number_, "fuzz");
    std::vector<std::byte> hello;
    encode_request(1, testing::hello_of(which), hello);
    sessions_[which]->feed(hello);
  }

  void publish() {
    fill(copy_, simulation_, tick_side_.pace(), tick_side_.part_table());
    tick_side_.give_back();
  }
  // Both sides do what is there to be done, until the world stands.
  void settle() {
    tick_side_.empty_mailbox();
    while (tick_side_.change_under_way()) {
      if (!ready_.try_acquire_for(kPatience)) fail("a change of the bodies does not become ready");
      tick_side_.empty_mailbox();
    }
    publish();
    gateway_.serve();
    for (auto& session : sessions_)
      if (session) session->settle();
  }
  bool may_tick() {
    auto& lockstep = gateway_.lockstep();
    if (lockstep.start_asked()) tick_side_.start();
    if (!tick_side_.time_runs()) {
      lockstep.end_waits();
      return false;
    }
    if (simulation_.scene().clock != ClockKind::kLockstep) return true;
    return lockstep.lets(simulation_.tick_count(), tick_side_.stepping());
  }
  void tick() {
    ++ticks_;
    context_.now += std::chrono::milliseconds(1);
    if (may_tick()) {
      if (gateway_.complete_writes()) tick_side_.empty_mailbox();
      tick_side_.tick();
    }
    settle();
  }

  void compare_with_a_fresh_one() const {
    cycle::Simulation fresh(scene_with(ClockKind::kFree));
    recording::InputMessage message;
    for (const auto& step : course_.steps) {
      if (step.empty()) {
        fresh.tick();
        continue;
      }
      if (!message.decode(step)) fail("an input cannot be read again");
      if (const auto outcome = cycle::apply(fresh, message.input.input); !outcome.done())
        fail(("a fresh world refuses what the first one took: " + outcome.text()).c_str());
    }
    if (fresh.fault() != simulation_.fault()) fail("a fresh world freezes in another way");
    if (fresh.state_hash() != simulation_.state_hash())
      fail("a fresh world with the same inputs ends with other bits");
  }
  void go_back_to(std::uint64_t snapshot) {
    if (const auto outcome = simulation_.restore_snapshot(snapshot); !outcome.done())
      fail(("a snapshot is refused: " + outcome.text()).c_str());
  }
  // The first restore ends the pulls: whoever held them has let go.
  void restore() {
    if (simulation_.frozen()) return;
    const auto snapshot = simulation_.take_snapshot();
    std::array<std::uint64_t, 2> hashes{};
    go_back_to(snapshot);
    for (auto& hash : hashes) {
      for (int i = 0; i < 3; ++i) simulation_.tick();
      hash = simulation_.state_hash();
      go_back_to(snapshot);
    }
    if (hashes[0] != hashes[1]) fail("a restored world goes on with other bits");
  }

  cycle::Simulation simulation_;
  Course course_;
  const recording::Origin origin_{};
  recording::Archive archive_;
  gateway::Mailbox mailbox_;
  std::counting_semaphore<> ready_{0};
  gateway::TickSide tick_side_;
  gateway::Published copy_;
  gateway::Gateway gateway_;
  Judge judge_;
  const protocol::Limits limits_;
  protocol::SessionContext context_{limits_, judge_, {}, std::chrono::milliseconds(1)};
  std::array<std::unique_ptr<WorldSession>, testing::kWorldSessions> sessions_;
  std::uint64_t number_ = 0;
  int ticks_ = 0;
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const bool quiet = (spdlog::set_level(spdlog::level::off), true);
  static_cast<void>(quiet);
  if (size == 0) return 0;
  {
    testing::WorldSteps steps(std::as_bytes(std::span(data, size)).subspan(1));
    World world(static_cast<ClockKind>(data[0] % scene::kClockNames.size()));
    for (int taken = 0; taken < kMostSteps; ++taken) {
      const auto step = steps.next();
      if (!step) break;
      world.take(*step);
    }
    world.judge();
  }
  std::error_code none;
  std::filesystem::remove_all(folder_of_files(), none);
  return 0;
}
