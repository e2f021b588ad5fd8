// Numbers, poses and named numbers as they stand on the command line: "0.5,0,1", "joint=3".
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace visum::cli {

// The numbers of a list with commas; `least` to `most` of them. `form` says what is wanted, as "X,Y,Z".
// Throws ExitError(kUsage).
std::vector<double> parse_numbers(const std::string& text, std::size_t least, std::size_t most,
                                  const std::string& form);

// X,Y,Z or X,Y,Z,ROLL,PITCH,YAW (rad, about the fixed axes x, y, z in this order, as in URDF) as the
// protocol's seven numbers of a pose. `turned`: false where only a place was given; the quaternion is then 1.
std::vector<double> parse_pose(const std::string& text, bool& turned);

// "NAME=NUMBER"; `example` is shown where it is not. Throws ExitError(kUsage).
std::pair<std::string, double> parse_named_number(const std::string& word, const std::string& example);

}  // namespace visum::cli
