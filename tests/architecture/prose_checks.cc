// How comments and pages are written: their first word, and how wide their lines are.
#include <algorithm>
#include <cctype>
#include <optional>
#include <string_view>

#include "tests/architecture/checks.h"
#include "tests/architecture/rules.h"

namespace visum::architecture {
namespace {

using Lines = std::vector<std::string>;

std::string_view trimmed(std::string_view text, std::string_view of = " \t") {
  const auto first = text.find_first_not_of(of);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(of) - first + 1);
}

bool is_identifier(char c) {
  return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_';
}

// Counts characters, not bytes: continuation bytes of UTF-8 do not count.
std::size_t columns(std::string_view text) {
  return static_cast<std::size_t>(
      std::count_if(text.begin(), text.end(), [](unsigned char c) { return (c & 0xC0) != 0x80; }));
}

// The column at which the line's comment begins. The marker must stand at the line's start or after a blank,
// and not inside quotes. Only quotes that end in their own line are known: this is no parser.
std::optional<std::size_t> comment_start(std::string_view line, std::string_view marker) {
  char quote = 0;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const char c = line[i];
    if (quote != 0) {
      if (c == '\\')
        ++i;
      else if (c == quote)
        quote = 0;
    } else if (line.substr(i).starts_with(marker) && (i == 0 || line[i - 1] == ' ')) {
      return i;
    } else if (c == '"' || c == '`' || (c == '\'' && (i == 0 || !is_identifier(line[i - 1])))) {
      quote = c;  // an apostrophe in 1'000 opens nothing
    }
  }
  return std::nullopt;
}

// The words of the line's comment, without its marker. Python's """ and C's slash with a star count as
// markers, too, at the start of a line only.
std::optional<std::string_view> comment_text(std::string_view line, std::string_view marker) {
  if (const auto start = comment_start(line, marker))
    return trimmed(trimmed(line.substr(*start), marker.substr(0, 1)), " \t!<");
  const std::string_view text = trimmed(line);
  if (marker == "#" && text.starts_with("\"\"\"")) return trimmed(text, "\" ");
  if (marker == "//" && text.starts_with("/*")) return trimmed(text, "/*! ");
  return std::nullopt;
}

bool begins_block(const Lines& lines, std::size_t index, std::string_view marker) {
  const auto start = comment_start(lines[index], marker);
  if (!start || index == 0) return true;
  // A comment goes on where the line before has one in the same column, and a line of its own now.
  if (trimmed(std::string_view(lines[index]).substr(0, *start)) != "") return true;
  if (comment_start(lines[index - 1], marker) != start) return true;
  return comment_text(lines[index - 1], marker)->empty();  // a new paragraph
}

// Tells whether the comment's first sentence is a question. It may go on over several lines.
bool first_sentence_asks(const Lines& lines, std::size_t index, std::string_view marker) {
  for (std::size_t i = index; i < lines.size(); ++i) {
    const auto text = i == index ? comment_text(lines[i], marker).value_or("") : trimmed(lines[i], " \t/#*");
    for (std::size_t k = 0; k < text.size(); ++k) {
      if (text[k] == '?') return true;
      const bool ends = k + 1 == text.size() || text[k + 1] == ' ';
      if (ends && (text[k] == '.' || text[k] == '!' || text[k] == ';')) return false;
    }
    if (i > index && !comment_start(lines[i], marker)) return false;
  }
  return false;
}

std::optional<std::string> banned_opening(std::string_view text) {
  for (const std::string& word : banned_openings())
    if (text.starts_with(word) && (text.size() == word.size() || !is_identifier(text[word.size()])))
      return word;
  return std::nullopt;
}

std::string at(const std::string& path, std::size_t index) {
  return path + ":" + std::to_string(index + 1) + ": ";
}

// The width of the line for a reader: a link counts as its text, without the address behind it.
std::size_t columns_of_prose(std::string_view line) {
  std::string shown;
  while (!line.empty()) {
    const auto link = line.find("](");
    const auto end = link == std::string_view::npos ? link : line.find(')', link);
    if (end == std::string_view::npos) break;
    shown += line.substr(0, link + 1);
    line.remove_prefix(end + 1);
  }
  shown += line;
  return columns(shown);
}

// Tells whether the line may be as wide as it has to be: a row of a table, HTML, or an address alone.
bool is_free_of_width(std::string_view line) {
  const std::string_view text = trimmed(line, " \t>-*");
  const bool one_word = text.find(' ') == std::string_view::npos;
  return text.starts_with('|') || text.starts_with('<') || one_word;
}

}  // namespace

Findings check_comment_openings(const SourceTree& tree) {
  Findings found;
  for (const auto& [path, file] : tree.files) {
    const std::string_view marker = comment_marker(path);
    if (marker.empty()) continue;
    for (std::size_t i = 0; i < file.lines.size(); ++i) {
      const auto text = comment_text(file.lines[i], marker);
      const auto word = text ? banned_opening(*text) : std::nullopt;
      if (word && begins_block(file.lines, i, marker) && !first_sentence_asks(file.lines, i, marker))
        found.push_back(at(path, i) + "a comment begins with '" + *word +
                        "'; write a sentence: who does what to what, and why");
    }
  }
  return found;
}

Findings check_comment_widths(const SourceTree& tree) {
  Findings found;
  for (const auto& [path, file] : tree.files) {
    const std::string_view marker = comment_marker(path);
    if (marker.empty()) continue;
    for (std::size_t i = 0; i < file.lines.size(); ++i) {
      const std::string& line = file.lines[i];
      if (columns(line) > kMaxCommentColumns && comment_start(line, marker) &&
          line.find("://") == std::string::npos)
        found.push_back(at(path, i) + "a comment of " + std::to_string(columns(line)) +
                        " columns; wrap it at " + std::to_string(kMaxCommentColumns));
    }
  }
  return found;
}

Findings check_page_widths(const SourceTree& tree) {
  Findings found;
  for (const auto& [path, file] : tree.files) {
    if (extension_of(path) != ".md") continue;
    bool in_code = false;      // between ``` and ```
    bool in_indented = false;  // code that four blanks mark, after an empty line
    for (std::size_t i = 0; i < file.lines.size(); ++i) {
      const std::string_view line = file.lines[i];
      const bool fence = trimmed(line).starts_with("```");
      if (fence) in_code = !in_code;
      const bool after_empty_line = i == 0 || trimmed(file.lines[i - 1]).empty();
      in_indented = line.starts_with("    ") && (in_indented || after_empty_line);
      if (fence || in_code || in_indented || is_free_of_width(line)) continue;
      if (columns_of_prose(line) > kMaxPageColumns)
        found.push_back(at(path, i) + std::to_string(columns_of_prose(line)) + " columns; wrap it at " +
                        std::to_string(kMaxPageColumns));
    }
  }
  return found;
}

}  // namespace visum::architecture
