#include <cstdio>
#include <filesystem>

#include "clients/visum/common/exit_code.h"
#include "clients/visum/common/whole_file.h"
#include "clients/visum/compare/forms.h"
#include "clients/visum/verbs/verbs.h"

namespace visum::cli {
namespace {

// A folder without results is unreadable, like a file that is no recording.
template <typename Compare>
auto compared(Compare compare) {
  try {
    return compare();
  } catch (const ExitError& error) {
    throw ExitError(kBadConfig, error.what());
  }
}

class CompareVerb : public Verb {
 public:
  void declare(CLI::App& app) override {
    app.add_option("A", a_, "a recording, or the folder of a campaign")->required();
    app.add_option("B", b_, "another one of the same kind")->required();
    app.add_flag("--json", json_, "print the result as a line of JSON");
    app.add_option("--report", report_, "write the result as an HTML page")->type_name("FILE.html");
    app.add_flag("--view", view_, "show two recordings on the page, one beside the other")
        ->excludes("--json")
        ->excludes("--report");
    app.footer(
        "Two recordings are compared tick by tick: the first tick that differs, and how far each port is "
        "apart. "
        "Two campaigns are compared run by run: which checks pass in one only, and by how much their values "
        "differ.\n"
        "Exit codes: 0 the same, 5 different, 3 unreadable, 2 bad usage. Recordings are the same if all "
        "ticks, all ports and the files of the scene are; campaigns, if all runs end alike. Another "
        "engine, parameter or build is told, and alone makes no difference.\n\nExamples:\n"
        "  visum run lift.yaml --record a.mcap\n"
        "  visum run lift.yaml --engine ode --record b.mcap\n"
        "  visum compare a.mcap b.mcap --report compare.html\n"
        "  visum compare a.mcap b.mcap --view\n"
        "  visum compare results_old results_new");
  }

  int run() override {
    for (const std::string& path : {a_, b_}) {
      std::error_code error;
      if (!std::filesystem::exists(path, error))
        throw ExitError(kBadConfig, path + " cannot be opened: " +
                                        (error ? error.message() : "there is no such file or folder"));
    }
    const bool folder_a = is_folder(a_), folder_b = is_folder(b_);
    if (folder_a != folder_b)
      throw ExitError(kUsage,
                      "A is " + kind_of(folder_a) + ", B " + kind_of(folder_b) + ": name two of one kind");
    if (view_ && folder_a) throw ExitError(kUsage, "--view shows recordings, and these are folders");
    if (view_) become_server({"visumd", "replay", a_, "--view", "--beside", b_});
    return folder_a ? tell(compared([&] { return compare::compare_campaigns(a_, b_); }))
                    : tell(compared([&] { return compare::compare_recordings(a_, b_); }));
  }

 private:
  static bool is_folder(const std::string& path) {
    std::error_code none;
    return std::filesystem::is_directory(path, none);
  }
  static std::string kind_of(bool folder) { return folder ? "a folder" : "a file"; }

  template <typename Comparison>
  int tell(const Comparison& comparison) const {
    std::fputs(compare::as_text(comparison).c_str(), json_ ? stderr : stdout);
    if (json_) std::printf("%s\n", compare::as_json(comparison).c_str());
    if (!report_.empty()) write_whole_file(report_, compare::as_html(comparison, a_, b_));
    return comparison.equal ? kDone : kDiffers;
  }

  std::string a_, b_, report_;
  bool json_ = false, view_ = false;
};

}  // namespace

std::unique_ptr<Verb> make_compare() {
  return std::make_unique<CompareVerb>();
}

}  // namespace visum::cli
