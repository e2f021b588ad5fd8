/* Moves module 1 of an arm on a serial line in steps, and waits between them in the way that it is told:
 *
 *   waits_program KIND DEVICE STEPS
 *
 * The module goes on while the program waits, so that where it is tells how long that was. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "clients/examples/serial_arm/modules.h"
#include "tests/clients/shim/waits.h"

int main(int argc, char** argv) {
  struct line line;
  uint32_t state;
  float position = 0.0f, sum = 0.0f;
  if (argc != 4) return 2;
  const struct kind* kind = kinds;
  while (kind->name && strcmp(kind->name, argv[1]) != 0) ++kind;
  if (!kind->name || !line_open(&line, argv[2], 38400)) return 2;
  line.timeout_ms = 5000; /* who is asked is there, in a slow world, too */
  if (!module_command(&line, 1, 0x00) || !module_get_word(&line, 1, PAR_STATE, &state)) return 3;
  for (int k = 1; k <= atoi(argv[3]); ++k) {
    if (!module_step(&line, 1, 0.002f * (float)k, 22, &position)) return 3;
    sum += position;
    kind->wait(20);
  }
  printf("%s: %.9g, %ld without an answer\n", kind->name, (double)sum, line.timeouts);
  line_close(&line);
  return 0;
}
