#include "clients/visum/run/reports.h"

#include <gmock/gmock.h>
#include <tinyxml2.h>

namespace visum::run {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

Report report() {
  Report report;
  report.name = "na<me & \"more\"";
  report.file = "s.yaml";
  report.scene = "scene.yaml";
  report.clock = "lockstep";
  report.seed = 7;
  report.ticks = 12000;
  report.sim_seconds = 12.0;
  report.wall_seconds = 0.4;
  report.state_hash = 0x9f01;
  report.checks.push_back({"good", "speed of box", "below 1 m/s", "m/s", true, 0.5, 2.0, ""});
  report.checks.push_back(
      {"bad", "tilt of box", "below 1 rad", "rad", false, 1.5, 3.0, "tilt must be below 1 rad"});
  report.controllers.push_back({"one", "exited with code 0", "", {"first \033[31mline", "]]> \xff second"}});
  return report;
}

class Junit {
 public:
  explicit Junit(const Report& report) {
    EXPECT_EQ(document_.Parse(report_junit(report).c_str()), tinyxml2::XML_SUCCESS) << report_junit(report);
  }
  const tinyxml2::XMLElement& suite() {
    return *document_.FirstChildElement("testsuites")->FirstChildElement("testsuite");
  }
  const tinyxml2::XMLElement* find_case(const std::string& name) {
    for (auto* one = suite().FirstChildElement("testcase"); one; one = one->NextSiblingElement("testcase")) {
      if (name == one->Attribute("name")) return one;
    }
    return nullptr;
  }

 private:
  tinyxml2::XMLDocument document_;
};

TEST(ReportJunit, IsWellFormedWhateverNamesAndOutputHold) {
  Junit junit(report());
  EXPECT_STREQ(junit.suite().Attribute("name"), "na<me & \"more\"");
  EXPECT_THAT(junit.find_case("controller one")->FirstChildElement("system-out")->GetText(),
              HasSubstr("]]> ? second"));
}

TEST(ReportJunit, HasACasePerCheckAndCounts) {
  Junit junit(report());
  EXPECT_EQ(junit.suite().IntAttribute("tests"), 4);
  EXPECT_EQ(junit.suite().IntAttribute("failures"), 1);
  EXPECT_EQ(junit.suite().IntAttribute("errors"), 0);
  EXPECT_EQ(junit.find_case("good")->FirstChildElement("failure"), nullptr);
  EXPECT_STREQ(junit.find_case("bad")->FirstChildElement("failure")->Attribute("message"),
               "tilt must be below 1 rad");
}

TEST(ReportJunit, KeepsTheStateHashAsAProperty) {
  Junit junit(report());
  const auto* properties = junit.suite().FirstChildElement("properties");
  bool found = false;
  for (auto* one = properties->FirstChildElement(); one; one = one->NextSiblingElement()) {
    if (std::string("state_hash") != one->Attribute("name")) continue;
    EXPECT_STREQ(one->Attribute("value"), "0000000000009f01");
    found = true;
  }
  EXPECT_TRUE(found);
}

TEST(ReportJunit, WhatABrokenRunDidNotReachIsSkipped) {
  Report broken = report();
  broken.code = cli::kLost;
  broken.error = "lost";
  broken.checks[1].value.reset();
  Junit junit(broken);
  EXPECT_EQ(junit.suite().IntAttribute("errors"), 1);
  EXPECT_EQ(junit.suite().IntAttribute("skipped"), 1);
  EXPECT_EQ(junit.suite().IntAttribute("failures"), 0);
  EXPECT_STREQ(junit.find_case("the run goes to its end")->FirstChildElement("error")->Attribute("message"),
               "lost");
}

TEST(ReportJson, IsTheLineThatScriptsRelyOn) {
  EXPECT_EQ(
      report_json(report()),
      R"({"passed":true,"valid":true,"ticks":12000,"sim_seconds":12.0,"wall_seconds":0.4,"state_hash":"0000000000009f01"})");
}

TEST(ReportJson, HasALinePerCheck) {
  EXPECT_EQ(checks_json(report()),
            "{\"check\":\"good\",\"passed\":true,\"value\":0.5,\"unit\":\"m/s\",\"bound\":\"below 1 "
            "m/s\",\"at_s\":2}\n"
            "{\"check\":\"bad\",\"passed\":false,\"value\":1.5,\"unit\":\"rad\",\"bound\":\"below 1 "
            "rad\",\"at_s\":3}\n");
}

TEST(ReportText, ShowsMeasuredValueBesideItsBound) {
  Report failed = report();
  failed.code = cli::kFailed;
  const std::string text = report_text(failed, cli::Style(false));
  EXPECT_THAT(text, HasSubstr("  passed  good  speed of box 0.5 m/s at 2.000 s, must be below 1 m/s\n"));
  EXPECT_THAT(text, HasSubstr("  FAILED  bad   tilt of box 1.5 rad at 3.000 s, must be below 1 rad\n"));
  EXPECT_THAT(
      text,
      HasSubstr(
          "12.000 s simulated in 0.400 s (30 x real time), 12000 ticks,\n  state hash 0000000000009f01\n"));
  EXPECT_THAT(text, HasSubstr("FAILED: 1 of 2 checks"));
}

TEST(ReportText, ChecksFitATerminalOf80Columns) {
  Report failed = report();
  failed.code = cli::kFailed;
  failed.scene = "a/folder/with/a/long/name/and/a/scene.yaml";
  failed.checks[0].name = "the box stands on its spot and does not move any more";
  const std::string text = report_text(failed, cli::Style(false));
  std::size_t begin = 0;
  for (std::size_t end = text.find('\n'); end != std::string::npos; end = text.find('\n', begin)) {
    EXPECT_LE(end - begin, 80u) << text.substr(begin, end - begin);
    begin = end + 1;
  }
  EXPECT_THAT(text, HasSubstr("  passed  the box stands on its spot and does not move any more\n"
                              "          speed of box 0.5 m/s at 2.000 s, must be below 1 m/s\n"));
}

TEST(ReportText, KeepsAMessageOnOneLineForThoseWhoSearchLogs) {
  Report failed = report();
  failed.failures = {
      "/tmp/a/folder/scenario.yaml:5: timeline[0]: this entry never came due, which is a long line"};
  EXPECT_THAT(report_text(failed, cli::Style(false)),
              HasSubstr("  FAILED  " + failed.failures.front() + "\n"));
}

TEST(ReportText, ShowsTheLastLinesOfAControllerThatFailed) {
  Report failed = report();
  failed.controllers[0].failure = "exited with code 3";
  const std::string text = report_text(failed, cli::Style(false));
  EXPECT_THAT(text, HasSubstr("    | first \\x1b[31mline\n")) << "shows what would steer the terminal";
}

TEST(ReportText, NotesTicksWhoseWorkMetALimitAndWhoFellShort) {
  Report limited = report();
  EXPECT_THAT(report_text(limited, cli::Style(false)), Not(HasSubstr("limit")));
  EXPECT_THAT(report_json(limited), Not(HasSubstr("limited_ticks")));
  limited.limited_ticks = 12;
  limited.limited_bodies = {"arm/hand", "box"};
  EXPECT_THAT(report_text(limited, cli::Style(false)), HasSubstr("note: 12 ticks met the limit"));
  EXPECT_THAT(report_text(limited, cli::Style(false)), HasSubstr("arm/hand, box"));
  EXPECT_THAT(report_json(limited), HasSubstr("\"limited_ticks\":12"));
}

}  // namespace
}  // namespace visum::run
