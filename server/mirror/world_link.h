// The world that an arm behind a mirror moves in, if its server has one. Clients of the mirror see it.
#pragma once

#include <chrono>
#include <cstdint>
#include <future>
#include <memory>
#include <optional>
#include <string>

#include "protocol/client.h"
#include "server/gateway/published.h"
#include "server/mirror/entry.h"

namespace visum::mirror {

// A session of its own, as an observer, so that a world that cannot be reached does not disturb the arm. When
// the server goes away, or its bodies change, the world is asked for anew on a thread of its own, so that no
// call waits for it. All calls come from one thread; the Mirror owns it.
class WorldLink {
 public:
  // Waits for the first answer. Throws std::runtime_error that names the address.
  WorldLink(std::string address, Entry entry);

  // False: that server has real hardware behind it, or a world without bodies.
  bool has_world() const { return view_ != nullptr; }
  int descriptor() const { return connection_ ? connection_->native_handle() : -1; }

  // Takes in what came, without waiting.
  void poll();
  // Puts the newest sample into the copy in place of this server's own world. The copy's ticks remain this
  // server's own.
  void fill(gateway::Published& published) const;

 private:
  using Clock = std::chrono::steady_clock;
  struct Found {
    protocol::Connection connection;
    std::shared_ptr<const gateway::WorldView> view;  // null: there is no world
    protocol::WorldSample sample;
  };
  static Found find(const std::string& address, const Entry& entry);
  void adopt(Found found);
  void look_again();
  void take(const protocol::Reply& reply);

  std::string address_;
  Entry entry_;
  std::optional<protocol::Connection> connection_;
  std::shared_ptr<const gateway::WorldView> view_;
  protocol::WorldSample sample_;
  bool stale_ = false;  // bodies came or went
  Clock::time_point tried_{};
  std::future<Found> search_;
};

}  // namespace visum::mirror
