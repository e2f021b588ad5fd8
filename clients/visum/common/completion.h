// Writes completion scripts for the shells. They complete verbs and options, and ask the server for parts and
// ports while the user types.
#pragma once

#include <string>
#include <vector>

namespace visum::cli {

struct Shell {
  struct Option {
    std::string name, help;
  };
  struct Command {
    std::string name, help;
    std::vector<Option> options;
  };
  std::vector<Command> commands;

  std::string bash() const;
  std::string zsh() const;
  std::string fish() const;
};

}  // namespace visum::cli
