#include "clients/visum/common/numbers.h"

#include <cmath>
#include <sstream>
#include <stdexcept>

#include "clients/visum/common/exit_code.h"

namespace visum::cli {
namespace {

// False: the text is not a finite number, or not that alone.
bool read_number(const std::string& text, double& number) {
  std::size_t read = 0;
  try {
    number = std::stod(text, &read);
  } catch (const std::logic_error&) {
    return false;
  }
  return read == text.size() && std::isfinite(number);
}

}  // namespace

std::vector<double> parse_numbers(const std::string& text, std::size_t least, std::size_t most,
                                  const std::string& form) {
  std::vector<double> numbers;
  std::istringstream words(text);
  bool good = true;
  for (std::string word; std::getline(words, word, ',');)
    good = good && read_number(word, numbers.emplace_back());
  if (!good || text.ends_with(',') || (numbers.size() != least && numbers.size() != most))
    throw ExitError(kUsage, "'" + text + "' must be " + form);
  return numbers;
}

std::vector<double> parse_pose(const std::string& text, bool& turned) {
  auto pose = parse_numbers(text, 3, 6, "X,Y,Z or X,Y,Z,ROLL,PITCH,YAW");
  turned = pose.size() == 6;
  pose.resize(6);
  const double cr = std::cos(pose[3] / 2), sr = std::sin(pose[3] / 2), cp = std::cos(pose[4] / 2),
               sp = std::sin(pose[4] / 2), cy = std::cos(pose[5] / 2), sy = std::sin(pose[5] / 2);
  return {pose[0],
          pose[1],
          pose[2],
          cr * cp * cy + sr * sp * sy,
          sr * cp * cy - cr * sp * sy,
          cr * sp * cy + sr * cp * sy,
          cr * cp * sy - sr * sp * cy};
}

std::pair<std::string, double> parse_named_number(const std::string& word, const std::string& example) {
  const auto at = word.find('=');
  double number = 0.0;
  if (at == 0 || at == std::string::npos || !read_number(word.substr(at + 1), number))
    throw ExitError(kUsage, "'" + word + "' must be NAME=NUMBER, as in " + example);
  return {word.substr(0, at), number};
}

}  // namespace visum::cli
