// Readings of ports and of the world for clients: single samples, and streams of them.
#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "server/gateway/call.h"

namespace visum::gateway {

// Keeps the subscriptions of all sessions. Lives on the sessions' thread, owned by the Gateway. Samples come
// from the published copy of the world; where a client reads too slowly, the newest sample replaces the one
// that it has not been sent yet.
class Streams {
 public:
  explicit Streams(const StaticWorld& world) : world_(world) {}

  void handle(const Call& call, const protocol::Read& request);
  void handle(const Call& call, const protocol::Subscribe& request);
  void handle(const Call& call, const protocol::Unsubscribe& request);
  void handle(const Call& call, const protocol::ReadWorld&);
  void handle(const Call& call, const protocol::SubscribeWorld& request);
  void handle(const Call& call, const protocol::UnsubscribeWorld&);

  // A session begins, and ends.
  void add(protocol::Session& session) { readers_[session.id()].session = &session; }
  void remove(std::uint64_t session) { readers_.erase(session); }

  void send_due(const Published& now);
  // The earliest tick at which a sample is due; int64's maximum: there is no subscription.
  std::int64_t next_due() const;
  // A reset or restore: every subscription is due at once, and peaks count from here.
  // Ends the subscriptions of parts that went.
  void forget_parts(std::span<const std::uint32_t> parts);
  void begin_era(const Published& now);

 private:
  struct Subscription {
    std::uint32_t stream = 0;  // the part's number, or kWorldStream
    std::int64_t every = 1;    // ticks
    std::int64_t next_tick = 0;
    std::uint64_t conflated = 0;  // samples that were replaced before they were sent
  };
  struct Reader {
    protocol::Session* session = nullptr;
    std::vector<Subscription> subscriptions;
    std::int64_t peaks_from = 0;  // tick of its previous world sample
  };
  static constexpr std::uint32_t kWorldStream = 0xFFFFFFFF;

  void subscribe(const Call& call, std::uint32_t stream, std::uint32_t every);
  void unsubscribe(const Call& call, std::uint32_t stream);
  void send(Reader& reader, Subscription& subscription, const Published& now) const;
  protocol::PartSample part_sample(std::uint32_t part, const Published& now) const;
  // Holds the peaks since the reader's previous sample; so each call begins them anew.
  static protocol::WorldSample world_sample(Reader& reader, const Published& now);

  const StaticWorld& world_;
  std::map<std::uint64_t, Reader> readers_;  // by session
};

}  // namespace visum::gateway
