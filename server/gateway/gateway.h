// Where the sessions of the port protocol meet the world: lets clients in, keeps the order of their requests,
// and hands each request to the class that handles its kind.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <string>

#include "protocol/config/profile.h"
#include "protocol/server.h"
#include "server/bus/bus_door.h"
#include "server/cycle/pacer.h"
#include "server/gateway/access.h"
#include "server/gateway/call.h"
#include "server/gateway/clients.h"
#include "server/gateway/commands.h"
#include "server/gateway/event_requests.h"
#include "server/gateway/fault_requests.h"
#include "server/gateway/holdup.h"
#include "server/gateway/input_limiter.h"
#include "server/gateway/lockstep.h"
#include "server/gateway/mailbox.h"
#include "server/gateway/metrics.h"
#include "server/gateway/module_requests.h"
#include "server/gateway/part_settings.h"
#include "server/gateway/parts.h"
#include "server/gateway/placing_requests.h"
#include "server/gateway/published.h"
#include "server/gateway/scenario_requests.h"
#include "server/gateway/scene_requests.h"
#include "server/gateway/server_requests.h"
#include "server/gateway/static_world.h"
#include "server/gateway/streams.h"
#include "server/gateway/time_control.h"
#include "server/gateway/world_requests.h"

namespace visum::gateway {

// Lives on the sessions' thread (protocol::Server's) and never touches the simulation. Reads are answered
// from a published copy of the world; everything that changes the world goes to the tick's thread through the
// mailbox. Nothing here throws because of a request: a bad one is answered with an error. The Daemon owns it.
class Gateway : public protocol::SessionHandler {
 public:
  // Gives the newest published copy, which stays as it is until the next call.
  using Latest = std::function<const Published&()>;
  // All references must outlive the gateway. Of `pacer` only the counters are read.
  Gateway(StaticWorld world, Tokens tokens, Mailbox& mailbox, StopLatch& stops, const cycle::Pacer& pacer,
          Latest latest, bus::BusDoor& buses = bus::NoBuses::instance(), LogTap* log = nullptr);

  // SessionHandler
  protocol::Role on_hello(protocol::Session& session, const protocol::Hello& hello,
                          protocol::Welcome& welcome, protocol::Error& refusal) override;
  void on_request(protocol::Session& session, std::uint64_t id, const protocol::Request& request) override;
  void on_close(protocol::Session& session, protocol::CloseReason reason) override;
  void on_notify() override { serve(); }
  void on_bytes() override {
    if (profile_ && !relieved_) profile_->enter(config::Profile::kGateway);
  }
  void on_room(protocol::Session& session) override;

  // Sends what is due: commands' replies, answers to Advance, samples, events. After every tick, or when
  // notified.
  void serve();
  // Shows the tick's side that the sessions' thread goes round, and acknowledges requests that a long tick
  // holds up. To be called every 50 ms or more often, and by whoever serves the sessions meanwhile.
  void beat();
  // The sessions' thread may have been stopped or starved; see Holdup. Writes that waited are refused.
  Holdup& holdup() { return holdup_; }
  // From now on (true) another thread serves the sessions, while the tick's thread does a tick that takes
  // long. Requests that change the world are latched for its end. Whatever belongs to a cycle waits.
  void relieve(bool begins) { relieved_ = begins; }
  // Lockstep and free: measures from now on when bytes came. Must outlive it.
  void set_profile(config::Profile* profile) { profile_ = profile; }
  // True if the log is to tell of so many limited ticks. Any thread.
  bool has_to_warn(std::uint64_t limited_ticks) const {
    return limited_ticks >= limits_warned_at_.load(std::memory_order_relaxed);
  }
  // The earliest tick at which serve() has something to send; int64's maximum: there is none. Any thread.
  std::int64_t next_due() const { return next_due_.load(std::memory_order_relaxed); }
  // For the daemon's loop, which asks it before each tick.
  Clients& clients() { return clients_; }
  Lockstep& lockstep() { return lockstep_; }
  const Lockstep& lockstep() const { return lockstep_; }
  // Lockstep, while the world waits at `tick`: drops a member that has been waited for too long.
  void check_timeouts(std::int64_t tick);
  // Lockstep and free, before each tick: late writes go to the mailbox. True: some did.
  bool complete_writes() { return parts_.complete_writes(); }
  // True once a client asked for Shutdown. Any thread.
  bool shutdown_asked() const { return server_.shutdown_asked(); }
  // The next serve() tells all clients that the server ends. Any thread.
  void end() { ending_ = true; }

  // For /metrics; the connections that the server refused are not in it.
  Metrics metrics();
  const Tokens& tokens() const { return tokens_; }
  // True if a token, or the name in a certificate, gives at least this role.
  bool lets_in(const std::string& token, const std::string& identity, protocol::Role role) const {
    return tokens_.grant(token, identity, role) != protocol::Role::kUnspecified;
  }

 private:
  // Takes the newest copy of the world, of which everything is answered until the next call from outside.
  void look_at_world();
  // Takes over the parts that the copy in use has, where models came or went.
  void follow_parts();
  // Hands the request to the class that handles it, unless the client may not ask for that.
  void dispatch(Client& client, std::uint64_t id, const protocol::Request& request);
  // True: a gate holds the request, at the head of the backlog, until the world has run its period.
  bool holds(Client& client, std::uint64_t id, const protocol::Request& request, std::size_t bytes);
  // True: this request waits until the tick is over.
  bool is_deferred(const Client& client, const protocol::Request& request) {
    return relieved_ && lockstep_.waits_for_tick(*client.session, request);
  }
  void say_that_it_ends();
  // Handles the request that a gate held, once the world is there or never will be.
  void release(Client& client);
  void work_off(Client& client);
  void work_off_backlogs();
  // Handles all that a client asked for before it left. Does not wait for commands, since the mailbox keeps
  // their order, nor for ticks to come.
  void work_off_at_goodbye(Client& client);
  void follow_eras();
  void finish_commands();
  void tell_notices();
  void tell_stop(const Notice& notice);
  void note_next_due();
  // Names in the log the bodies that fell short, in ticks whose work met a limit.
  void warn_of_limits();

  StaticWorld world_;
  const Tokens tokens_;
  Mailbox& mailbox_;
  const Latest latest_;
  const Published* now_ = nullptr;  // the copy in use; null: nothing has called from outside yet
  Clients clients_;
  InputLimiter limiter_;
  Holdup holdup_;
  Parts parts_;
  Commands commands_;
  Lockstep lockstep_;
  Streams streams_;
  PartSettings settings_;
  TimeControl time_;
  WorldRequests bodies_;
  PlacingRequests placing_;
  FaultRequests faults_;
  EventRequests events_;
  ScenarioRequests scenarios_;
  ModuleRequests modules_;
  SceneRequests scenes_;
  ServerRequests server_;
  bool frozen_ = false;
  std::uint64_t freezes_ = 0;
  std::uint64_t scene_told_ = 1;  // the number of the scene of which the clients know
  bool relieved_ = false;
  config::Profile* profile_ = nullptr;
  protocol::ClientLog stop_log_{"emergency stops"};  // anybody may pull them, as often as he likes
  std::atomic<std::uint64_t> limits_warned_at_{1};   // limited ticks at which the log tells of them next
  std::atomic<bool> ending_{false};
  std::atomic<std::int64_t> next_due_{0};
};

}  // namespace visum::gateway
