// Completion scripts for the shells: verbs, options, and, asked from the server while the user types, parts
// and ports.
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
