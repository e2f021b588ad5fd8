#include "protocol/config/expression.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "protocol/config/trig.h"
#include "protocol/config/unknown_name.h"

namespace visum::config {
namespace {

constexpr int kMaxNesting = 50;
constexpr const char* kPiName = "pi";

struct Function {
  const char* name;
  double (*one)(double);          // takes one number, or
  double (*two)(double, double);  // takes two
};
constexpr std::array<Function, 10> kFunctions{{
    {"abs", [](double x) { return std::abs(x); }, nullptr},
    {"ceil", [](double x) { return std::ceil(x); }, nullptr},
    {"cos", [](double x) { return sin_cos(x).cos; }, nullptr},
    {"floor", [](double x) { return std::floor(x); }, nullptr},
    {"max", nullptr, [](double x, double y) { return std::max(x, y); }},
    {"min", nullptr, [](double x, double y) { return std::min(x, y); }},
    {"round", [](double x) { return std::round(x); }, nullptr},
    {"sin", [](double x) { return sin_cos(x).sin; }, nullptr},
    {"sqrt", [](double x) { return std::sqrt(x); }, nullptr},
    {"tan", [](double x) { return tangent(x); }, nullptr},
}};

bool is_digit(char c) {
  return c >= '0' && c <= '9';
}
bool is_word(char c) {
  return is_digit(c) || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
}

const Function* find_function(std::string_view name) {
  const auto found = std::ranges::find_if(kFunctions, [&](const auto& f) { return name == f.name; });
  return found == kFunctions.end() ? nullptr : &*found;
}

// A recursive-descent parser that computes as it reads.
class Reader {
 public:
  Reader(std::string_view text, const LookUp& look_up) : text_(text), look_up_(look_up) {}

  double whole() {
    const double value = sum();
    if (at_ < text_.size()) fail("'" + std::string(text_.substr(at_)) + "' is not expected");
    return value;
  }

 private:
  [[noreturn]] void fail(const std::string& why) const { throw std::invalid_argument(why); }

  [[noreturn]] void fail_unknown(const std::string& function) const {
    std::vector<std::string> known;
    for (const Function& one : kFunctions) known.emplace_back(one.name);
    fail(unknown_name("function", function, known));
  }

  void skip_blanks() {
    while (at_ < text_.size() && text_[at_] == ' ') ++at_;
  }
  bool take(char c) {
    skip_blanks();
    if (at_ == text_.size() || text_[at_] != c) return false;
    ++at_;
    skip_blanks();
    return true;
  }

  double sum() {
    if (++nesting_ > kMaxNesting) fail("it is nested too deep");
    double value = product();
    for (;;) {
      if (take('+'))
        value += product();
      else if (take('-'))
        value -= product();
      else
        break;
    }
    --nesting_;
    return value;
  }

  double product() {
    double value = factor();
    for (;;) {
      if (take('*')) {
        value *= factor();
      } else if (take('/')) {
        value /= factor();
      } else if (take('%')) {
        const double divisor = factor();
        value -= divisor * std::floor(value / divisor);
      } else {
        return value;
      }
    }
  }

  double factor() {
    bool negative = false;
    while (take('-')) negative = !negative;
    const double value = operand();
    return negative ? -value : value;
  }

  double operand() {
    skip_blanks();
    if (take('(')) return closed(sum());
    if (at_ == text_.size()) fail("a number or a name is missing at its end");
    if (is_digit(text_[at_]) || text_[at_] == '.') return number();
    const std::string word = name();
    if (!take('(')) return word == kPiName ? std::numbers::pi : look_up_(word);
    return call(word);
  }

  double closed(double value) {
    if (!take(')')) fail("a ')' is missing");
    return value;
  }

  double number() {
    double value = 0.0;
    const auto [end, error] = std::from_chars(text_.data() + at_, text_.data() + text_.size(), value);
    if (error != std::errc()) fail("'" + std::string(text_.substr(at_)) + "' is no number");
    at_ = static_cast<std::size_t>(end - text_.data());
    skip_blanks();
    return value;
  }

  std::string name() {
    const std::size_t first = at_;
    while (at_ < text_.size() && is_word(text_[at_])) ++at_;
    if (at_ == first) fail("'" + std::string(text_.substr(at_)) + "' is not expected");
    return std::string(text_.substr(first, at_ - first));
  }

  double call(const std::string& word) {
    const Function* function = find_function(word);
    if (!function) fail_unknown(word);
    const double first = sum();
    if (function->one) return function->one(closed(first));
    if (!take(',')) fail("'" + word + "' takes two numbers");
    return function->two(first, closed(sum()));
  }

  std::string_view text_;
  const LookUp& look_up_;
  std::size_t at_ = 0;
  int nesting_ = 0;
};

}  // namespace

double evaluate(std::string_view text, const LookUp& look_up) {
  if (text.size() > kMaxExpressionBytes)
    throw std::invalid_argument("it is longer than " + std::to_string(kMaxExpressionBytes) + " bytes");
  const double value = Reader(text, look_up).whole();
  if (!std::isfinite(value)) throw std::invalid_argument("it has no finite value");
  return value;
}

bool is_variable_name(std::string_view text) {
  return !text.empty() && !is_digit(text.front()) && std::ranges::all_of(text, is_word);
}

bool is_reserved_name(std::string_view text) {
  return text == kPiName || find_function(text) != nullptr;
}

}  // namespace visum::config
