// The text for a name that nobody knows. Every "there is no X; did you mean Y?" comes from here, so that all
// programs say it in the same words. Pure functions; any thread.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace visum::config {

// "there is no part 'amr'; did you mean 'arm'?" Where no name is near, the known names follow if there are at
// most 8: "there is no part 'x'; there are: arm, scanner", or "there is no part 'x'; there is only 'arm'".
std::string unknown_name(std::string_view what, std::string_view name, const std::vector<std::string>& known);

// "; did you mean 'arm'?", or "" where no name is near: for texts that list the known names anyway.
std::string did_you_mean(std::string_view name, const std::vector<std::string>& known);

// The one of `known` that is nearest to `name` by edit distance. Nothing if even that one differs in more
// than a third of the letters of `name` (one letter in a short name): it is then hardly what was meant.
std::optional<std::string> nearest(std::string_view name, const std::vector<std::string>& known);

}  // namespace visum::config
