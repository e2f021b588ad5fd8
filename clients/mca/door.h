// Where the parts above connect: serves a part's ports, parameters and lockstep in Visum's protocol, on
// loopback. It holds what they have written until the part's next Control(). Everything happens on the thread
// of the part's loop, which calls it.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "protocol/backlog.h"
#include "protocol/module_board.h"
#include "protocol/server.h"

namespace visum::mca {

class Blackboard;
class Part;

// The part above that commands this one is gone without a release, or is too late.
class UpperLost : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

class Door : public protocol::SessionHandler {
 public:
  // Calls that the door makes to its part.
  struct Hooks {
    std::function<void(const protocol::Request&)> pass_down;  // about modules, to the part below
  };

  // Listens on 127.0.0.1. Throws std::runtime_error if the port is taken.
  Door(Part& part, int port, bool lockstep, bool simulated, Hooks hooks);
  ~Door() override;

  std::uint16_t port() const { return server_->port(); }

  // Shows the part's sensor outputs at this cycle, and answers who waited for it.
  void publish(std::int64_t cycle, std::int64_t time_ns);
  // In lockstep: true once the parts above that the options ask for have joined, and each of them has allowed
  // this cycle. Throws UpperLost, with names, if they have taken longer than they may.
  bool is_complete();
  // True if parts above have joined and all of them have left again in good order.
  bool is_left() const { return all_have_joined_ && had_members_ && members() == 0; }
  // Serves what is ready, for up to `at_most`. Throws UpperLost if the holder of the lease is gone.
  void serve(std::chrono::nanoseconds at_most);
  // Puts what was written into the part's controller input.
  void take_commands();
  // Sends an order about a module to the part above that it is for. Does nothing if it is for none of them.
  void pass_up(const protocol::OverrideModulePort& wanted);
  void pass_up(const protocol::SetModuleParameter& wanted);
  // Tells all that the part ends, and lets them close.
  void close();

  // SessionHandler
  protocol::Role on_hello(protocol::Session& session, const protocol::Hello& hello,
                          protocol::Welcome& welcome, protocol::Error& refusal) override;
  void on_request(protocol::Session& session, std::uint64_t id, const protocol::Request& request) override;
  void on_close(protocol::Session& session, protocol::CloseReason reason) override;
  void on_notify() override {}

 private:
  using Clock = std::chrono::steady_clock;
  struct Peer {
    protocol::Session* session = nullptr;
    bool joined = false;
    std::int64_t granted = 0;                // may run up to this cycle
    std::optional<std::uint64_t> advancing;  // the Advance that is not answered yet
    std::optional<std::uint32_t> every;      // subscribed: a sample each so many cycles
    std::int64_t sampled = 0;
    Clock::duration patience{};
    protocol::Backlog backlog;
  };

  void dispatch(Peer& peer, std::uint64_t id, const protocol::Request& request);
  void work_off(Peer& peer);
  void fail(Peer& peer, std::uint64_t id, protocol::ErrorCode code, const std::string& text,
            const std::string& owner = {});
  void done(Peer& peer, std::uint64_t id, const protocol::Reply& reply = protocol::Ok{});
  bool is_ours(Peer& peer, std::uint64_t id, const std::string& part);
  bool may_command(Peer& peer, std::uint64_t id);
  bool has_lease(Peer& peer, std::uint64_t id);
  Blackboard* blackboard(Peer& peer, std::uint64_t id, const std::string& name);  // null: it is refused

  // One for each request that the door knows. The last one refuses all others.
  void handle(Peer& peer, std::uint64_t id, const protocol::Status&);
  void handle(Peer& peer, std::uint64_t id, const protocol::ListParts&);
  void handle(Peer& peer, std::uint64_t id, const protocol::DescribePart& request);
  void handle(Peer& peer, std::uint64_t id, const protocol::AcquireLease& request);
  void handle(Peer& peer, std::uint64_t id, const protocol::ReleaseLease& request);
  void handle(Peer& peer, std::uint64_t id, const protocol::Write& request);
  void handle(Peer& peer, std::uint64_t id, const protocol::Read& request);
  void handle(Peer& peer, std::uint64_t id, const protocol::Subscribe& request);
  void handle(Peer& peer, std::uint64_t id, const protocol::Unsubscribe& request);
  void handle(Peer& peer, std::uint64_t id, const protocol::GetParameters& request);
  void handle(Peer& peer, std::uint64_t id, const protocol::SetParameter& request);
  void handle(Peer& peer, std::uint64_t id, const protocol::ReadBlackboard& request);
  void handle(Peer& peer, std::uint64_t id, const protocol::WriteBlackboard& request);
  void handle(Peer& peer, std::uint64_t id, const protocol::Join& request);
  void handle(Peer& peer, std::uint64_t id, const protocol::Advance& request);
  void handle(Peer& peer, std::uint64_t id, const protocol::Leave&);
  void handle(Peer& peer, std::uint64_t id, const protocol::AnnounceModules& request);
  void handle(Peer& peer, std::uint64_t id, const protocol::ReportModules& request);
  void handle(Peer& peer, std::uint64_t id, const protocol::ListModules& request);
  void handle(Peer& peer, std::uint64_t id, const protocol::OverrideModulePort& request);
  void handle(Peer& peer, std::uint64_t id, const protocol::SetModuleParameter& request);
  template <typename Other>
  void handle(Peer& peer, std::uint64_t id, const Other&);

  protocol::PartDescription description() const;
  protocol::PartSample sample() const;
  protocol::Advanced now() const;
  template <typename Order>
  void relay_up(const Order& order);
  std::size_t members() const;
  std::string missing_members() const;  // in words, before all have joined; empty: nobody

  Part& part_;
  const bool lockstep_, simulated_;
  const Hooks hooks_;
  std::map<std::uint64_t, Peer> peers_;  // by session
  protocol::ModuleBoard board_;
  std::vector<double> commands_, outputs_;
  std::uint64_t holder_ = 0;  // the session with the lease; 0: nobody
  std::uint64_t epoch_ = 0;
  std::string holder_name_, lost_;
  std::int64_t deadline_ns_ = 0, written_ns_ = 0;
  std::int64_t cycle_ = 0, time_ns_ = 0;
  bool all_have_joined_ = false, had_members_ = false;
  std::optional<Clock::time_point> waiting_since_;
  std::unique_ptr<protocol::Server> server_;  // last: it calls the others
};

}  // namespace visum::mca
