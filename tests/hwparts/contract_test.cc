// The contract of a part of servos, whether simulated drives or modules on a bus stand behind its ports. A
// part passes all of it before it is served as `arm`.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "hwparts/servo_group/part_state.h"
#include "tests/hwparts/real_bench.h"

namespace visum::test {
namespace {

using servo_group::PartState;
using testing::HasSubstr;

// One part on the bench: its ports by name, its time, and the true joints behind it.
class Subject {
 public:
  explicit Subject(hwparts::Part& the_part) : part(the_part) {}
  virtual ~Subject() = default;
  virtual void run(double seconds) = 0;
  virtual std::vector<double>& inputs() = 0;
  virtual const std::vector<double>& outputs() const = 0;
  virtual PartBench& mechanics() = 0;

  double& in(const std::string& name) {
    return inputs().at(index(part.description().controller_inputs, name));
  }
  double out(const std::string& name) const {
    return outputs().at(index(part.description().sensor_outputs, name));
  }
  std::uint32_t module(int number) const {
    return static_cast<std::uint32_t>(out("Module State " + std::to_string(number)));
  }
  PartState state() const { return static_cast<PartState>(static_cast<int>(out("Part State"))); }
  void bump(const std::string& counter) { in(counter) += 1.0; }
  // The true position of joint 1..7.
  double joint(int number) { return mechanics().plants[static_cast<std::size_t>(number) - 1].joint.position; }
  bool wait_for(PartState wanted, double seconds) {
    for (double t = 0.0; t < seconds; t += 0.02) {
      run(0.02);
      if (state() == wanted) return true;
    }
    return false;
  }

  hwparts::Part& part;

 private:
  static std::size_t index(const std::vector<protocol::Port>& ports, const std::string& name) {
    for (std::size_t i = 0; i < ports.size(); ++i)
      if (ports[i].name == name) return i;
    throw std::runtime_error("no port " + name);
  }
};

class VirtualSubject : public Subject {
 public:
  explicit VirtualSubject(std::unique_ptr<PartBench> bench)
      : Subject(*bench->part), bench_(std::move(bench)) {}
  void run(double seconds) override { bench_->run(seconds); }
  std::vector<double>& inputs() override { return bench_->inputs; }
  const std::vector<double>& outputs() const override { return bench_->outputs; }
  PartBench& mechanics() override { return *bench_; }

 private:
  std::unique_ptr<PartBench> bench_;
};

class RealSubject : public Subject {
 public:
  explicit RealSubject(std::unique_ptr<RealBench> bench) : Subject(*bench->part), bench_(std::move(bench)) {}
  void run(double seconds) override { bench_->run(seconds); }
  std::vector<double>& inputs() override { return bench_->inputs; }
  const std::vector<double>& outputs() const override { return bench_->outputs; }
  PartBench& mechanics() override { return bench_->behind; }

 private:
  std::unique_ptr<RealBench> bench_;
};

enum class Kind { kVirtual, kRealOverSerial, kRealOverCan };

std::unique_ptr<Subject> make_subject(Kind kind, const std::string& more = "") {
  if (kind == Kind::kVirtual)
    return std::make_unique<VirtualSubject>(
        std::make_unique<PartBench>("amtec_arm", arm_context(0.001, 0.1, 0.017, further(more))));
  const auto framing =
      kind == Kind::kRealOverCan ? powercube::BusFraming::kCan : powercube::BusFraming::kSerial;
  return std::make_unique<RealSubject>(std::make_unique<RealBench>(framing, more, more));
}

class Contract : public testing::TestWithParam<Kind> {
 protected:
  std::unique_ptr<Subject> arm(const std::string& more = "") { return make_subject(GetParam(), more); }
};

TEST_P(Contract, PortsAndBlackboardsAreTheArms) {
  const auto arm = this->arm();
  const auto reference = make_subject(Kind::kVirtual);
  const auto& ours = arm->part.description();
  const auto& theirs = reference->part.description();
  EXPECT_EQ(ours.kind, theirs.kind);
  for (const auto member :
       {&protocol::PartDescription::controller_inputs, &protocol::PartDescription::sensor_outputs}) {
    ASSERT_EQ((ours.*member).size(), (theirs.*member).size());
    for (std::size_t i = 0; i < (ours.*member).size(); ++i) {
      const auto &a = (ours.*member)[i], &b = (theirs.*member)[i];
      EXPECT_EQ(std::tie(a.name, a.unit, a.minimum, a.maximum, a.group),
                std::tie(b.name, b.unit, b.minimum, b.maximum, b.group));
      EXPECT_NEAR(a.initial, b.initial, 1e-4) << a.name;
    }
  }
  // Only the virtual arm follows a trajectory by itself.
  ASSERT_EQ(ours.blackboards.size() + (GetParam() == Kind::kVirtual ? 0 : 1), theirs.blackboards.size());
  for (std::size_t i = 0; i < ours.blackboards.size(); ++i)
    EXPECT_EQ(ours.blackboards[i].name, theirs.blackboards[i].name);
}

TEST_P(Contract, NothingMovesAtStart) {
  const auto arm = this->arm();
  arm->run(0.5);
  EXPECT_EQ(arm->state(), PartState::kReady);
  for (int i = 1; i <= 7; ++i) EXPECT_NEAR(arm->joint(i), 0.1, 1e-3) << i;
}

TEST_P(Contract, GoesToTheDesiredAnglesAndSaysSo) {
  const auto arm = this->arm();
  for (int i = 1; i <= 7; ++i) arm->in("Desired Angle " + std::to_string(i)) = 0.1 + 0.02 * i;
  arm->run(0.3);
  EXPECT_EQ(arm->state(), PartState::kMoving);
  EXPECT_TRUE(arm->module(7) & bit::kMotion);
  ASSERT_TRUE(arm->wait_for(PartState::kReady, 4.0));
  for (int i = 1; i <= 7; ++i) {
    EXPECT_NEAR(arm->joint(i), 0.1 + 0.02 * i, 2e-3) << i;
    EXPECT_NEAR(arm->out("Actual Angle " + std::to_string(i)), 0.1 + 0.02 * i, 2e-3) << i;
    EXPECT_EQ(arm->module(i) & 0xFFFF, bit::kHomeOk | bit::kRampEnd) << i;
  }
}

TEST_P(Contract, KeepsToTheMaximumSpeed) {
  const auto arm = this->arm();
  arm->in("Maximum Speed 1") = 0.1;
  arm->in("Desired Angle 1") = 1.0;
  arm->run(1.5);
  EXPECT_NEAR(arm->out("Actual Speed 1"), 0.1, 0.005);
  arm->in("Maximum Speed 1") = 0.2;  // while it moves
  arm->run(1.0);
  EXPECT_NEAR(arm->out("Actual Speed 1"), 0.2, 0.01);
  arm->in("Maximum Speed 1") = 0.0;
  arm->run(0.5);
  EXPECT_NEAR(arm->out("Actual Speed 1"), 0.0, 0.002);
}

TEST_P(Contract, MovesBothFingersAlikeAndRefusesOtherwise) {
  const auto arm = this->arm();
  arm->in("Desired Finger Position 1") = 0.025;
  EXPECT_THAT(arm->part.refuse(arm->inputs()).value_or(""), HasSubstr("must be equal"));
  arm->in("Desired Finger Position 2") = 0.025;
  EXPECT_EQ(arm->part.refuse(arm->inputs()), std::nullopt);
  arm->run(2.0);
  EXPECT_NEAR(arm->out("Actual Finger Position 1"), 0.025, 1e-3);
  EXPECT_EQ(arm->out("Actual Finger Position 1"), arm->out("Actual Finger Position 2"));
  EXPECT_EQ(arm->module(8), arm->module(9));
}

TEST_P(Contract, CountersTakeWholeNumbers) {
  const auto arm = this->arm();
  arm->in("Halt") = 0.5;
  EXPECT_THAT(arm->part.refuse(arm->inputs()).value_or(""), HasSubstr("Halt takes whole numbers"));
}

TEST_P(Contract, ExecutionEnableStopsWithoutAFaultAndGoesOn) {
  const auto arm = this->arm();
  arm->in("Desired Angle 1") = 0.8;
  arm->run(0.8);
  arm->in("Execution Enable") = 0.0;
  arm->run(0.6);
  EXPECT_EQ(arm->state(), PartState::kDisabled);
  const double stood = arm->joint(1);
  EXPECT_LT(stood, 0.7);
  arm->in("Desired Angle 2") = 0.5;
  arm->bump("Home");
  arm->run(0.5);
  EXPECT_NEAR(arm->joint(1), stood, 1e-3);
  EXPECT_NEAR(arm->joint(2), 0.1, 2e-3);
  arm->in("Execution Enable") = 1.0;
  ASSERT_TRUE(arm->wait_for(PartState::kReady, 4.0));
  EXPECT_NEAR(arm->joint(1), 0.8, 2e-3);
  EXPECT_NEAR(arm->joint(2), 0.5, 2e-3);
}

TEST_P(Contract, HaltStandsUntilResetAndOldCommandsMoveNothing) {
  const auto arm = this->arm();
  arm->in("Desired Angle 1") = 1.0;
  arm->run(0.8);
  arm->bump("Halt");
  ASSERT_TRUE(arm->wait_for(PartState::kHalted, 1.0));
  arm->run(0.6);
  const double stood = arm->joint(1);
  EXPECT_TRUE(arm->module(1) & bit::kHalted);
  arm->in("Desired Angle 1") = -0.5;
  arm->run(0.5);
  EXPECT_NEAR(arm->joint(1), stood, 1e-3);
  arm->bump("Reset");
  ASSERT_TRUE(arm->wait_for(PartState::kReady, 1.0));
  arm->run(0.5);
  EXPECT_NEAR(arm->joint(1), stood, 1e-3) << "an old command";
  arm->in("Desired Angle 1") = 0.0;
  ASSERT_TRUE(arm->wait_for(PartState::kMoving, 0.5));
  ASSERT_TRUE(arm->wait_for(PartState::kReady, 5.0));
  EXPECT_NEAR(arm->joint(1), 0.0, 2e-3);
}

TEST_P(Contract, HomesOnCommandAndStandsThere) {
  const auto arm = this->arm();
  arm->bump("Home");
  ASSERT_TRUE(arm->wait_for(PartState::kHoming, 0.5));
  EXPECT_FALSE(arm->module(1) & bit::kHomeOk);
  ASSERT_TRUE(arm->wait_for(PartState::kReady, 20.0));
  for (int i = 1; i <= 7; ++i) {
    EXPECT_TRUE(arm->module(i) & bit::kHomeOk) << i;
    EXPECT_NEAR(arm->joint(i), 0.0, 2e-3) << i;
  }
  arm->run(0.5);
  EXPECT_NEAR(arm->joint(1), 0.0, 2e-3) << "what was desired before does not count";
}

TEST_P(Contract, HomeStopsWithoutExecutionEnable) {
  const auto arm = this->arm();
  arm->bump("Home");
  arm->run(0.3);
  ASSERT_EQ(arm->state(), PartState::kHoming);
  arm->in("Execution Enable") = 0.0;
  arm->run(0.6);
  const double stood = arm->joint(1);
  EXPECT_GT(stood, 0.01) << "it was not home yet";
  arm->run(0.5);
  EXPECT_NEAR(arm->joint(1), stood, 1e-3);
  EXPECT_FALSE(arm->module(1) & bit::kHomeOk);
  EXPECT_FALSE(arm->module(1) & bit::kError);
}

TEST_P(Contract, AFaultOfOneDriveEndsHomeForAllOfThem) {
  const auto arm = this->arm();
  arm->bump("Home");
  arm->run(0.1);
  ASSERT_EQ(arm->state(), PartState::kHoming);
  EXPECT_EQ(arm->part.set_parameter("Following Error Limit 3", 1e-4), std::nullopt);
  ASSERT_TRUE(arm->wait_for(PartState::kFault, 0.3));
  EXPECT_EQ(arm->part.set_parameter("Following Error Limit 3", 0.1), std::nullopt);
  arm->run(0.5);
  const double stood = arm->joint(1);
  EXPECT_GT(stood, 0.01) << "it was not home yet";
  arm->run(0.3);
  EXPECT_NEAR(arm->joint(1), stood, 1e-3);
  arm->bump("Reset");
  ASSERT_TRUE(arm->wait_for(PartState::kNotHomed, 1.0));
  arm->run(1.0);
  EXPECT_NEAR(arm->joint(1), stood, 1e-3) << "an old command";
  EXPECT_EQ(arm->state(), PartState::kNotHomed);
}

TEST_P(Contract, HaltWinsOverResetAndHomeInTheSameTick) {
  const auto arm = this->arm();
  arm->bump("Reset");
  arm->bump("Home");
  arm->bump("Halt");
  arm->run(1.0);
  EXPECT_EQ(arm->state(), PartState::kHalted);
  EXPECT_TRUE(arm->module(1) & bit::kHalted);
  EXPECT_NEAR(arm->joint(1), 0.1, 1e-3);
}

TEST_P(Contract, ResetAndHaltInTheSameTickEndAFaultAndHalt) {
  const auto arm = this->arm();
  arm->part.controller_lost();
  arm->run(0.3);
  ASSERT_EQ(arm->state(), PartState::kControllerLost);
  arm->bump("Reset");
  arm->bump("Halt");
  arm->run(0.5);
  EXPECT_EQ(arm->state(), PartState::kHalted);
  EXPECT_FALSE(arm->module(1) & bit::kError);
}

TEST_P(Contract, IsMovingFromTheCommandUntilItHasArrived) {
  const auto arm = this->arm();
  arm->in("Desired Angle 1") = 0.15;
  for (int tick = 0; tick < 250; ++tick) {
    arm->run(0.001);
    ASSERT_EQ(arm->state(), PartState::kMoving) << tick;
  }
  ASSERT_TRUE(arm->wait_for(PartState::kReady, 1.0));
  EXPECT_NEAR(arm->joint(1), 0.15, 2e-3);
}

TEST_P(Contract, NothingIsFollowedBeforeItIsHomed) {
  const auto arm = this->arm("homed: false");
  arm->run(0.1);
  EXPECT_EQ(arm->state(), PartState::kNotHomed);
  arm->in("Desired Angle 1") = 0.5;
  arm->run(0.5);
  EXPECT_NEAR(arm->joint(1), 0.1, 1e-3);
}

TEST_P(Contract, ALostControllerStopsTheArmUntilReset) {
  const auto arm = this->arm();
  for (int i = 1; i <= 7; ++i) arm->in("Desired Angle " + std::to_string(i)) = 1.0;
  arm->run(0.8);
  arm->part.controller_lost();
  arm->run(0.6);
  EXPECT_EQ(arm->state(), PartState::kControllerLost);
  const double stood = arm->joint(1);
  EXPECT_LT(stood, 0.8);
  EXPECT_TRUE(arm->module(1) & bit::kError);
  EXPECT_TRUE(arm->module(1) & bit::kCommError);
  arm->in("Desired Angle 1") = -1.0;
  arm->bump("Home");
  arm->run(0.5);
  EXPECT_NEAR(arm->joint(1), stood, 1e-3);
  arm->bump("Reset");
  ASSERT_TRUE(arm->wait_for(PartState::kReady, 1.0));
  EXPECT_FALSE(arm->module(1) & bit::kCommError);
}

TEST_P(Contract, ALostControllerCanBeBorneInstead) {
  const auto arm = this->arm();
  EXPECT_EQ(arm->part.set_parameter("On Controller Lost", std::string("hold")), std::nullopt);
  arm->in("Desired Angle 1") = 0.3;
  arm->run(0.2);
  arm->part.controller_lost();
  ASSERT_TRUE(arm->wait_for(PartState::kReady, 3.0));
  EXPECT_NEAR(arm->joint(1), 0.3, 2e-3);
}

TEST_P(Contract, AFaultOfOneDriveStopsTheOthersWithoutAFaultOfTheirOwn) {
  const auto arm = this->arm();
  for (int i = 1; i <= 7; ++i) arm->in("Desired Angle " + std::to_string(i)) = 1.5;
  arm->run(0.6);
  EXPECT_EQ(arm->part.set_parameter("Following Error Limit 3", 1e-4), std::nullopt);
  ASSERT_TRUE(arm->wait_for(PartState::kFault, 1.0));
  EXPECT_EQ(arm->part.set_parameter("Following Error Limit 3", 0.1), std::nullopt);
  arm->run(0.8);
  EXPECT_TRUE(arm->module(3) & bit::kTowError);
  EXPECT_FALSE(arm->module(1) & bit::kError);
  const double stood = arm->joint(1);
  EXPECT_LT(stood, 1.2);
  arm->run(0.3);
  EXPECT_NEAR(arm->joint(1), stood, 1e-3);
  arm->bump("Reset");
  ASSERT_TRUE(arm->wait_for(PartState::kReady, 1.0));
}

TEST_P(Contract, ACommandBeyondASoftLimitTripsIt) {
  const auto arm = this->arm();
  EXPECT_EQ(arm->part.set_parameter("Soft Limit Maximum 1", 0.3), std::nullopt);
  arm->run(0.1);
  arm->in("Desired Angle 1") = 1.0;
  ASSERT_TRUE(arm->wait_for(PartState::kFault, 4.0));
  EXPECT_TRUE(arm->module(1) & bit::kBeyondSoft);
  EXPECT_NEAR(arm->joint(1), 0.3, 0.02);
}

TEST_P(Contract, SettingsActAndAreToldAndOutOfRangeRefused) {
  const auto arm = this->arm();
  const auto value = [&](const std::string& name) {
    for (const auto& parameter : arm->part.parameters())
      if (parameter.name == name) return std::get<double>(parameter.value);
    return -1.0;
  };
  EXPECT_EQ(arm->part.set_parameter("Maximum Acceleration 1", 0.1), std::nullopt);
  EXPECT_EQ(value("Maximum Acceleration 1"), 0.1);
  EXPECT_THAT(arm->part.set_parameter("Maximum Acceleration 1", 100.0).value_or(""), HasSubstr("between"));
  EXPECT_THAT(arm->part.set_parameter("Soft Limit Maximum 1", 0.05).value_or(""), HasSubstr("stands at"));
  EXPECT_TRUE(arm->part.set_parameter("Maximum Acceleration 1", std::string("fast")));
  arm->run(0.1);
  arm->in("Desired Angle 1") = 1.0;
  arm->run(1.1);
  EXPECT_NEAR(arm->out("Actual Speed 1"), 0.11, 0.02);
}

INSTANTIATE_TEST_SUITE_P(Parts, Contract,
                         testing::Values(Kind::kVirtual, Kind::kRealOverSerial, Kind::kRealOverCan),
                         [](const auto& info) {
                           return info.param == Kind::kVirtual          ? "Virtual"
                                  : info.param == Kind::kRealOverSerial ? "RealOverSerial"
                                                                        : "RealOverCan";
                         });

}  // namespace
}  // namespace visum::test
