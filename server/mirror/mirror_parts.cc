#include "server/mirror/mirror_parts.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "hwparts/servo_group/part_options.h"

namespace visum::mirror {
namespace {

using protocol::Parameter;
using protocol::ParameterValue;
using protocol::Port;

// Neither of the two parts has joints of a world, or a state to go back to.
class MirrorPart : public hwparts::Part {
 public:
  explicit MirrorPart(Mirror& mirror) : mirror_(mirror) {}
  const protocol::PartDescription& description() const override { return description_; }
  std::span<const std::size_t> joints() const override { return {}; }
  std::optional<std::string> refuse(std::span<const double>) const override { return std::nullopt; }
  void following_errors(std::span<double>) const override {}
  void reset() override {}
  void save(hwparts::StateWriter&) const override {}
  void load(hwparts::StateReader&) override {}

 protected:
  Mirror& mirror_;
  protocol::PartDescription description_;
};

class MirroredArm : public MirrorPart {
 public:
  explicit MirroredArm(Mirror& mirror) : MirrorPart(mirror) {
    description_ = mirror.description();
    description_.blackboards = {
        {"Identity", "text/plain", 1, mirror.identity().size(), mirror.identity().size(), false}};
  }
  std::optional<std::string> refuse_now(std::span<const double> before,
                                        std::span<const double> inputs) const override {
    return mirror_.refuse_now(before, inputs);
  }
  void act(std::span<const double> inputs, std::span<const hwparts::JointSample>,
           std::span<hwparts::JointDrive>) override {
    mirror_.pump();
    mirror_.command(inputs);
  }
  void publish(std::span<const hwparts::JointSample>, std::span<double> outputs) override {
    mirror_.read(outputs);
  }
  void controller_lost() override { mirror_.controller_lost(); }
  std::vector<Parameter> parameters() const override { return mirror_.parameters(); }
  std::optional<std::string> set_parameter(const std::string& name, const ParameterValue& value) override {
    return mirror_.set_parameter(name, value);
  }
  std::span<const std::byte> read_blackboard(std::size_t) const override {
    return std::as_bytes(std::span(mirror_.identity()));
  }
};

struct Bound {
  const char* name;
  const char* unit;
  const char* help;
  double MirrorBounds::*member;
};
constexpr std::array<Bound, 4> kBounds{{
    {"Angle Limit", "rad", "divergence that halts both arms; 0: none does", &MirrorBounds::angle_limit_rad},
    {"Position Limit", "m", "divergence that halts both arms; 0: none does", &MirrorBounds::position_limit_m},
    {"Angle Switch Bound", "rad", "divergence up to which the primary may be switched without force",
     &MirrorBounds::angle_switch_rad},
    {"Position Switch Bound", "m", "divergence up to which the primary may be switched without force",
     &MirrorBounds::position_switch_m},
}};
constexpr double kWidestBound = 1e3, kMostRefusals = 1e12;
constexpr std::size_t kLongestFault = 1024;  // bytes
constexpr const char *kPrimary = "Primary", *kForcePrimary = "Force Primary";

class Divergence : public MirrorPart {
 public:
  Divergence(Mirror& mirror, const std::string& name) : MirrorPart(mirror) {
    description_.name = name;
    description_.kind = "divergence";
    auto& ports = description_.sensor_outputs;
    for (const auto i : mirror.compared()) {
      const auto& port = mirror.description().sensor_outputs[i];
      const double width = port.maximum - port.minimum;
      ports.push_back(
          {"Divergence of " + port.name, port.unit, -width, width, 0.0, "Divergence of " + port.group});
    }
    ports.push_back({"Largest Angle Divergence", "rad", 0.0, kWidestBound, 0.0, "Largest Angle Divergence"});
    ports.push_back(
        {"Largest Position Divergence", "m", 0.0, kWidestBound, 0.0, "Largest Position Divergence"});
    ports.push_back({"Primary", "", 1.0, 2.0, 1.0, "Primary"});
    ports.push_back({"Connected 1", "", 0.0, 1.0, 1.0, "Connected"});
    ports.push_back({"Connected 2", "", 0.0, 1.0, 1.0, "Connected"});
    ports.push_back({"Divergence Fault", "", 0.0, 1.0, 0.0, "Divergence Fault"});
    ports.push_back({"Refusals 1", "", 0.0, kMostRefusals, 0.0, "Refusals"});
    ports.push_back({"Refusals 2", "", 0.0, kMostRefusals, 0.0, "Refusals"});
    ports.push_back({"World Of", "", 0.0, 2.0, 0.0, "World Of"});
    description_.blackboards = {{"Fault", "text/plain", 1, 0, kLongestFault, false}};
    description_.parameters = parameters();
  }
  void act(std::span<const double>, std::span<const hwparts::JointSample>,
           std::span<hwparts::JointDrive>) override {}
  void publish(std::span<const hwparts::JointSample>, std::span<double> outputs) override {
    auto next = std::ranges::copy(mirror_.divergence(), outputs.begin()).out;
    *next++ = mirror_.largest("rad");
    *next++ = mirror_.largest("m");
    *next++ = static_cast<double>(mirror_.primary() + 1);
    *next++ = mirror_.connected(0) ? 1.0 : 0.0;
    *next++ = mirror_.connected(1) ? 1.0 : 0.0;
    *next++ = mirror_.fault() ? 1.0 : 0.0;
    for (std::size_t arm = 0; arm < Mirror::kArms; ++arm)
      *next++ = static_cast<double>(mirror_.refusals(arm));
    *next++ = mirror_.world_of() ? static_cast<double>(*mirror_.world_of() + 1) : 0.0;
  }
  std::span<const std::byte> read_blackboard(std::size_t) const override {
    const auto text = std::as_bytes(std::span(mirror_.why()));
    return text.first(std::min(text.size(), kLongestFault));
  }
  void controller_lost() override {}

  std::vector<Parameter> parameters() const override {
    std::vector<Parameter> all;
    const auto primary = static_cast<std::int64_t>(mirror_.primary() + 1);
    all.push_back(
        {kPrimary, "", "the arm that the controller sees; switched only where the two agree", primary, 1, 2});
    all.push_back({kForcePrimary, "", "the same, whether they agree or not", primary, 1, 2});
    for (const auto& bound : kBounds)
      all.push_back({bound.name, bound.unit, bound.help, mirror_.bounds().*bound.member, 0.0, kWidestBound});
    return all;
  }
  std::optional<std::string> set_parameter(const std::string& name, const ParameterValue& value) override {
    const double number = servo_group::as_number(value);
    if (name == kPrimary || name == kForcePrimary) {
      if (number != 1.0 && number != 2.0) return "must be 1 or 2";
      return mirror_.switch_to(static_cast<std::size_t>(number) - 1, name == kForcePrimary);
    }
    for (const auto& bound : kBounds) {
      if (name != bound.name) continue;
      if (!(number >= 0.0 && number <= kWidestBound)) return "must be between 0 and 1000";
      mirror_.bounds().*bound.member = number;
      return std::nullopt;
    }
    return Part::set_parameter(name, value);
  }
};

}  // namespace

std::unique_ptr<hwparts::Part> make_mirrored_arm(Mirror& mirror) {
  return std::make_unique<MirroredArm>(mirror);
}

std::unique_ptr<hwparts::Part> make_divergence(Mirror& mirror, const std::string& name) {
  return std::make_unique<Divergence>(mirror, name);
}

}  // namespace visum::mirror
