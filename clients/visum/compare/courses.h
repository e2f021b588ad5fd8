// Draws a port's values in two recordings over one time, as SVG, with a mark where they first differ.
#pragma once

#include <string>

#include "clients/visum/compare/recordings.h"

namespace visum::compare {

// Empty if there are fewer than two points. Pure.
std::string courses_svg(const PortDistance& port);

// For the page's <style>, which must also have --line and --bad.
inline constexpr const char* kCoursesStyle = R"(
.courses{max-width:760px;width:100%;display:block}.courses text{font-size:11px;fill:currentColor}
.courses .a{fill:none;stroke:#0072b2;stroke-width:1.6}.courses .b{fill:none;stroke:#d55e00;stroke-width:1.6;stroke-dasharray:6 3}
.courses .first{stroke:var(--bad)}.courses .frame{fill:none;stroke:var(--line)}
)";

}  // namespace visum::compare
