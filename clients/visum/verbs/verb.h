// A verb of `visum`: what stands after the program's name. One file per verb; the table in main.cc lists
// them.
#pragma once

#include <CLI/App.hpp>
#include <CLI/Validators.hpp>
#include <memory>

#include "clients/visum/common/link.h"

namespace visum::cli {

class Verb {
 public:
  virtual ~Verb() = default;
  virtual void declare(CLI::App& app) = 0;  // adds options, help and examples to the verb's own app
  virtual int run() = 0;                    // after parsing; returns the exit code, or throws as main.cc says
};

// --connect and --token-file, and --json where the verb has something to tell.
void add_link_options(CLI::App& app, LinkOptions& options, bool json = true);

// A check for an option: a number in [least, most]. NaN is none.
CLI::Validator number_within(double least, double most);

}  // namespace visum::cli
