// Finds functions by their braces. This is no parser: a brace that opens at file, namespace or class level
// after a parameter list is taken for a function's. That is right for code that clang-format has formatted.
#include <regex>

#include "tests/architecture/checks.h"

namespace visum::architecture {
namespace {

enum class Block { kNamespace, kType, kFunction, kOther };

// Lines without comments, strings and preprocessor directives, so that braces in them do not count.
class Stripper {
 public:
  std::string strip(const std::string& line) {
    std::string out;
    if (!in_comment_ && line.find_first_not_of(" \t") != std::string::npos &&
        line[line.find_first_not_of(" \t")] == '#')
      return out;
    for (std::size_t i = 0; i < line.size(); ++i) i = take(line, i, out);
    quote_ = 0;
    return out;
  }

 private:
  // Consumes the text that begins at i and returns the index of its last character.
  std::size_t take(const std::string& line, std::size_t i, std::string& out) {
    if (!raw_end_.empty()) return skip_raw(line, i);
    const auto pair = line.substr(i, 2);
    if (in_comment_) {
      if (pair == "*/") in_comment_ = false;
      return pair == "*/" ? i + 1 : i;
    }
    if (quote_) {
      if (line[i] == '\\') return i + 1;
      if (line[i] == quote_) quote_ = 0;
      return i;
    }
    if (pair == "//") return line.size();
    if (pair == "/*") return in_comment_ = true, i + 1;
    if (pair == "R\"") return begin_raw(line, i);
    const bool digit_separator =
        line[i] == '\'' && i > 0 && std::isalnum(static_cast<unsigned char>(line[i - 1]));
    if ((line[i] == '"' || line[i] == '\'') && !digit_separator) return quote_ = line[i], i;
    out += line[i];
    return i;
  }

  std::size_t begin_raw(const std::string& line, std::size_t i) {
    const auto open = line.find('(', i);
    raw_end_ = ")" + line.substr(i + 2, open - i - 2) + "\"";
    return open == std::string::npos ? line.size() : open;
  }

  std::size_t skip_raw(const std::string& line, std::size_t i) {
    const auto end = line.find(raw_end_, i);
    if (end == std::string::npos) return line.size();
    const auto last = end + raw_end_.size() - 1;
    raw_end_.clear();
    return last;
  }

  bool in_comment_ = false;
  char quote_ = 0;
  std::string raw_end_;
};

Block block_of(const std::string& head, Block outer) {
  static const std::regex space_pattern(R"(\bnamespace\b|\bextern\b\s*$)");
  static const std::regex type_pattern(R"(\b(class|struct|union|enum)\b[^()]*$)");
  if (outer == Block::kFunction || outer == Block::kOther) return Block::kOther;
  if (std::regex_search(head, space_pattern)) return Block::kNamespace;
  if (std::regex_search(head, type_pattern)) return Block::kType;
  return head.find('(') != std::string::npos ? Block::kFunction : Block::kOther;
}

}  // namespace

std::vector<FunctionSpan> find_functions(const SourceFile& file) {
  std::vector<FunctionSpan> found;
  std::vector<std::pair<Block, int>> open;  // with the line of its brace
  std::string head;                         // the text since the last ; { or }
  Stripper stripper;
  for (std::size_t i = 0; i < file.lines.size(); ++i) {
    const int line = static_cast<int>(i) + 1;
    for (const char c : stripper.strip(file.lines[i]) + "\n") {
      if (c == '{')
        open.emplace_back(block_of(head, open.empty() ? Block::kNamespace : open.back().first), line);
      if (c == '}' && !open.empty()) {
        if (open.back().first == Block::kFunction) found.push_back({open.back().second, line});
        open.pop_back();
      }
      if (c == '{' || c == '}' || c == ';')
        head.clear();
      else
        head += c;
    }
  }
  return found;
}

}  // namespace visum::architecture
