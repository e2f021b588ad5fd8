// The oracle checks what must hold in any storm. It stands between the sessions and the gateway, and observes
// the world. It compares what was promised with what was done:
//
//   - a part has one owner at a time, and only the owner's writes are accepted;
//   - a write that is accepted reaches the world once, in order, maybe together with those behind it (of each
//   port the latest value), or not at all where its lease was lost before;
//   - nothing of a lease that was lost moves the part afterwards, and the part stands soon after the loss;
//   - each request has one answer, unless its session ended;
//   - nothing is an internal error.
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "protocol/server.h"
#include "server/cycle/simulation.h"
#include "server/gateway/tick_side.h"

namespace visum::storm {

class Oracle final : public protocol::SessionHandler, public cycle::Observer {
 public:
  Oracle(protocol::SessionHandler& judged, cycle::Simulation& simulation);

  protocol::Role on_hello(protocol::Session& session, const protocol::Hello& hello,
                          protocol::Welcome& welcome, protocol::Error& refusal) override;
  void on_request(protocol::Session& session, std::uint64_t id, const protocol::Request& request) override;
  void on_close(protocol::Session& session, protocol::CloseReason reason) override;
  void on_notify() override {}
  void on_room(protocol::Session& session) override { judged_.on_room(session); }
  void sends(protocol::Session& session, std::uint64_t reply_to, const protocol::Reply& reply);

  void took(const recording::TimedInput& input) override;
  void ticked() override;
  // Empties the mailbox, and knows from then on that all inputs accepted before have reached the tick's side.
  void empty_mailbox(gateway::TickSide& tick_side);

  void expect(bool holds, const std::string& claim);
  const std::string& broken() const { return broken_; }  // the first claim that did not hold; empty: all held
  // All requests have been answered and all that was accepted was done.
  void settled();
  std::uint64_t digest() const { return digest_; }  // of all that was seen, in its order
  struct Counts {
    std::uint64_t requests = 0, refused = 0, writes = 0, taken = 0, losses = 0;
  };
  const Counts& counts() const { return counts_; }

 private:
  // A decision of the sessions' side about a part, on its way to the world.
  struct Step {
    enum class Kind { kGrant, kWrite, kRelease, kLoss } kind;
    std::uint64_t epoch;
    std::uint32_t first_port = 0;
    std::vector<double> values{};
  };
  struct PartModel {
    std::uint64_t owner = 0;  // session; 0: nobody
    std::uint64_t epoch = 0;
    std::deque<Step> under_way;
    std::uint64_t gone = 0;                    // steps that were taken from there
    std::map<std::uint32_t, double> to_come;   // by port: of writes that came together, what the world lacks
    std::map<std::uint32_t, double> in_force;  // by port: what was written last
    std::size_t delivered = 0;                 // of those
    std::uint64_t newest_there = 0;            // epoch: of the newest grant that the tick's side knows
    std::uint64_t lost_there = 0;              // epoch: this one and those before are lost for the world
    std::int64_t must_stand_from = -1;         // tick; -1: it may move
  };

  std::size_t part_of(std::string_view name) const;
  void accepted(protocol::Session& session, const protocol::Request& request, const protocol::Reply& reply);
  void lost(const protocol::Event& event);
  static std::optional<Step> next_step(PartModel& part);
  void took_write(PartModel& part, const recording::WriteInputs& write);
  void took_loss(PartModel& part);
  void took_era();
  // The world has this value, by another write maybe.
  static bool is_in_force(const PartModel& part, std::uint32_t port, double value);
  static bool is_in_force(const PartModel& part, const Step& write);
  void note(std::uint64_t number);

  protocol::SessionHandler& judged_;
  cycle::Simulation& simulation_;
  std::vector<PartModel> parts_;
  std::map<std::uint64_t, std::map<std::uint64_t, std::deque<protocol::Request>>>
      asked_;  // by session, by id
  // For each Reset and RestoreSnapshot that waits for its answer: the number of steps of each part that had
  // to be done before it.
  std::map<std::pair<std::uint64_t, std::uint64_t>, std::vector<std::uint64_t>>
      era_requests_;  // by session, id
  std::string broken_;
  std::uint64_t digest_ = 0xcbf29ce484222325u;
  Counts counts_;
};

}  // namespace visum::storm
