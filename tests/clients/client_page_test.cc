// The example at the top of visum.h, word for word as a program: this file includes nothing else of ours to
// use it.
#include "clients/cpp/visum.h"

#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "tests/clients/daemon_thread.h"

namespace {

double raise_first_joint(const std::string& address) {
  visum::Client client(address, {.name = "my_controller"});
  visum::Part arm = client.part("arm");
  arm.acquire();
  visum::Inputs desired = arm.inputs("Desired Angle");
  visum::Outputs actual = arm.outputs("Actual Angle");
  client.join();
  while (actual[0] < 0.5) {
    desired.set(0, actual[0] + 0.01);
    arm.write();            // posted, does not wait
    client.advance_ms(10);  // one wait per period: brings the part's sample along
  }
  arm.release();
  return actual[0];
}

TEST(ClientPage, TheExampleOfTheHeaderMovesTheArm) {
  visum::DaemonThread daemon(visum::scene::ClockKind::kLockstep);
  EXPECT_GE(raise_first_joint(daemon.address()), 0.5);
}

TEST(ClientPage, TheHeaderNeedsNothingOfOursBesideIt) {
  std::ifstream header(std::string(VISUM_SOURCE_DIR) + "/clients/cpp/visum.h");
  ASSERT_TRUE(header);
  for (std::string line; std::getline(header, line);) EXPECT_FALSE(line.starts_with("#include \"")) << line;
}

}  // namespace
