// What each engine honestly reaches in each case: upper bounds of its figures, a little above what was seen.
// An engine may be expected to miss a case's demand; the table shows where.
#pragma once

#include <string>
#include <vector>

namespace visum::physics {

struct Expectation {
  std::string id;              // of the case
  std::string row;             // of engine_rows()
  std::vector<double> bounds;  // by figure; empty: the case is not for this engine
  std::string reason;          // where there are no bounds: why not
};

const std::vector<Expectation>& expectations();
// Null where there is none.
const Expectation* find_expectation(const std::string& id, const std::string& row);

}  // namespace visum::physics
