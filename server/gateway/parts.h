// Commands of parts, and the right to give them: leases, writes, and what happens when a controller is lost.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "server/gateway/call.h"
#include "server/gateway/holdup.h"
#include "server/gateway/input_limiter.h"
#include "server/gateway/late_writes.h"
#include "server/gateway/leases.h"
#include "server/gateway/mailbox.h"

namespace visum::gateway {

// Checks writes and latches them: a value that was accepted is remembered here and sent to the tick's thread,
// which applies it at the next tick border. Lives on the sessions' thread, owned by the Gateway. Never
// touches the simulation; of the parts it calls only functions that any thread may call.
class Parts {
 public:
  Parts(const StaticWorld& world, Mailbox& mailbox, Clients& clients, InputLimiter& limiter,
        const Holdup& holdup);

  void handle(const Call& call, const protocol::ListParts&);
  void handle(const Call& call, const protocol::DescribePart& request);
  void handle(const Call& call, const protocol::AcquireLease& request);
  void handle(const Call& call, const protocol::ReleaseLease& request);
  void handle(const Call& call, const protocol::Write& request);

  // Parts came or went, and StaticWorld has the new ones already. `changed`: the numbers that mean another
  // part than in `before`, or none. Ends the leases of those that went.
  void follow(const PartTable& before, std::span<const std::uint32_t> changed, const Published& now);
  // The generation of a part's number; 0 for requests that are about none.
  std::uint32_t generation(std::uint32_t part) const {
    return part < world_.parts.size() ? world_.generation(part) : 0;
  }
  protocol::PartList list() const;
  // Leases that ended without a release, since the start.
  std::uint64_t lease_losses() const { return lease_losses_; }
  // Writes that were refused because they had waited for too long.
  std::uint64_t refused_late() const { return refused_late_; }
  // The tick's thread dropped a write that had become too old.
  void forget_dropped(std::uint32_t part, const Published& now);
  // False: the session does not hold the part's lease, and the call has failed with that.
  bool lease_or_fail(const Call& call, std::uint32_t part) const;
  // The name of another session that holds the part's lease; nothing: there is none, or no such part.
  std::optional<std::string> leased_to_another(const Call& call, const std::string& part) const;

  // The session is gone, or was late. Ends its leases. `commanded`: parts that its program commands over a
  // bus; those stop too, unless another session leases them.
  void lose_all_of(std::uint64_t session, std::span<const std::uint32_t> commanded, const std::string& why,
                   const Published& now);
  // The tick's thread found that a lease's deadline had passed, and has stopped the part.
  void end_missed_lease(const Notice& notice, const Published& now);

  // Late writes go to the mailbox where the next tick still has room for their session.
  void send_late_writes(const Published& now);
  // Lockstep and free, before each tick: all late writes go, whatever their sessions sent. True: some did.
  bool complete_writes();
  bool has_late_writes() const { return !late_.empty(); }
  // A command is about to be sent: what was written before it has to arrive before it. False: there is no
  // room for those writes, and the call has failed. A command about the pace of time (`need_all` false) goes
  // on without the rest, since only a tick can make room.
  bool send_before_command(const Call& call, bool need_all);
  // A reset or restore: what is latched is what the world has now.
  void begin_era(const Published& now);

 private:
  // When a part was last told that its controller is gone.
  struct Stop {
    std::int64_t tick = -1;  // -1: a command was sent since
    std::uint64_t epoch = 0;
  };

  // Why these values cannot be written; names the first bad port and its range. `wanted` becomes all inputs
  // of the part, with the new values in them.
  std::optional<std::string> refuse(std::uint32_t part, const protocol::Write& request,
                                    std::vector<double>& wanted) const;
  // Sends what is latched for the ports from `first_port` to before `end_port`.
  void send_write(std::uint32_t part, std::uint32_t first_port, std::uint32_t end_port, Input* input);
  // All of a part's late writes. False: the mailbox was full before they were sent.
  bool send_late_writes_of(std::uint32_t part);
  bool late_writes_sent_or_fail(const Call& call, std::uint32_t part);
  // The part's lease or its era ends: sends what the mailbox takes, and forgets the rest.
  void end_late_writes(std::uint32_t part);
  void lose_lease(std::uint32_t part, const std::string& why, const Published& now);
  // Tells the part's drives that their controller is gone.
  void stop(std::uint32_t part, const Published& now);

  const StaticWorld& world_;
  Mailbox& mailbox_;
  Clients& clients_;
  InputLimiter& limiter_;
  const Holdup& holdup_;
  Leases leases_;
  std::vector<std::vector<double>> latched_;  // by part: controller inputs as last accepted
  LateWrites late_;
  std::vector<Stop> stops_;  // by part
  std::uint64_t lease_losses_ = 0;
  std::uint64_t refused_late_ = 0;
};

}  // namespace visum::gateway
