// All errors of one model file. As a ConfigError it is the first of them.
#pragma once

#include <utility>
#include <vector>

#include "protocol/config/config.h"

namespace visum::scene {

class ModelErrors : public config::ConfigError {
 public:
  // `errors` holds at least one.
  explicit ModelErrors(std::vector<config::ConfigError> errors)
      : ConfigError(errors.front()), all_(std::move(errors)) {}
  const std::vector<config::ConfigError>& all() const { return all_; }

 private:
  std::vector<config::ConfigError> all_;
};

// Calls `check` and keeps its error, so that the next check can follow.
template <typename Check>
void keep_error(std::vector<config::ConfigError>& errors, const Check& check) {
  try {
    check();
  } catch (const config::ConfigError& error) {
    errors.push_back(error);
  }
}

inline void throw_all(std::vector<config::ConfigError> errors) {
  if (!errors.empty()) throw ModelErrors(std::move(errors));
}

}  // namespace visum::scene
