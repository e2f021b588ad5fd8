// A verb of `visum`: the word after the program's name. Each verb is a file; the table in main.cc lists them.
// main.cc makes all verbs, declares them, parses the command line, and runs the one that was given, on the
// main thread.
#pragma once

#include <CLI/App.hpp>
#include <CLI/Validators.hpp>
#include <memory>

#include "clients/visum/common/link.h"

namespace visum::cli {

class Verb {
 public:
  virtual ~Verb() = default;
  // Adds options, help and examples to the verb's own app.
  virtual void declare(CLI::App& app) = 0;
  // Runs after parsing. Returns the exit code. Throws ExitError, ConfigError, RequestError or
  // ConnectionError; main.cc turns these into a message and an exit code.
  virtual int run() = 0;
};

// Adds --connect, --token-file and the TLS options; with `json` also --json, for verbs that print a result.
void add_link_options(CLI::App& app, LinkOptions& options, bool json = true);

// A check for an option: a number in [least, most], which NaN is not.
CLI::Validator number_within(double least, double most);

}  // namespace visum::cli
