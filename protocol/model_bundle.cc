#include "protocol/model_bundle.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <map>
#include <stdexcept>
#include <string_view>
#include <system_error>

#include "protocol/config/read_file.h"

namespace visum::protocol {
namespace {

namespace fs = std::filesystem;

constexpr std::array<std::string_view, 12> kTexts{".urdf", ".sdf", ".xml", ".mjcf", ".xacro", ".world",
                                                  ".yaml", ".yml", ".dae", ".obj",  ".mtl",   ".x3d"};

bool may_name_files(const fs::path& file) {
  std::string extension = file.extension().string();
  std::ranges::transform(extension, extension.begin(), [](unsigned char c) { return std::tolower(c); });
  return std::ranges::find(kTexts, extension) != kTexts.end();
}

// Without the comments of YAML and XML, which name files that nobody reads.
std::string without_comments(const std::string& text, bool is_yaml) {
  std::string kept;
  for (std::size_t at = 0; at < text.size();) {
    const auto begin = text.find(is_yaml ? "#" : "<!--", at);
    const bool is_comment = begin != text.npos && (!is_yaml || begin == 0 || text[begin - 1] == ' ' ||
                                                   text[begin - 1] == '\n' || text[begin - 1] == '\t');
    const auto up_to = begin == text.npos ? text.size() : begin + (is_comment ? 0 : 1);
    kept.append(text, at, up_to - at);
    at = up_to;
    if (is_comment) at = std::min(text.find(is_yaml ? "\n" : "-->", begin), text.size());
  }
  return kept;
}

// Words of a text that may be names of files: what stands in quotes, and what stands between blanks and
// brackets. Numbers are none.
template <typename Take>
void each_word(std::string_view text, const Take& take) {
  constexpr std::string_view kEnds = " \t\r\n\"'<>{}[](),=;";
  const auto try_word = [&](std::string_view word) {
    const bool is_name = word.find('.') != word.npos && word.size() <= kMostPathBytes &&
                         word.find_first_not_of("0123456789.+-eE") != word.npos &&
                         word.find('\0') == word.npos;
    if (is_name) take(std::string(word));
  };
  for (std::size_t at = 0; at < text.size();) {
    const auto end = std::min(text.find_first_of(kEnds, at), text.size());
    try_word(text.substr(at, end - at));
    at = end + 1;
    if (end >= text.size() || (text[end] != '"' && text[end] != '\'')) continue;
    const auto closing = text.find_first_of("\"'\n", at);
    if (closing != text.npos && text[closing] == text[end] && closing - at <= kMostPathBytes &&
        text.substr(at, closing - at).find(' ') != text.npos)
      try_word(text.substr(at, closing - at));  // a name with blanks; its words are tried, too
  }
}

// The file that a word names; empty: none.
fs::path file_named(std::string word, const fs::path& folder) {
  std::error_code error;
  if (word.starts_with("file://")) word.erase(0, 7);
  for (const std::string_view scheme : {"package://", "model://"}) {
    if (!word.starts_with(scheme)) continue;
    for (fs::path above = folder;; above = above.parent_path()) {
      const auto found = above / word.substr(scheme.size());
      if (fs::is_regular_file(found, error)) return found;
      if (above == above.parent_path()) return {};
    }
  }
  if (fs::path(word).is_absolute()) return {};
  const auto found = folder / word;
  return fs::is_regular_file(found, error) ? found : fs::path();
}

fs::path common_folder(const std::map<fs::path, std::string>& files) {
  fs::path common = files.begin()->first.parent_path();
  for (const auto& [file, content] : files) {
    const auto inside = [&common, &path = file] {
      const auto relative = path.lexically_relative(common);
      return !relative.empty() && *relative.begin() != "..";
    };
    while (!inside()) common = common.parent_path();
  }
  return common;
}

}  // namespace

SpawnModel bundle_of_model(const fs::path& file) {
  std::map<fs::path, std::string> files;
  std::vector<fs::path> open{fs::absolute(file).lexically_normal()};
  std::size_t bytes = 0;
  while (!open.empty()) {
    const auto next = open.back();
    open.pop_back();
    if (files.contains(next)) continue;
    auto content = config::read_file(next, kMostSentBytes);
    if (!content.fault.empty()) throw std::runtime_error(next.string() + ": " + content.fault);
    bytes += content.bytes.size() + kMostPathBytes;
    if (files.size() == kMostSentFiles || bytes > kMostSentBytes)
      throw std::runtime_error(file.string() + " and what it names are more than the " +
                               std::to_string(kMostSentFiles) + " files or " +
                               std::to_string(kMostSentBytes >> 20) + " MiB that can be sent");
    if (may_name_files(next))
      each_word(without_comments(content.bytes, next.extension().string().starts_with(".y")),
                [&](std::string word) {
                  const auto named = file_named(std::move(word), next.parent_path());
                  if (!named.empty()) open.push_back(named.lexically_normal());
                });
    files.emplace(next, std::move(content.bytes));
  }
  const auto common = common_folder(files);
  SpawnModel model;
  model.file = fs::absolute(file).lexically_normal().lexically_relative(common).string();
  for (auto& [path, content] : files)
    model.files.push_back({path.lexically_relative(common).string(), std::move(content)});
  return model;
}

}  // namespace visum::protocol
