#include <cstdio>

#include "clients/visum/common/completion.h"
#include "clients/visum/verbs/verbs.h"
#include "protocol/command_line/one_of.h"

namespace visum::cli {
namespace {

Shell::Command describe(const CLI::App& app) {
  Shell::Command command{app.get_name(), app.get_description(), {}};
  for (const CLI::Option* option : app.get_options()) {
    if (option->get_lnames().empty()) continue;
    command.options.push_back({"--" + option->get_lnames().front(), option->get_description()});
  }
  return command;
}

class Completion : public Verb {
 public:
  void declare(CLI::App& app) override {
    app_ = &app;
    app.add_option("SHELL", shell_, "bash, zsh or fish")
        ->required()
        ->check(command_line::one_of({"bash", "zsh", "fish"}));
    app.footer(
        "Examples:\n  source <(visum completion bash)\n  source <(visum completion zsh)\n"
        "  visum completion fish | source");
  }

  int run() override {
    Shell shell;
    for (const CLI::App* verb : app_->get_parent()->get_subcommands([](const CLI::App*) { return true; })) {
      shell.commands.push_back(describe(*verb));
    }
    const auto script = shell_ == "bash" ? shell.bash() : shell_ == "zsh" ? shell.zsh() : shell.fish();
    std::fputs(script.c_str(), stdout);
    return 0;
  }

 private:
  const CLI::App* app_ = nullptr;
  std::string shell_;
};

}  // namespace

std::unique_ptr<Verb> make_completion() {
  return std::make_unique<Completion>();
}

}  // namespace visum::cli
