// The sessions that said hello, and which of their requests wait.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include "protocol/backlog.h"
#include "protocol/server.h"
#include "server/gateway/event_feed.h"

namespace visum::gateway {

// A session's requests are answered in order. While one waits for the world, or replies wait to be written,
// those behind it wait in `backlog`.
struct Client {
  protocol::Session* session = nullptr;
  bool waiting = false;
  std::optional<protocol::EventLevel> events;  // the least level that it wants to hear of; nothing: none
  bool holds_bodies = false;                   // has pulled a body, or moved a kinematic one
  std::optional<std::int64_t> step_until;      // a gate holds the first of the backlog until this tick
  protocol::Backlog backlog;
};

// All clients, in the order of their sessions' numbers, which makes the order of replies and events the same
// in every run. Lives on the sessions' thread. The Gateway owns it; its parts use it to answer later than
// they were asked, and to tell everybody. A client is there from hello until its session closed.
class Clients {
 public:
  Client& add(protocol::Session& session) {
    auto& client = clients_[session.id()];
    client.session = &session;
    return client;
  }
  void remove(std::uint64_t session) { clients_.erase(session); }
  // Null: that session is gone.
  Client* find(std::uint64_t session) {
    const auto found = clients_.find(session);
    return found == clients_.end() ? nullptr : &found->second;
  }
  Client& at(std::uint64_t session) { return clients_.at(session); }
  std::map<std::uint64_t, Client>& all() { return clients_; }
  const std::map<std::uint64_t, Client>& all() const { return clients_; }
  std::size_t size() const { return clients_.size(); }

  // Tells all clients.
  void broadcast(protocol::Event event) {
    feed_.keep(event);
    for (auto& [id, client] : clients_) client.session->send(0, event);
  }
  // Tells those who subscribed to events, as far as their number is not too large. A client that does not
  // read as fast misses some.
  void tell(protocol::Event event) {
    if (!feed_.has_room(clock_())) return;
    send_to_subscribers(event);
  }
  // As tell(), and never left out. For events whose number is bounded by something else.
  void tell_always(const protocol::Event& event) { send_to_subscribers(event); }
  // Tells of events that were left out, once there is room again.
  void tell_of_lost_events(std::int64_t tick) {
    if (const auto lost = feed_.take_lost(clock_()); lost != 0)
      send_to_subscribers(
          {"events_lost", std::to_string(lost) + " events were left out", {}, known_era_, tick});
  }
  EventFeed& feed() { return feed_; }
  // Measures the pace of events by this instead of the steady clock. Before the first session.
  void use_clock(std::function<EventFeed::Clock::time_point()> clock) {
    clock_ = std::move(clock);
    feed_.start(clock_());
  }

  // The era that the clients know of. It is older than that of the newest copy of the world until serve() has
  // told them.
  std::uint64_t known_era() const { return known_era_; }
  void set_known_era(std::uint64_t era) { known_era_ = era; }

  // Requests that were answered with an error since the start.
  std::uint64_t refused() const { return refused_; }
  void count_refusal() { ++refused_; }

  // How often clients of each name have exchanged something with a part, also those that are gone. Past
  // kMostNames the rest has the empty name.
  static constexpr std::size_t kMostNames = 256;
  const std::map<std::string, std::uint64_t>& exchanges() const { return exchanges_; }
  void count_exchange(const std::string& client) {
    const bool has_room = exchanges_.size() < kMostNames || exchanges_.contains(client);
    ++exchanges_[has_room ? client : std::string()];
  }

 private:
  void send_to_subscribers(protocol::Event event) {
    feed_.keep(event);
    for (auto& [id, client] : clients_)
      if (client.events && event.level >= *client.events && !client.session->behind())
        client.session->send(0, event);
  }

  EventFeed feed_;
  std::function<EventFeed::Clock::time_point()> clock_ = &EventFeed::Clock::now;
  std::map<std::uint64_t, Client> clients_;  // by session
  std::uint64_t known_era_ = 1;
  std::uint64_t refused_ = 0;
  std::map<std::string, std::uint64_t> exchanges_;  // by client's name
};

}  // namespace visum::gateway
