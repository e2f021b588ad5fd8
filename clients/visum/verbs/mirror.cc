#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstring>

#include "clients/visum/common/exit_code.h"
#include "clients/visum/run/daemon.h"
#include "clients/visum/verbs/verbs.h"

namespace visum::cli {
namespace {

// The mirror is a server: this verb becomes visum-mirror, with all its words.
class MirrorVerb : public Verb {
 public:
  void declare(CLI::App& app) override {
    app_ = &app;
    app.set_help_flag();
    app.prefix_command();
  }

  int run() override {
    auto words = app_->remaining();
    words.insert(words.begin(), run::find_server("visum-mirror"));
    std::vector<char*> argv;
    for (auto& word : words) argv.push_back(word.data());
    argv.push_back(nullptr);
    std::signal(SIGPIPE, SIG_DFL);
    ::execvp(argv[0], argv.data());
    throw ExitError(kFailed, "cannot run '" + words.front() + "': " + std::strerror(errno));
  }

 private:
  CLI::App* app_ = nullptr;
};

}  // namespace

std::unique_ptr<Verb> make_mirror() {
  return std::make_unique<MirrorVerb>();
}

}  // namespace visum::cli
