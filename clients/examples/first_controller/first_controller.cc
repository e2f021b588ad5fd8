// The controller of the main README: turns the arm's first joint to 0.5 rad.
// usage: visum-first-controller [HOST:PORT]
#include "clients/cpp/visum.h"

int main(int argc, char** argv) {
  visum::Client client(argc > 1 ? argv[1] : "127.0.0.1:1500", {.name = "first_controller"});
  visum::Part arm = client.part("arm");
  arm.acquire();  // the lease: the exclusive right to command the arm
  visum::Inputs desired = arm.inputs("Desired Angle");
  visum::Outputs actual = arm.outputs("Actual Angle");
  client.join();  // a world in lockstep waits for us from here on
  while (actual[0] < 0.5) {
    desired.set(0, actual[0] + 0.01);
    arm.write();
    client.advance_ms(10);  // returns after 10 ms of the world's time, with new readings
  }
  arm.release();
}
