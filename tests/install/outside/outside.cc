// A controller on a page: moves the first joint of the part `arm` and prints where it came to.
// usage: outside HOST:PORT
#include <visum/visum.h>

#include <cstdio>

int main(int count, char** arguments) try {
  if (count != 2) return 2;
  visum::Client client(arguments[1], {.name = "outside"});
  visum::Part arm = client.part("arm");
  arm.acquire();
  visum::Inputs desired = arm.inputs("Desired Angle");
  visum::Outputs actual = arm.outputs("Actual Angle");
  client.join();
  const double start = actual[0];
  desired.set(0, start + 0.1);
  arm.write();
  for (int i = 0; i < 200; ++i) client.advance_ms(10);
  arm.release();
  std::printf("%.3f\n", actual[0] - start);
  return actual[0] - start > 0.09 && actual[0] - start < 0.11 ? 0 : 1;
} catch (const visum::Error& error) {
  std::fprintf(stderr, "outside: %s\n", error.what());
  return 1;
}
