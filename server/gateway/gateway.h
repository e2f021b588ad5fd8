// The sessions' side: what each request of the port protocol means. Checks at the edge, keeps leases and
// memberships, answers from a published copy of the world, and hands the rest to the tick's side through the
// mailbox. Lives on the sessions' thread (protocol::Server's), never touches the simulation.
#pragma once

#include <atomic>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "protocol/server.h"
#include "server/bus/cycle_gate.h"
#include "server/cycle/pacer.h"
#include "server/gateway/access.h"
#include "server/gateway/late_writes.h"
#include "server/gateway/leases.h"
#include "server/gateway/mailbox.h"
#include "server/gateway/members.h"
#include "server/gateway/metrics.h"
#include "server/gateway/published.h"
#include "server/gateway/stuck_node.h"
#include "server/gateway/world_view.h"

namespace visum::gateway {

// What the sessions' side knows of the world for as long as it stands.
struct StaticWorld {
  std::string scene;
  scene::ClockKind clock = scene::ClockKind::kRealtime;
  std::int64_t tick_ns = 1'000'000;
  std::chrono::nanoseconds lockstep_timeout{};
  std::vector<const hwparts::Part*> parts;  // only their const, any-thread functions are used
  std::vector<std::string> agents;          // by part: the scene's agent that commands it; empty: none
  WorldView view;
  bool simulated = true;
  bool has_world = true;                    // false: see DaemonOptions
  std::string steering_part{};              // of a recording that is shown; empty: the world lives
  std::function<StuckNode()> stuck_node{};  // empty: plug-ins are not watched
};
StaticWorld static_world(const cycle::Simulation& simulation);

class Gateway : public protocol::SessionHandler {
 public:
  // `latest` gives the newest published copy, which stays as it is until the next call of it; `pacer` is read
  // for its counters only.
  using Latest = std::function<const Published&()>;
  Gateway(StaticWorld world, Tokens tokens, Mailbox& mailbox, const cycle::Pacer& pacer, Latest latest);

  // SessionHandler
  protocol::Role on_hello(protocol::Session& session, const protocol::Hello& hello,
                          protocol::Welcome& welcome, protocol::Error& refusal) override;
  void on_request(protocol::Session& session, std::uint64_t id, const protocol::Request& request) override;
  void on_close(protocol::Session& session, protocol::CloseReason reason) override;
  void on_notify() override { serve(); }
  void on_room(protocol::Session& session) override;

  // Sends what is due: commands' replies, answers to Advance, samples, events. After every tick, or when
  // notified.
  void serve();
  // The earliest tick at which serve() has something to send; int64's maximum: none. Any thread.
  std::int64_t next_due() const { return next_due_.load(std::memory_order_relaxed); }
  // True once a member stepped: time starts. Any thread.
  bool start_asked() const { return start_asked_.load(std::memory_order_relaxed); }
  // Lockstep: whether the world may go on from `tick`. One that nobody steps with only moves by Step, or for
  // who was late and goes on in real time.
  bool lets(std::int64_t tick, bool stepping) const {
    return members_.empty() ? stepping || has_dropped() : members_.limit() > tick;
  }
  // Lockstep: somebody who was late goes on in real time, and the world with him.
  bool has_dropped() const { return !dropped_.empty(); }
  // What time-outs of members are measured by, instead of the steady clock. Before the first session.
  void use_clock(std::function<Member::Clock::time_point()> clock) { clock_ = std::move(clock); }
  // Lockstep, while the world waits at `tick`: drops a member that is waited for too long.
  void check_timeouts(std::int64_t tick);
  // Lockstep, while time stands, by a pause or a fault: no member is waited for.
  void end_waits() { members_.end_waits(); }
  // True once a client asked for Shutdown. Any thread.
  bool shutdown_asked() const { return shutdown_asked_.load(std::memory_order_relaxed); }
  // The parts' buses, for Status. Before the first session.
  void name_buses(std::vector<protocol::PartBus> buses) { buses_ = std::move(buses); }
  // The buses as members see them who follow what is said there: see Buses. Before the first session.
  struct BusDoor {
    std::function<void(const std::vector<protocol::Stream>&)> settle;
    std::function<std::uint64_t()> said;
    std::function<void(std::vector<protocol::Stream>&)> fill_in;
    std::function<void(std::uint32_t, bus::CycleRule)> open_gate;
    std::function<void(std::uint32_t)> close_gate;
    std::function<std::int64_t(std::uint32_t)> granted_tick;
  };
  void open_buses(BusDoor door) { bus_door_ = std::move(door); }
  // Lockstep and free, before each tick: writes that were put together go to the mailbox. True: some did.
  bool complete_writes();
  // Lockstep, before each tick: settles the buses for members that ask for it, and stops the world here, at
  // `tick`, for those whose program was told something. True: serve() has answers to send.
  bool follow_buses(std::int64_t tick);
  // What is counted and measured, for /metrics; `refused_connections` is the server's.
  Metrics metrics();
  bool lets_in(const std::string& token, const std::string& identity, protocol::Role role) const {
    return tokens_.grant(token, identity, role) != protocol::Role::kUnspecified;
  }
  // The next serve() tells everybody that the server ends. Any thread.
  void end() { ending_ = true; }

 private:
  struct Subscription {
    std::uint32_t stream = 0;  // part's number, or kWorldStream
    std::int64_t every = 1;
    std::int64_t next_tick = 0;
    std::uint64_t conflated = 0;
  };
  struct Client {
    protocol::Session* session = nullptr;
    std::vector<Subscription> subscriptions;
    std::int64_t peaks_from = 0;     // tick of its previous world sample
    std::int64_t counted_tick = -1;  // inputs per tick
    int inputs_at_tick = 0;
    // A session's requests are answered in order: while one waits for the tick's side, or replies wait to be
    // written, those behind it wait too.
    bool waiting = false;
    std::optional<std::int64_t> step_until;  // a gate holds the first of the backlog until this tick
    std::deque<std::pair<std::uint64_t, protocol::Request>> backlog;
  };
  static constexpr std::uint32_t kWorldStream = 0xFFFFFFFF;
  static constexpr int kMaxInputsPerTick = 8;  // of a session, in realtime
  static constexpr int kMaxSingleWrites = 64;  // of a session, with the other clocks; those behind: together
  static constexpr std::size_t kMaxBacklog = 64;
  static constexpr const char* kTooManyInputs = "too many inputs wait for the next tick";

  // A request in hand: how to answer it.
  struct Call {
    protocol::Session& session;
    Client& client;
    std::uint64_t id;
    std::uint64_t& refused;
    void reply(const protocol::Reply& reply) const;
    void fail(protocol::ErrorCode code, const std::string& text, const std::string& owner = {}) const;
  };

  // parts (part_requests.cc)
  void handle(const Call& call, const protocol::ListParts&);
  void handle(const Call& call, const protocol::DescribePart& request);
  void handle(const Call& call, const protocol::AcquireLease& request);
  void handle(const Call& call, const protocol::ReleaseLease& request);
  void handle(const Call& call, const protocol::Write& request);
  void handle(const Call& call, const protocol::Read& request);
  void handle(const Call& call, const protocol::Subscribe& request);
  void handle(const Call& call, const protocol::Unsubscribe& request);
  void handle(const Call& call, const protocol::GetParameters& request);
  void handle(const Call& call, const protocol::SetParameter& request);
  void handle(const Call& call, const protocol::ReadBlackboard& request);
  void handle(const Call& call, const protocol::WriteBlackboard& request);
  // lockstep (lockstep_requests.cc)
  void handle(const Call& call, const protocol::Join& request);
  void handle(const Call& call, const protocol::Advance& request);
  void handle(const Call& call, const protocol::Leave&);
  void handle(const Call& call, const protocol::Note& request);
  // time (time_requests.cc)
  void handle(const Call& call, const protocol::Hello&);
  void handle(const Call& call, const protocol::Status&);
  void handle(const Call& call, const protocol::Pause& request);
  void handle(const Call& call, const protocol::Resume& request);
  void handle(const Call& call, const protocol::Step& request);
  void handle(const Call& call, const protocol::SetSpeed& request);
  void handle(const Call& call, const protocol::Reset& request);
  void handle(const Call& call, const protocol::TakeSnapshot& request);
  void handle(const Call& call, const protocol::RestoreSnapshot& request);
  void handle(const Call& call, const protocol::Shutdown&);
  // world (world_requests.cc)
  void handle(const Call& call, const protocol::DescribeWorld&);
  void handle(const Call& call, const protocol::ReadWorld&);
  void handle(const Call& call, const protocol::SubscribeWorld& request);
  void handle(const Call& call, const protocol::UnsubscribeWorld&);
  void handle(const Call& call, const protocol::ReadMesh& request);
  void handle(const Call& call, const protocol::ReadTexture& request);
  void handle(const Call& call, const protocol::PushBody& request);
  void handle(const Call& call, const protocol::AddBody& request);
  void handle(const Call& call, const protocol::RemoveBody& request);

  // faults (fault_requests.cc)
  void handle(const Call& call, const protocol::InjectFault& request);
  void handle(const Call& call, const protocol::ClearFault& request);
  void handle(const Call& call, const protocol::ListFaults& request);

  std::optional<std::uint32_t> part_or_fail(const Call& call, const std::string& name) const;
  bool blackboard_or_fail(const Call& call, std::uint32_t part, const std::string& name, bool to_write) const;
  bool lease_or_fail(const Call& call, std::uint32_t part) const;
  std::optional<std::string> why_not(std::uint32_t part, const hwparts::Fault& fault) const;
  // As many as a tick takes one by one of a session.
  bool has_sent_enough(Client& client) const;
  Input* input_or_fail(const Call& call);
  Input* blank_input_or_fail(const Call& call, bool urgent = false);
  void send_write(std::uint32_t part, std::uint32_t first_port, std::uint32_t end_port, Input* input);
  void send_late_writes();                    // as many as the next tick takes
  bool send_late_writes(std::uint32_t part);  // all of them; false where too much waits for the tick already
  bool late_writes_sent_or_fail(const Call& call, std::uint32_t part);
  void end_late_writes(std::uint32_t part);  // its lease or its era ends
  std::int64_t to_ticks(std::int64_t ns) const { return ns / world_.tick_ns + (ns % world_.tick_ns != 0); }
  static std::uint64_t order_of(const Call& call);  // among inputs that need no lease
  // grade L1 (gates.cc)
  std::string fault_of_gate(const protocol::Gate& gate) const;
  void open_gate(Member& member, const protocol::Gate& gate);
  void follow_gate(Member& member);
  void leave(std::uint64_t session);
  Member* gate_of(const Client& client);
  bool is_gated(const Client& client) const;
  bool holds(Client& client, std::uint64_t id, const protocol::Request& request);
  void hold_no_longer(Client& client);
  void release(Client& client);
  void stop_part(std::uint32_t part);

  void send_command(const Call& call, const protocol::Request& request, std::uint32_t part = 0);
  void subscribe(const Call& call, std::uint32_t stream, std::uint32_t every);
  void unsubscribe(const Call& call, std::uint32_t stream);
  std::optional<std::string> why_not(std::uint32_t part, const protocol::Write& request,
                                     std::vector<double>& wanted) const;
  void lose_lease(std::uint32_t part, const std::string& why);
  void lose_parts_of(std::uint64_t session, const std::string& why);
  void send_samples(const Published& now);
  void send_sample(Client& client, Subscription& subscription, const Published& now);
  void answer_advances(const Published& now);
  void take_commands();
  void finish_commands();
  void tell_notices();
  void tell_missed_deadline(const Notice& notice);
  void follow_eras(const Published& now);
  void follow_shown_world(const Published& now);
  protocol::PartSample part_sample(std::uint32_t part, const Published& now) const;
  protocol::WorldSample world_sample(Client& client, const Published& now) const;
  protocol::ServerStatus server_status(const Published& now) const;
  protocol::PartList part_list() const;
  void broadcast(const protocol::Event& event);
  void note_due();
  void dispatch(Client& client, std::uint64_t id, const protocol::Request& request);
  void work_off_backlogs();
  void work_off(Client& client);
  void work_off_at_goodbye(Client& client);
  void answer(Member& member, const Published& now);
  protocol::Advanced advanced(const Member& member, const Published& now);
  void end_advances(std::int64_t tick, const std::string& why);
  bool was_told_more(const Follows& follows);

  StaticWorld world_;
  Tokens tokens_;
  Mailbox& mailbox_;
  const cycle::Pacer& pacer_;
  Latest latest_;
  std::function<Member::Clock::time_point()> clock_ = Member::Clock::now;
  const Published* now_ = nullptr;  // the copy in use: taken anew at the start of each call from outside
  Leases leases_;
  Members members_;
  std::map<std::uint64_t, Client> clients_;   // by session
  std::vector<std::vector<double>> latched_;  // by part: controller inputs as last accepted
  LateWrites late_;
  // When a part was told last that its controller is gone.
  struct Stop {
    std::int64_t tick = -1;
    std::uint64_t commands = 0, epoch = 0;
    bool operator==(const Stop&) const = default;
  };
  std::vector<Stop> stops_;  // by part
  std::uint64_t commands_sent_ = 0;
  std::vector<std::unique_ptr<Command>> done_;  // came back, to be answered
  std::vector<protocol::PartBus> buses_;
  BusDoor bus_door_{[](const auto&) {}, [] { return std::uint64_t{0}; },     [](auto&) {}, [](auto, auto) {},
                    [](auto) {},        [](auto) { return std::int64_t{0}; }};
  std::set<std::uint64_t> dropped_;         // sessions that were late and go on
  std::shared_ptr<const WorldView> shown_;  // what world_.view was copied from, where it is another server's
  std::uint64_t era_ = 1;
  bool frozen_ = false;
  std::atomic<bool> start_asked_{false};
  std::atomic<bool> shutdown_asked_{false};
  std::atomic<bool> ending_{false};
  std::atomic<std::int64_t> next_due_{0};
  std::uint64_t refused_ = 0;
  std::uint64_t lease_losses_ = 0;
  std::uint64_t freezes_ = 0;
};

}  // namespace visum::gateway
