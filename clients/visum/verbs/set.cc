#include <algorithm>
#include <chrono>
#include <cstdio>

#include "clients/visum/common/exit_code.h"
#include "clients/visum/common/format.h"
#include "clients/visum/common/json_writer.h"
#include "clients/visum/common/ports.h"
#include "clients/visum/common/samples.h"
#include "clients/visum/verbs/verbs.h"

namespace visum::cli {
namespace {

using protocol::Connection;
using protocol::PartSample;

struct Assignment {
  PortRef port;
  double value;
};

bool in_force(const PartSample& sample, const std::vector<Assignment>& wanted) {
  return std::all_of(wanted.begin(), wanted.end(),
                     [&](const Assignment& one) { return value_of(sample, one.port) == one.value; });
}

// One message for each run of neighbouring ports: the server takes or refuses a message as a whole.
std::vector<protocol::Write> to_writes(const std::string& part, std::vector<Assignment> wanted) {
  std::stable_sort(wanted.begin(), wanted.end(),
                   [](const Assignment& a, const Assignment& b) { return a.port.index < b.port.index; });
  std::vector<protocol::Write> writes;
  for (const Assignment& one : wanted) {
    const bool next =
        !writes.empty() && writes.back().first_port + writes.back().values.size() == one.port.index;
    if (!next) writes.push_back({part, static_cast<std::uint32_t>(one.port.index), {}, 0});
    writes.back().values.push_back(one.value);
  }
  return writes;
}

class Set : public Verb {
 public:
  void declare(CLI::App& app) override {
    app.add_option("PART", part_, "the part's name")->required();
    app.add_option("PORT VALUE", words_, "controller inputs by name, each with its value")->required();
    add_link_options(app, link_);
    app.footer(
        "Takes the lease, writes, waits until the values are in force, and releases the lease. The values "
        "stay.\n"
        "\nExamples:\n  visum set arm \"Desired Angle 1\" 0.5\n"
        "  visum set arm \"Maximum Speed 2\" 0.3 \"Desired Angle 2\" -0.8");
  }

  int run() override {
    auto link = open_link(link_, protocol::Role::kController);
    const auto reply = describe_part(link, part_);
    const auto wanted = read_words(reply.description);
    link.request(protocol::AcquireLease{part_, 0, false});
    write(link, wanted);
    const auto applied = wait_until_applied(link, wanted);
    link.request(protocol::ReleaseLease{part_});
    tell(link, applied);
    return kDone;
  }

 private:
  std::vector<Assignment> read_words(const protocol::PartDescription& part) const {
    if (words_.size() % 2 != 0)
      throw ExitError(kUsage, "each PORT needs a VALUE: '" + words_.back() + "' has none");
    std::vector<Assignment> wanted;
    for (std::size_t i = 0; i < words_.size(); i += 2) {
      const PortRef port = find_input(part, words_[i]);
      for (const Assignment& earlier : wanted) {
        if (earlier.port.index == port.index)
          throw ExitError(kUsage, "port '" + words_[i] + "' is given twice");
      }
      wanted.push_back({port, read_value(part, *port.port, words_[i + 1])});
    }
    return wanted;
  }

  // Releases the lease after a refusal too; otherwise the server would treat us as a controller that was
  // lost.
  void write(Connection& link, const std::vector<Assignment>& wanted) const try {
    for (const auto& message : to_writes(part_, wanted)) link.request(message);
  } catch (const protocol::RequestError&) {
    link.post(protocol::ReleaseLease{part_});
    throw;
  }

  // Returns the sample in which the values are in force. Returns nothing if time does not run, because then
  // they cannot come into force now, or after two seconds.
  std::optional<PartSample> wait_until_applied(Connection& link,
                                               const std::vector<Assignment>& wanted) const {
    link.request(protocol::Subscribe{part_, 1});
    const auto give_up = std::chrono::steady_clock::now() + std::chrono::seconds(2);
    while (std::chrono::steady_clock::now() < give_up) {
      const auto message = link.next(std::chrono::milliseconds(50));
      if (message && std::holds_alternative<PartSample>(*message)) {
        if (in_force(std::get<PartSample>(*message), wanted)) return std::get<PartSample>(*message);
      } else if (!message && stands_still(link)) {
        return std::nullopt;
      }
    }
    return std::nullopt;
  }

  static bool stands_still(Connection& link) {
    const auto status = link.request_as<protocol::ServerStatus>(protocol::Status{});
    return status.paused || status.frozen || !status.lockstep.empty();
  }

  void tell(Connection& link, const std::optional<PartSample>& applied) const {
    if (link_.json) {
      JsonWriter json;
      json.begin_object().member("part", part_).member("applied", applied.has_value());
      if (applied) json.member("tick", applied->tick).member("sim_time_ns", applied->sim_time_ns);
      std::puts(json.end_object().text().c_str());
    } else if (!applied) {
      const auto status = link.request_as<protocol::ServerStatus>(protocol::Status{});
      std::fprintf(stderr, "accepted; it takes effect with the next tick (the world %s at %s)\n",
                   status.paused   ? "is paused"
                   : status.frozen ? "is frozen"
                                   : "waits",
                   seconds(status.sim_time_ns).c_str());
    }
  }

  LinkOptions link_;
  std::string part_;
  std::vector<std::string> words_;
};

}  // namespace

std::unique_ptr<Verb> make_set() {
  return std::make_unique<Set>();
}

}  // namespace visum::cli
