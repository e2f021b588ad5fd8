// A part below: a hardware part of a Visum server, virtual or real, or another part of the controller. Both
// speak the same protocol, so that one takes the place of the other without a change here. Belongs to the
// thread of the part's loop.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "clients/cpp/visum.h"
#include "clients/mca/vector.h"

namespace visum::mca {

struct Options;

class Lower {
 public:
  // Connects to `address`, "PART@HOST:PORT". If the server has no such part but knows where a part of that
  // name serves its ports, goes there. Takes the lease, and joins the clock. Throws
  // visum::Error if that does not succeed in time.
  Lower(const std::string& address, const std::string& client_name, const Options& options);

  const std::string& part_name() const { return part_->name(); }
  bool in_lockstep() const { return client_->server().clock == "lockstep"; }
  bool simulated() const { return client_->server().simulated; }

  // The part's ports.
  Vector& controller_input() { return *controller_input_; }
  Vector& sensor_output() { return *sensor_output_; }

  // An edge from the upper part's controller output to this part's controller input, or from this part's
  // sensor output to the upper part's sensor input. Throws std::invalid_argument if it cannot be.
  void AddEdgeDown(Vector& from, std::size_t first_from, std::size_t first_to, std::size_t count);
  void AddEdgeUp(std::size_t first_from, Vector& to, std::size_t first_to, std::size_t count);
  const std::vector<Edge>& edges() const { return edges_; }

  // Carries the newest sample up to the edges.
  void sense();
  // Carries values down. Sends those that an edge reaches, if one of them has changed; the last value holds.
  void control();

  // Lets the part below run for `ns` of its time, and finds out whether it has.
  void begin_advance(std::int64_t ns) { client_->begin_advance_ns(ns); }
  bool advanced(std::chrono::milliseconds patience) { return client_->advanced(patience); }
  // Reads the newest sample, for a part that is not waited for.
  void read() { part_->read(); }

  // For messages about the modules of the controller.
  Client& client() { return *client_; }

  // Gives the lease back and leaves the clock: the values hold.
  void release();
  // Ends the connection without a release: the part below knows that its controller is lost, and stops.
  void drop() noexcept;

 private:
  void connect(const std::string& part, const std::string& address, const std::string& client_name,
               const Options& options);

  std::unique_ptr<Client> client_;
  std::unique_ptr<visum::Part> part_;
  std::unique_ptr<Vector> controller_input_, sensor_output_;
  std::vector<Edge> edges_;
  std::vector<bool> commanded_;  // by controller input: an edge reaches it
};

}  // namespace visum::mca
