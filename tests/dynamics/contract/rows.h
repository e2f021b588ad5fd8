// The rows over which the contract suite runs: every engine of the table, with each of its step settings, and
// the accuracy that it really has. A new engine gets its line in rows.cc when it is added; EveryEngineHasARow
// demands it.
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/dynamics/lab.h"

namespace visum::dynamics::testing {

struct Accuracy {
  double free_fall_m;      // after 1 s
  double drive_law;        // relative error of a velocity under a drive
  double joint_gap_m;      // a pendulum's hinge
  double pendulum_energy;  // relative, over 10 s
  double contact_force;    // relative
  double slide;            // relative error of an acceleration
  double creep_m_per_s;    // of a body that should stick
  double grasp_slip_m;     // in 5 s
  double stack_drift_m;    // sideways, in 10 s
};

struct Row {
  std::string name;  // part of the test's name
  world::EngineSetting engine;
  Accuracy accuracy;

  friend void PrintTo(const Row& row, std::ostream* out) { *out << row.name; }
};

const std::vector<Row>& rows();

class Contract : public ::testing::TestWithParam<Row> {
 protected:
  const Accuracy& accuracy() const { return GetParam().accuracy; }
  ModelBuilder builder() const { return ModelBuilder(GetParam().engine); }
};

#define VISUM_INSTANTIATE_CONTRACT(suite)                               \
  INSTANTIATE_TEST_SUITE_P(Engines, suite, ::testing::ValuesIn(rows()), \
                           [](const auto& info) { return info.param.name; })

}  // namespace visum::dynamics::testing
