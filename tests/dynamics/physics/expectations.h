// The accuracy that each engine really reaches in each case: upper bounds of its figures, a little above what
// was measured. Where a bound is above the case's demand, the engine is expected to miss the demand. The test
// and the table take this from here.
#pragma once

#include <string>
#include <vector>

#include "tests/dynamics/physics/case.h"
#include "tests/dynamics/physics/engine_rows.h"

namespace visum::physics {

struct Expectation {
  std::string id;              // of the case
  std::string row;             // of engine_rows()
  std::vector<double> bounds;  // by figure; empty: the case is not for this engine
  std::string reason;          // why not, if there are no bounds
};

// A figure that a row of the impulse engine with the direct solver is known to miss. All of its other figures
// reach the demand.
struct Miss {
  const char* id;      // of the case
  const char* figure;  // by name
  const char* row;
  const char* reason;
};

const std::vector<Expectation>& expectations();
const std::vector<Miss>& declared_misses();
// Null if there is none.
const Expectation* find_expectation(const std::string& id, const std::string& row);
// True if the row is expected to reach the demand of figure i. The case must be for this row.
bool is_expected_right(const Case& what, std::size_t i, const EngineRow& row);

}  // namespace visum::physics
