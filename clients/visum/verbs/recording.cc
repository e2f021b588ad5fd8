#include "clients/visum/common/exit_code.h"
#include "clients/visum/verbs/verbs.h"
#include "protocol/command_line/one_of.h"

namespace visum::cli {
namespace {

class RecordingVerb : public Verb {
 public:
  void declare(CLI::App& app) override {
    app.add_option("WHAT", what_, "start or stop")
        ->required()
        ->check(command_line::one_of({"start", "stop"}));
    app.add_option("NAME", name_, "start: its name, which begins with a letter");
    add_link_options(app, link_, false);
    app.footer(
        "Records a world that runs already, into the file NAME.mcap of the server's folder (visumd --files). "
        "`visum record` records a world from its beginning.\n\nExamples:\n  visum recording start monday\n  "
        "visum recording stop");
  }

  int run() override {
    const bool starts = what_ == "start";
    if (starts == name_.empty())
      throw ExitError(kUsage, starts ? "give the recording a name: visum recording start NAME"
                                     : "stop takes no name: there is one recording at a time");
    auto link = open_link(link_, protocol::Role::kAdmin);
    if (starts)
      link.request(protocol::StartRecording{name_});
    else
      link.request(protocol::StopRecording{});
    return 0;
  }

 private:
  LinkOptions link_;
  std::string what_, name_;
};

}  // namespace

std::unique_ptr<Verb> make_recording() {
  return std::make_unique<RecordingVerb>();
}

}  // namespace visum::cli
