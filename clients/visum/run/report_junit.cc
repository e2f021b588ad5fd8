#include "clients/visum/run/report_junit.h"

#include <algorithm>

#include "clients/visum/common/format.h"
#include "clients/visum/common/utf8.h"

namespace visum::run {
namespace {

// XML 1.0 has no way to write most control characters; they become '?'.
std::string escaped(const std::string& text) {
  std::string xml;
  for (const char c : cli::valid_utf8(text)) {
    switch (c) {
      case '&':
        xml += "&amp;";
        break;
      case '<':
        xml += "&lt;";
        break;
      case '>':
        xml += "&gt;";
        break;
      case '"':
        xml += "&quot;";
        break;
      case '\n':
        xml += "&#10;";
        break;
      default: {
        const auto byte = static_cast<unsigned char>(c);
        xml += (byte < 0x20 && c != '\t') || byte == 0x7f ? '?' : c;
      }
    }
  }
  return xml;
}

std::string attribute(const char* name, const std::string& value) {
  return std::string(" ") + name + "=\"" + escaped(value) + "\"";
}

class Suite {
 public:
  explicit Suite(const Report& report) : report_(report), class_(attribute("classname", report.name)) {
    add_run();
    for (const auto& check : report.checks) add_check(check);
    for (const auto& controller : report.controllers) add_controller(controller);
  }

  std::string text() const {
    const std::string counts =
        attribute("tests", std::to_string(cases_)) + attribute("failures", std::to_string(failures_)) +
        attribute("errors", std::to_string(errors_)) + attribute("skipped", std::to_string(skipped_));
    const std::string time = attribute("time", cli::fixed(report_.wall_seconds, 3));
    return "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites" + counts + time + ">\n  <testsuite" +
           attribute("name", report_.name) + counts + time + ">\n" + properties() + body_ +
           "  </testsuite>\n</testsuites>\n";
  }

 private:
  std::string properties() const {
    std::string text = "    <properties>\n";
    const auto add = [&](const char* name, const std::string& value) {
      text += "      <property" + attribute("name", name) + attribute("value", value) + "/>\n";
    };
    add("scenario", report_.file);
    add("scene", report_.scene);
    add("clock", report_.clock);
    if (!report_.engine.empty()) add("engine", report_.engine);
    if (report_.seed >= 0) add("seed", std::to_string(report_.seed));
    add("ticks", std::to_string(report_.ticks));
    add("sim_seconds", cli::exact(report_.sim_seconds));
    add("state_hash", cli::hex(report_.state_hash));
    return text + "    </properties>\n";
  }

  void add_case(const std::string& name, const std::string& content) {
    ++cases_;
    body_ += "    <testcase" + class_ + attribute("name", name) + attribute("time", "0.000");
    body_ += content.empty() ? "/>\n" : ">\n" + content + "    </testcase>\n";
  }

  std::string failure(const std::string& message) {
    ++failures_;
    return "      <failure" + attribute("message", message) + "/>\n";
  }

  std::string skipped() {
    ++skipped_;
    return "      <skipped message=\"the run did not come to it\"/>\n";
  }

  void add_run() {
    std::string content;
    if (!report_.error.empty()) {
      ++errors_;
      content += "      <error" + attribute("message", report_.error) + "/>\n";
    } else if (!report_.failures.empty()) {
      std::string all;
      for (const auto& one : report_.failures) all += (all.empty() ? "" : "; ") + one;
      content += failure(all);
    }
    add_case("the run goes to its end", content);
  }

  void add_check(const CheckResult& check) {
    // What the run did not come to is neither good nor bad; the run's own case tells why.
    const bool not_reached = !check.value && !report_.error.empty();
    std::string content = check.passed ? std::string() : not_reached ? skipped() : failure(check.failure);
    if (check.value) {
      content += "      <system-out>" +
                 escaped(check.text + " " + cli::exact(*check.value) + " " + check.unit + " at " +
                         cli::fixed(check.at_s, 3) + " s") +
                 "</system-out>\n";
    }
    add_case(check.name, content);
  }

  void add_controller(const ControllerResult& controller) {
    std::string content = controller.failure.empty() ? std::string() : failure(controller.failure);
    std::string output;
    for (const auto& line : controller.last_lines) output += line + "\n";
    content += "      <system-out>" + escaped(output + controller.end) + "</system-out>\n";
    add_case("controller " + controller.name, content);
  }

  const Report& report_;
  std::string class_;
  std::string body_;
  int cases_ = 0, failures_ = 0, errors_ = 0, skipped_ = 0;
};

}  // namespace

std::string report_junit(const Report& report) {
  return Suite(report).text();
}

}  // namespace visum::run
