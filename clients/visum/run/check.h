// One check of a scenario, followed through a run. Main thread; the runner owns it.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "clients/visum/run/course.h"
#include "clients/visum/run/quantity.h"

namespace visum::run {

struct CheckResult {
  std::string name;
  std::string text;   // what is measured
  std::string bound;  // "below 0.01 m"
  std::string unit;
  bool passed = false;
  std::optional<double>
      value;  // at the end, the worst, or the best one, depending on the window; empty: no step fell in it
  double at_s = 0.0;                  // when it was measured
  std::string failure;                // empty if passed
  std::vector<double> limits{};       // values between which it holds, for plots
  std::vector<CoursePoint> course{};  // its values over time
  std::string words{};                // the value of a port in words, "HOME_OK MOTION"; empty: it has none
  // How far `value` is inside its bounds, in its unit; negative where it is outside. The robustness of signal
  // temporal logic, so far as a check's window goes. Empty where `value` is.
  std::optional<double> margin{};
};

// "0.25 m", or for a port with names "5 (fault)". Only where there is a value.
std::string value_text(const CheckResult& check, int digits);

class Check {
 public:
  // `spec` must outlive the check. Throws ConfigError if it names something that the world does not have.
  Check(const CheckSpec& spec, const Catalogue& catalogue);

  void tie_again(const Catalogue& catalogue);  // finds its bodies anew, after bodies came or went
  void observe(const Observation& now);
  CheckResult result() const;  // as of the last observation
  // True once nothing that comes can change whether it has passed.
  bool is_certain(double now_s) const;

 private:
  void keep(double value, double margin, double at_s);

  const CheckSpec& spec_;
  Quantity quantity_;
  std::optional<double> value_;
  Course course_;
  double margin_ = 0.0;
  double at_s_ = 0.0;
  bool held_ = false;  // as its window demands, so far
};

}  // namespace visum::run
