// A part without joints that commands nothing and keeps nothing: what stands among the parts, but is none of
// the world's. It lives where its parts do.
#pragma once

#include <optional>
#include <span>
#include <string>

#include "hwparts/part.h"

namespace visum::gateway {

class IdlePart : public hwparts::Part {
 public:
  std::span<const std::size_t> joints() const override { return {}; }
  std::optional<std::string> refuse(std::span<const double>) const override { return {}; }
  void act(std::span<const double>, std::span<const hwparts::JointSample>,
           std::span<hwparts::JointDrive>) override {}
  void publish(std::span<const hwparts::JointSample>, std::span<double>) override {}
  void following_errors(std::span<double>) const override {}
  void controller_lost() override {}
  void reset() override {}
  void save(hwparts::StateWriter&) const override {}
  void load(hwparts::StateReader&) override {}
};

}  // namespace visum::gateway
