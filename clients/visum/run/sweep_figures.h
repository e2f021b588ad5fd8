// Pictures of a sweep for its HTML report, as SVG: a map of how many runs passed over the two parameters that
// matter most, and for each check its values over the parameter that matters most for it. Pure functions.
#pragma once

#include <cstddef>
#include <map>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace visum::run {

struct SweptRun {
  enum class Outcome { kPassed, kFailed, kInvalid };
  std::size_t run = 0;
  Outcome outcome = Outcome::kInvalid;
  std::vector<std::pair<std::string, std::string>> values;  // of the sweep, in its order
  std::string link;                                         // where more of this run is; empty: nowhere
  std::map<std::string, double> checks{};                   // finite values by the checks' names
};

struct FigureCheck {
  std::string name, unit, bound;
};

// Empty where nothing can be shown: fewer than two runs, or no parameter with two values. Parameters that are
// no numbers are shown only where they have few values.
std::string sweep_figures(std::span<const SweptRun> runs, std::span<const FigureCheck> checks);

// For the page's <style>, which must also have --line, --good and --bad.
inline constexpr const char* kFigureStyle = R"(
.figure{max-width:760px;width:100%;display:block;margin:.5em 0}.figure text{font-size:11px;fill:currentColor}
.figure .cell{stroke:var(--line)}.figure .axis{stroke:var(--line)}.figure .mean{fill:none;stroke:currentColor;stroke-width:1.3}
.figure .band{fill:currentColor;fill-opacity:.1}.figure .passed{fill:var(--good);fill-opacity:.7}
.figure .failed{fill:none;stroke:var(--bad);stroke-width:1.6}.figure .invalid{fill:none;stroke:currentColor;stroke-dasharray:2 2}
)";

}  // namespace visum::run
