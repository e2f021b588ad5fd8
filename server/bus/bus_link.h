// The seam of the buses: a link connects a part's modules to clients' programs. It opens channels, which the
// bus thread reads and writes. Each kind of link is one line in bus_kinds.cc.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "server/bus/channel.h"

namespace visum::bus {

// Made when the daemon opens its buses, then owned and called by the bus thread (bus_thread.h).
class BusLink {
 public:
  virtual ~BusLink() = default;
  // The name in the ready line: "pty:arm.tty", "tcp:40123".
  virtual std::string name() const = 0;
  // The same for other programs on this machine: with an absolute path.
  virtual std::string address() const { return name(); }
  // The channels that exist from the beginning. Called once.
  virtual std::vector<std::unique_ptr<Channel>> channels() { return {}; }
  // The descriptor to poll for new channels; -1: none will come.
  virtual int listener() const { return -1; }
  // A new channel, if one came.
  virtual std::unique_ptr<Channel> accept() { return nullptr; }
  // True: the last accept() failed because this process has no descriptor left, while a client waits. Asking
  // again at once would fail too.
  virtual bool is_short() const { return false; }
};

struct BusKind {
  const char* name;
  const char* help;
  // Throws std::runtime_error that says what cannot be opened and why.
  std::unique_ptr<BusLink> (*open)(const std::string& where);
};
std::span<const BusKind> bus_kinds();

std::unique_ptr<BusLink> open_pty(const std::string& path);
std::unique_ptr<BusLink> open_slcan(const std::string& path);
std::unique_ptr<BusLink> open_tcp(const std::string& port);
std::unique_ptr<BusLink> open_socketcan(const std::string& interface);

}  // namespace visum::bus
