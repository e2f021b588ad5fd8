// A controller that commands an angle in each of many cycles of 10 ms, with the C++ library, and reads
// blackboards: CONNECT CYCLES [BLACKBOARD...].
#include <cstdio>
#include <cstdlib>

#include "clients/cpp/visum.h"

int main(int argc, char** argv) try {
  if (argc < 3) return EXIT_FAILURE;
  const int cycles = std::atoi(argv[2]);
  visum::ClientOptions options;
  options.name = "cycles";
  visum::Client client(argv[1], options);
  visum::Part arm = client.part("arm");
  visum::Inputs desired = arm.input("Desired Angle 1");
  arm.acquire();
  client.join();
  for (int cycle = 0; cycle < cycles; ++cycle) {
    desired.set(0, 1e-3 * (cycle % 7));
    arm.write();
    client.advance_ms(10);
    arm.read();
    for (int i = 3; i < argc; ++i) arm.read_blackboard(argv[i]);
  }
  client.leave();
  arm.release();
  return EXIT_SUCCESS;
} catch (const visum::Error& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return EXIT_FAILURE;
}
