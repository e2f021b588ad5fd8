// The seam of buses: what a part's modules are wired to. A link opens channels; the bus thread reads and
// writes them. Kinds by name: one line each in bus_kinds.cc.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "server/bus/channel.h"

namespace visum::bus {

class BusLink {
 public:
  virtual ~BusLink() = default;
  // As the ready line shows it: "pty:arm.tty", "tcp:40123".
  virtual std::string name() const = 0;
  // The same as others on this machine find it: with an absolute path.
  virtual std::string address() const { return name(); }
  // The channels that are there from the beginning. Called once.
  virtual std::vector<std::unique_ptr<Channel>> channels() { return {}; }
  // What to poll for new channels; -1: none come.
  virtual int listener() const { return -1; }
  // A new one, if one came.
  virtual std::unique_ptr<Channel> accept() { return nullptr; }
  // The last accept() failed though somebody waits: no descriptor is left. Who asks again at once asks in
  // vain.
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
