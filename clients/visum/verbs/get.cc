#include <cstdio>

#include "clients/visum/common/format.h"
#include "clients/visum/common/json_writer.h"
#include "clients/visum/common/ports.h"
#include "clients/visum/common/samples.h"
#include "clients/visum/verbs/verbs.h"

namespace visum::cli {
namespace {

class Get : public Verb {
 public:
  void declare(CLI::App& app) override {
    app.add_option("PART", part_, "the part's name")->required();
    app.add_option("PORT", ports_, "ports or groups by name; default: all");
    add_link_options(app, link_);
    app.footer(
        "One port prints its value alone, several print a table.\n\nExamples:\n  visum get arm \"Actual "
        "Angle 1\"\n"
        "  visum get arm \"Actual Angle\" --json");
  }

  int run() override {
    auto link = open_link(link_, protocol::Role::kObserver);
    const auto reply = describe_part(link, part_);
    const auto ports = find_ports(reply.description, ports_);
    const auto sample = link.request_as<protocol::PartSample>(protocol::Read{part_});
    if (link_.json) {
      std::puts(sample_json(sample, ports).c_str());
    } else if (ports_.size() == 1 && ports.size() == 1) {
      std::puts(exact(value_of(sample, ports.front())).c_str());
    } else {
      std::fputs(sample_table(sample, ports).c_str(), stdout);
    }
    return 0;
  }

 private:
  LinkOptions link_;
  std::string part_;
  std::vector<std::string> ports_;
};

}  // namespace

std::unique_ptr<Verb> make_get() {
  return std::make_unique<Get>();
}

}  // namespace visum::cli
