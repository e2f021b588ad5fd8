// Visum's client library: connect to a server, find a hardware part, take its lease, write and read its ports
// by name or index, and wait for the tick. The same controller runs unchanged under every clock of the server
// (realtime, lockstep, free) and in front of virtual and real parts.
//
//   visum::Client client("127.0.0.1:1500", {.name = "my_controller"});
//   visum::Part arm = client.part("arm");
//   arm.acquire();
//   visum::Inputs desired = arm.inputs("Desired Angle");
//   visum::Outputs actual = arm.outputs("Actual Angle");
//   client.join();
//   while (actual[0] < 0.5) {
//     desired.set(0, actual[0] + 0.01);
//     arm.write();             // posted, does not wait
//     client.advance_ms(10);   // one wait per period: brings the part's sample along
//   }
//   arm.release();
//
// Units are SI and radians. Time is simulated time in nanoseconds since the server's last reset. Calls block.
// One thread at a time may use a Client and its Parts and ports. Every failure throws visum::Error.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <memory>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <variant>
#include <vector>

namespace visum {

// Why a call failed. The values below 100 are the server's refusals, with the protocol's numbers. The last
// two come from this library.
enum class ErrorCode {
  kUnspecified = 0,
  kMalformed = 1,
  kTooLarge = 2,
  kVersion = 3,
  kUnauthenticated = 4,
  kForbidden = 5,
  kBusy = 6,
  kUnknownName = 7,
  kNoLease = 8,
  kLeased = 9,
  kBadValue = 10,
  kStale = 11,
  kWrongState = 12,
  kTimeout = 13,
  kFrozen = 14,
  kInternal = 15,
  kConnection = 100,  // the connection could not be made, or is gone
  kMisuse = 101,      // the program's own mistake, e.g. a vector of the wrong length
};
const char* to_string(ErrorCode code);  // "bad value", ...

// A failed call.
class Error : public std::runtime_error {
 public:
  Error(ErrorCode code, const std::string& text, std::string part = {}, std::string port = {},
        std::string owner = {});
  ErrorCode code() const { return code_; }
  const std::string& part() const { return part_; }    // empty if it is not about a part
  const std::string& port() const { return port_; }    // empty if it is not about a single port
  const std::string& owner() const { return owner_; }  // the holder of a lease that is in the way

 private:
  ErrorCode code_;
  std::string part_, port_, owner_;
};

enum class Role { kObserver = 1, kController = 2, kAdmin = 3 };

struct ClientOptions {
  std::string name = "controller";  // shown to others as the owner of leases; at most 64 bytes
  Role role = Role::kController;
  std::string token_file = {};  // for a server that was started with one
  // PEM files for a server that speaks TLS: the authority that signed the server's certificate, our own
  // certificate, and its key. If all are empty, $VISUM_TLS_CA, $VISUM_TLS_CERT and $VISUM_TLS_KEY count.
  std::string tls_ca = {}, tls_cert = {}, tls_key = {};
  // How long the constructor keeps trying (10 ms, 20, 40, ... apart) while nothing listens. 0: one attempt.
  std::chrono::milliseconds connect_timeout{5000};
};

struct ServerInfo {
  std::string server;        // "visumd 0.1.0"
  std::string scene;         // its file
  std::string clock;         // "realtime", "lockstep" or "free"
  std::int64_t tick_ns = 0;  // the length of a tick
  bool simulated = true;     // false if real hardware is behind the parts
};

struct PortInfo {
  std::size_t index = 0;  // in its vector
  std::string name;       // "Desired Angle 1"
  std::string unit;       // "rad", "m/s", ...; empty for a counter or a bit field
  std::string group;      // "Desired Angle"
  double minimum = 0.0;   // a value outside is refused
  double maximum = 0.0;
  double initial = 0.0;
};

using ParameterValue = std::variant<double, std::int64_t, bool, std::string>;

struct ParameterInfo {
  std::string name, unit, help;
  ParameterValue value;  // its alternative is the parameter's type
  double minimum = 0.0;  // for numbers and integers
  double maximum = 0.0;
  std::vector<std::string> choices;  // for texts; empty: any text
  bool read_only = false;
};

struct BlackboardInfo {
  std::string name;
  std::string content_type;  // "text/plain", "image/x-rgb24", ...
  std::uint64_t element_size = 1;
  std::uint64_t elements = 0;
  std::uint64_t capacity = 0;  // bytes
  bool writable = false;
};

namespace detail {
struct ClientState;
struct PartState;
}  // namespace detail

// Controller inputs of one part: one port or a group. It is cheap to copy, and valid as long as its Part.
class Inputs {
 public:
  std::size_t size() const { return ports_.size(); }
  const PortInfo& info(std::size_t i = 0) const;
  double value(std::size_t i = 0) const;  // as set under this lease, else as in the newest sample
  double operator[](std::size_t i) const { return value(i); }

  // Throws kBadValue where set() would, and stages nothing.
  void check(std::size_t i, double value) const;

  // Stages values for Part::write(). A value that is not finite, or is out of range, throws kBadValue and
  // stages nothing.
  void set(double value);  // only for one port
  void set(std::size_t i, double value);
  void set(std::span<const double> values);  // exactly size()
  void set(std::initializer_list<double> values);

 private:
  friend class Part;
  Inputs(detail::PartState& part, std::vector<std::size_t> ports) : part_(&part), ports_(std::move(ports)) {}
  detail::PartState* part_;
  std::vector<std::size_t> ports_;  // indices in the part's vector
};

// Sensor outputs of one part: one port or a group, as of the part's newest sample. Valid as long as its Part.
class Outputs {
 public:
  std::size_t size() const { return ports_.size(); }
  const PortInfo& info(std::size_t i = 0) const;
  double value(std::size_t i = 0) const;
  double operator[](std::size_t i) const { return value(i); }
  std::vector<double> values() const;

 private:
  friend class Part;
  Outputs(detail::PartState& part, std::vector<std::size_t> ports) : part_(&part), ports_(std::move(ports)) {}
  detail::PartState* part_;
  std::vector<std::size_t> ports_;
};

// A hardware part, with a first sample. Its destructor releases the lease in good order, and the part keeps
// the last values. If an exception is the reason, it drops the client's connection instead: the server then
// knows that the controller is lost, and stops the part.
class Part {
 public:
  ~Part();
  Part(Part&&) noexcept;
  Part& operator=(Part&&) noexcept;

  const std::string& name() const;
  const std::string& kind() const;  // "amtec_arm"
  const std::vector<PortInfo>& input_ports() const;
  const std::vector<PortInfo>& output_ports() const;

  // Ports by group or name, or by index. An unknown name throws kUnknownName with the nearest names.
  Inputs inputs(const std::string& group_or_name) const;
  Inputs input(const std::string& name) const;
  Inputs input(std::size_t index) const;
  Inputs all_inputs() const;
  Outputs outputs(const std::string& group_or_name) const;
  Outputs output(const std::string& name) const;
  Outputs output(std::size_t index) const;
  Outputs all_outputs() const;

  // Takes the lease, the exclusive right to write. After `deadline_ns` of simulated time without a write the
  // server treats this controller as lost; 0 means no deadline. `take` takes the lease from its holder (role
  // admin).
  void acquire(std::int64_t deadline_ns = 0, bool take = false);
  // Gives the lease back in good order. If it was lost before, this throws kNoLease, and the lease counts as
  // released all the same.
  void release();
  bool leased() const;

  // Sends what was set since the last write, and does not wait. A later call of this client throws a refusal:
  // the next advance or read at the latest. With nothing set it repeats the last write, as a sign of life for
  // a deadline.
  //
  // It is one all-or-nothing message if all ports between the first and the last of them have been set under
  // this lease. Otherwise it is one message for each run of such ports, and they may reach different ticks.
  //
  // A member of a lockstep sends it with its next call: no tick comes before that, because the server waits
  // for the member. A controller that stops to advance for good must call leave() or read() once.
  void write();
  // Brings the outputs up to date. It is free right after an advance, and costs one round trip otherwise.
  void read();
  std::int64_t sample_tick() const;
  std::int64_t sample_time_ns() const;

  // Parameters with their values of now: one round trip.
  std::vector<ParameterInfo> parameters() const;
  ParameterValue parameter(const std::string& name) const;
  void set_parameter(const std::string& name, const ParameterValue& value);
  const std::vector<BlackboardInfo>& blackboards() const;
  // In one round trip. In lockstep, a blackboard that is read in each period comes with the advance, as the
  // outputs do: right after it the first read is free.
  std::vector<std::byte> read_blackboard(const std::string& name) const;
  // At offset 0 the data become the whole content.
  void write_blackboard(const std::string& name, std::span<const std::byte> data, std::uint64_t offset = 0);
  // All writes between the two take effect at once, with unlock_blackboard(). After `timeout_ns` of
  // simulated time (at most 60 s) the lock is over: what was written is dropped, and further calls throw
  // kTimeout.
  void lock_blackboard(const std::string& name, std::int64_t timeout_ns);
  void unlock_blackboard(const std::string& name, bool discard = false);

 private:
  friend class Client;
  explicit Part(std::unique_ptr<detail::PartState> state);
  void let_go() noexcept;
  std::unique_ptr<detail::PartState> state_;
};

class Chain;          // kinematics.h
class WorldControl;   // world.h
struct ClientAccess;  // client_access.h

// A session with a server.
class Client {
 public:
  // Connects to "HOST:PORT" and says hello.
  explicit Client(const std::string& address = "127.0.0.1:1500", const ClientOptions& options = {});
  ~Client();  // its Parts become unusable
  Client(Client&&) noexcept;
  Client& operator=(Client&&) noexcept;

  const ServerInfo& server() const;
  std::vector<std::string> part_names();
  Part part(const std::string& name);

  // The chain of driven joints that carries a body of the world, "arm/link_7": for forward and inverse
  // kinematics (kinematics.h). Joints on the way that no part drives stay where they are now. Throws
  // kUnknownName where there is no such body, and kMisuse where no driven joint carries it.
  Chain chain(const std::string& body);

  // Joins the clock. Under `lockstep` the world waits from now on for each advance of this client, at most
  // `timeout` of wall time (0: the server's default). Under `realtime` and `free` the world goes on by
  // itself, and advance() only waits for it.
  void join(std::chrono::milliseconds timeout = std::chrono::milliseconds(0));
  void leave();

  // Says "I am done for this period", waits for the first tick at or after the end of the period, and brings
  // the samples of all Parts up to date. Periods do not drift, even if they are no multiple of the tick. A
  // period that this client was too late for is skipped, and never made up for.
  void advance_ns(std::int64_t period_ns);
  void advance_ms(double period_ms);
  void advance_ticks(std::int64_t ticks);

  // The same in two halves, for a program that has other things to do meanwhile. advanced() waits for up to
  // `patience` and returns true once the world is there; it throws what advance_ns() would. Between the two
  // no other call of this client or of its Parts is allowed but writes.
  void begin_advance_ns(std::int64_t period_ns);
  bool advanced(std::chrono::milliseconds patience);

  // Brings the samples of all Parts up to date: one wait for all of them.
  void read();

  // Changes a running module of a controller in MCA2's manner (clients/mca) that is connected to the same
  // server. `module` is its path, "Arm/Ramp". A parameter takes the value of its own type; a sensor input
  // holds a value against its edge, for a test, or follows the edge again (no value). It is on its way when
  // the call returns. Throws kUnknownName or kBadValue if it cannot be.
  void set_module_parameter(const std::string& part, const std::string& module, const std::string& name,
                            const ParameterValue& value);
  void hold_sensor_input(const std::string& part, const std::string& module, const std::string& port,
                         std::optional<double> value);

  // As of the last join, advance or read.
  std::int64_t time_ns() const;
  std::int64_t tick() const;
  std::uint64_t era() const;  // grows when the world is reset or restored

 private:
  friend class WorldControl;
  friend struct ClientAccess;
  std::unique_ptr<detail::ClientState> state_;
};

}  // namespace visum
