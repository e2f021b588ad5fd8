#include "clients/mca/names.h"

#include <cctype>
#include <stdexcept>

namespace visum::mca {
namespace {

std::string_view trimmed(std::string_view text) {
  const auto is_blank = [](char c) { return std::isspace(static_cast<unsigned char>(c)) != 0; };
  while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
  return text;
}

}  // namespace

std::string natural_name(std::string_view enumerator) {
  const auto prefix = enumerator.find('_');
  if (prefix == std::string_view::npos || prefix + 1 == enumerator.size())
    throw std::invalid_argument("the enumerator '" + std::string(enumerator) +
                                "' has no prefix, as in eCI_DESIRED_ANGLE_1");
  std::string name;
  bool begins = true;
  for (const char c : enumerator.substr(prefix + 1)) {
    if (c == '_') {
      if (!begins) name += ' ';
      begins = true;
      continue;
    }
    const auto letter = static_cast<unsigned char>(c);
    name += static_cast<char>(begins ? std::toupper(letter) : std::tolower(letter));
    begins = false;
  }
  return name;
}

std::vector<std::string> port_names(std::string_view enumerators) {
  std::vector<std::string> names;
  std::string_view last;
  while (!enumerators.empty()) {
    const auto comma = enumerators.find(',');
    const auto enumerator = trimmed(enumerators.substr(0, comma));
    enumerators.remove_prefix(comma == std::string_view::npos ? enumerators.size() : comma + 1);
    if (enumerator.empty()) continue;  // a comma after the last one
    if (!last.empty()) names.push_back(natural_name(last));
    if (enumerator.find('=') != std::string_view::npos)
      throw std::invalid_argument("the enumerator '" + std::string(enumerator) +
                                  "' has a value; ports are counted from 0");
    last = enumerator;
  }
  if (!last.ends_with("_DIMENSION"))
    throw std::invalid_argument("the last enumerator is '" + std::string(last) +
                                "'; it must end with _DIMENSION");
  return names;
}

}  // namespace visum::mca
