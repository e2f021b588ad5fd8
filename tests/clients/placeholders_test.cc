#include "clients/visum/run/placeholders.h"

#include <gtest/gtest.h>

namespace visum::run {
namespace {

const std::map<std::string, std::string> kValues{{"connect", "127.0.0.1:99"}, {"bin", "/b"}};

TEST(Placeholders, AreFilledIn) {
  EXPECT_EQ(fill_in("{bin}/x --connect={connect}", kValues), "/b/x --connect=127.0.0.1:99");
  EXPECT_EQ(fill_in("nothing", kValues), "nothing");
}

TEST(Placeholders, DoubledBracesAreBraces) {
  EXPECT_EQ(find_fault("{{a}}"), std::nullopt);
  EXPECT_EQ(fill_in("{{\"bin\": \"{bin}\"}}", kValues), "{\"bin\": \"/b\"}");
}

TEST(Placeholders, FaultsAreTold) {
  EXPECT_EQ(find_fault("{conect}"), "there is no placeholder 'conect'; did you mean 'connect'?");
  EXPECT_EQ(
      find_fault("{}"),
      "there is no placeholder ''; there are: connect, host, port, scenario_dir, scene, bin, seed, clock");
  EXPECT_EQ(find_fault("{bin"), "a '{' without its '}' (write '{{' for the brace itself)");
  EXPECT_EQ(find_fault("bin}"), "a '}' without its '{' (write '}}' for the brace itself)");
}

}  // namespace
}  // namespace visum::run
