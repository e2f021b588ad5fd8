#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstring>
#include <utility>

#include "clients/visum/common/exit_code.h"
#include "clients/visum/run/daemon.h"
#include "clients/visum/verbs/verbs.h"

namespace visum::cli {
namespace {

// A verb that a server program does. It hands on all words that follow the verb.
class ServerVerb : public Verb {
 public:
  // `words`: the program, then the words to put before the user's own.
  explicit ServerVerb(std::vector<std::string> words) : words_(std::move(words)) {}

  void declare(CLI::App& app) override {
    app_ = &app;
    app.set_help_flag();
    app.prefix_command();
  }

  int run() override {
    auto words = words_;
    for (const auto& word : app_->remaining()) words.push_back(word);
    become_server(std::move(words));
  }

 private:
  const std::vector<std::string> words_;
  CLI::App* app_ = nullptr;
};

}  // namespace

void become_server(std::vector<std::string> words) {
  const std::string program = run::find_server(words.front());
  words.front() = "visum";
  std::vector<char*> argv;
  for (auto& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  std::signal(SIGPIPE, SIG_DFL);
  ::execvp(program.c_str(), argv.data());
  throw ExitError(kFailed, "cannot run '" + program + "': " + std::strerror(errno));
}

std::unique_ptr<Verb> make_mirror() {
  return std::make_unique<ServerVerb>(std::vector<std::string>{"visum-mirror"});
}

std::unique_ptr<Verb> make_convert() {
  return std::make_unique<ServerVerb>(std::vector<std::string>{"visumd", "convert"});
}

std::unique_ptr<Verb> make_check() {
  return std::make_unique<ServerVerb>(std::vector<std::string>{"visumd", "check"});
}

std::unique_ptr<Verb> make_drives() {
  return std::make_unique<ServerVerb>(std::vector<std::string>{"visumd", "drives"});
}

std::unique_ptr<Verb> make_record() {
  return std::make_unique<ServerVerb>(std::vector<std::string>{"visumd", "record"});
}

std::unique_ptr<Verb> make_replay() {
  return std::make_unique<ServerVerb>(std::vector<std::string>{"visumd", "replay"});
}

std::unique_ptr<Verb> make_rewind() {
  return std::make_unique<ServerVerb>(std::vector<std::string>{"visumd", "rewind"});
}

std::unique_ptr<Verb> make_export() {
  return std::make_unique<ServerVerb>(std::vector<std::string>{"visumd", "export"});
}

}  // namespace visum::cli
