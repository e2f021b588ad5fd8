#include "clients/visum/run/reports.h"

#include <algorithm>

#include "clients/visum/common/format.h"
#include "clients/visum/common/markup.h"

namespace visum::run {
namespace {

std::string attribute(const char* name, const std::string& value) {
  return std::string(" ") + name + "=\"" + cli::markup(value) + "\"";
}

struct Counts {
  int cases = 0, failures = 0, errors = 0, skipped = 0;
  double seconds = 0.0;

  void add(const Counts& more) {
    cases += more.cases;
    failures += more.failures;
    errors += more.errors;
    skipped += more.skipped;
    seconds += more.seconds;
  }
  std::string attributes() const {
    return attribute("tests", std::to_string(cases)) + attribute("failures", std::to_string(failures)) +
           attribute("errors", std::to_string(errors)) + attribute("skipped", std::to_string(skipped)) +
           attribute("time", cli::fixed(seconds, 3));
  }
};

class Suite {
 public:
  explicit Suite(const Report& report) : report_(report), class_(attribute("classname", title(report))) {
    counts_.seconds = report.wall_seconds;
    add_run();
    for (const auto& check : report.checks) add_check(check);
    for (const auto& controller : report.controllers) add_controller(controller);
  }

  std::string text() const {
    return "  <testsuite" + attribute("name", title(report_)) + counts_.attributes() + ">\n" + properties() +
           body_ + "  </testsuite>\n";
  }
  const Counts& counts() const { return counts_; }

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
    for (const auto& [name, value] : report_.swept) add(("sweep." + name).c_str(), value);
    if (!report_.recording.empty()) add("recording", report_.recording);
    if (!report_.recording_trouble.empty()) add("recording_trouble", report_.recording_trouble);
    add("ticks", std::to_string(report_.ticks));
    add("sim_seconds", cli::exact(report_.sim_seconds));
    add("state_hash", cli::hex(report_.state_hash));
    return text + "    </properties>\n";
  }

  void add_case(const std::string& name, const std::string& content) {
    ++counts_.cases;
    body_ += "    <testcase" + class_ + attribute("name", name) + attribute("time", "0.000");
    body_ += content.empty() ? "/>\n" : ">\n" + content + "    </testcase>\n";
  }

  std::string failure(const std::string& message) {
    ++counts_.failures;
    return "      <failure" + attribute("message", message) + "/>\n";
  }

  std::string skipped() {
    ++counts_.skipped;
    return "      <skipped message=\"the run did not come to it\"/>\n";
  }

  void add_run() {
    std::string content;
    if (!report_.error.empty()) {
      ++counts_.errors;
      content += "      <error" + attribute("message", report_.error) + "/>\n";
    } else if (!report_.failures.empty()) {
      std::string all;
      for (const auto& one : report_.failures) all += (all.empty() ? "" : "; ") + one;
      content += failure(all);
    }
    add_case("the run goes to its end", content);
  }

  void add_check(const CheckResult& check) {
    // A check that the run never reached is neither good nor bad; the run's own case says why.
    const bool not_reached = !check.value && !report_.error.empty();
    std::string content = check.passed ? std::string() : not_reached ? skipped() : failure(check.failure);
    if (check.value) {
      content += "      <system-out>" +
                 cli::markup(check.text + " " + cli::exact(*check.value) + " " + check.unit +
                             (check.words.empty() ? "" : " (" + check.words + ")") + " at " +
                             cli::fixed(check.at_s, 3) + " s") +
                 "</system-out>\n";
    }
    add_case(check.name, content);
  }

  void add_controller(const ControllerResult& controller) {
    std::string content = controller.failure.empty() ? std::string() : failure(controller.failure);
    std::string output;
    for (const auto& line : controller.last_lines) output += line + "\n";
    content += "      <system-out>" + cli::markup(output + controller.end) + "</system-out>\n";
    add_case("controller " + controller.name, content);
  }

  const Report& report_;
  std::string class_;
  std::string body_;
  Counts counts_;
};

}  // namespace

std::string report_junit(std::span<const Report> reports) {
  Counts all;
  std::string suites;
  for (const Report& report : reports) {
    const Suite suite(report);
    suites += suite.text();
    all.add(suite.counts());
  }
  return "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites" + all.attributes() + ">\n" + suites +
         "</testsuites>\n";
}

std::string report_junit(const Report& report) {
  return report_junit(std::span(&report, 1));
}

}  // namespace visum::run
