/* A lab's test program for an arm of PowerCube modules on a serial line: finds the modules,
 * identifies and homes them, moves them on ramps and in steps at 50 Hz, halts and resets them, and says how
 * long all that took.
 *
 *   serial_arm DEVICE [BAUD] [TIME_SCALE]
 *
 * TIME_SCALE: how much faster than the wall clock the arm's time runs; 1 unless a simulation says otherwise.
 * Exit codes: 0 all went well, 1 something did not, 2 bad usage. */
#define _DEFAULT_SOURCE
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "clients/examples/serial_arm/modules.h"

struct module {
  int id;
  bool linear;
  float start; /* its place after homing: rad or m */
  float minimum, maximum, speed;
};

struct arm {
  struct line line;
  struct module modules[MODULES_MAX_ID];
  int count;
  double time_scale;
};

static double now(const struct arm* arm) {
  struct timespec time;
  clock_gettime(CLOCK_MONOTONIC, &time);
  return arm->time_scale * ((double)time.tv_sec + 1e-9 * (double)time.tv_nsec);
}

static void rest(const struct arm* arm, double seconds) {
  seconds /= arm->time_scale;
  struct timespec time = {(time_t)seconds, (long)(1e9 * (seconds - floor(seconds)))};
  while (nanosleep(&time, &time) != 0 && errno == EINTR) {
  }
}

static bool fail(const char* step, int id) {
  fprintf(stderr, "serial_arm: %s failed at module %d\n", step, id);
  return false;
}

static bool scan(struct arm* arm) {
  const double begin = now(arm);
  for (int id = 1; id <= MODULES_MAX_ID; ++id) {
    uint32_t version;
    if (module_get_word(&arm->line, id, PAR_VERSION, &version)) arm->modules[arm->count++].id = id;
  }
  printf("scan: %d modules in %.3f s\n", arm->count, now(arm) - begin);
  return arm->count > 0 || fail("scan", 0);
}

static bool identify(struct arm* arm) {
  for (int i = 0; i < arm->count; ++i) {
    struct module* module = &arm->modules[i];
    uint32_t version, serial, config;
    if (!module_get_word(&arm->line, module->id, PAR_VERSION, &version) ||
        !module_get_word(&arm->line, module->id, PAR_SERIAL, &serial) ||
        !module_get_word(&arm->line, module->id, PAR_CONFIG, &config) ||
        !module_get_float(&arm->line, module->id, PAR_MIN_POSITION, &module->minimum) ||
        !module_get_float(&arm->line, module->id, PAR_MAX_POSITION, &module->maximum) ||
        !module_get_float(&arm->line, module->id, PAR_MAX_SPEED, &module->speed))
      return fail("identify", module->id);
    module->linear = (config & CONFIG_LINEAR) != 0;
    printf("module %d: %s, firmware %x.%x.%x, serial number %u, %.3f to %.3f, at most %.3f/s\n", module->id,
           module->linear ? "linear" : "rotary", version >> 12, version >> 8 & 0xF, version & 0xFF, serial,
           (double)module->minimum, (double)module->maximum, (double)module->speed);
  }
  return true;
}

/* True if all modules have all of `bits` in their state, and no error. */
static bool wait_for(struct arm* arm, uint32_t bits, double seconds) {
  const double until = now(arm) + seconds;
  for (int i = 0; i < arm->count; ++i) {
    const int id = arm->modules[i].id;
    uint32_t state;
    do {
      if (!module_get_word(&arm->line, id, PAR_STATE, &state)) return fail("reading the state", id);
      if (state & STATE_ERROR || now(arm) > until) {
        fprintf(stderr, "serial_arm: module %d has the state %08x\n", id, state);
        return false;
      }
      if ((state & bits) != bits) rest(arm, 0.01);
    } while ((state & bits) != bits);
  }
  return true;
}

static bool command_all(struct arm* arm, uint8_t command, const char* name) {
  for (int i = 0; i < arm->count; ++i)
    if (!module_command(&arm->line, arm->modules[i].id, command)) return fail(name, arm->modules[i].id);
  return true;
}

static bool home(struct arm* arm) {
  const double begin = now(arm);
  if (!command_all(arm, 0x00, "reset") || !command_all(arm, 0x01, "home")) return false;
  if (!wait_for(arm, STATE_HOME_OK | STATE_RAMP_END, 100.0) || !command_all(arm, 0x00, "reset")) return false;
  printf("home: %.3f s\n", now(arm) - begin);
  rest(arm, 0.3); /* to come to rest */
  for (int i = 0; i < arm->count; ++i)
    if (!module_get_float(&arm->line, arm->modules[i].id, PAR_POSITION, &arm->modules[i].start))
      return fail("reading the position", arm->modules[i].id);
  return true;
}

/* A distance that every module can move from its place after homing. */
static float away(const struct module* module) {
  const float way = module->linear ? 0.01f : 0.3f;
  return module->start + way < module->maximum ? module->start + way : module->start - way;
}

static bool arrived(struct arm* arm, bool out, double within) {
  for (int i = 0; i < arm->count; ++i) {
    const struct module* module = &arm->modules[i];
    const float target = out ? away(module) : module->start;
    float position;
    if (!module_get_float(&arm->line, module->id, PAR_POSITION, &position))
      return fail("reading", module->id);
    if (fabs((double)(position - target)) > within) {
      fprintf(stderr, "serial_arm: module %d is at %.5f, not at %.5f\n", module->id, (double)position,
              (double)target);
      return false;
    }
  }
  return true;
}

static bool ramp(struct arm* arm, bool out) {
  const double begin = now(arm);
  for (int i = 0; i < arm->count; ++i) {
    const struct module* module = &arm->modules[i];
    const float speed = 0.8f * module->speed;
    if (!module_ramp(&arm->line, module->id, out ? away(module) : module->start, speed, 4.0f * speed))
      return fail("ramp", module->id);
  }
  if (!wait_for(arm, STATE_RAMP_END, 30.0)) return false;
  printf("ramp %s: %.3f s\n", out ? "out" : "back", now(arm) - begin);
  rest(arm, 0.3);
  return arrived(arm, out, 0.005);
}

/* A cosine out and back, as a stream of steps. */
static bool stream(struct arm* arm) {
  const double period = 0.02, length = 3.0, pi = 3.14159265358979;
  const double begin = now(arm);
  double worst = 0.0;
  for (int k = 1; k <= (int)(length / period); ++k) {
    const double share = 0.5 * (1.0 - cos(2.0 * pi * k * period / length));
    for (int i = 0; i < arm->count; ++i) {
      const struct module* module = &arm->modules[i];
      const float way = 0.5f * (away(module) - module->start);
      const float target = module->start + (float)share * way;
      float position;
      if (!module_step(&arm->line, module->id, target, 22, &position)) return fail("step", module->id);
      if (!module->linear) worst = fmax(worst, fabs((double)(target - position)));
    }
    const double left = begin + k * period - now(arm);
    if (left > 0.0) rest(arm, left);
  }
  printf("steps at 50 Hz: %d in %.3f s, never more than %.4f rad behind\n", (int)(length / period),
         now(arm) - begin, worst);
  rest(arm, 0.5);
  return wait_for(arm, STATE_RAMP_END, 5.0) && arrived(arm, false, 0.005);
}

static bool halt_and_reset(struct arm* arm) {
  for (int i = 0; i < arm->count; ++i) {
    const struct module* module = &arm->modules[i];
    if (!module_ramp(&arm->line, module->id, away(module), 0.5f * module->speed, 2.0f * module->speed))
      return fail("ramp", module->id);
  }
  rest(arm, 0.2);
  const double begin = now(arm);
  if (!command_all(arm, 0x02, "halt") || !wait_for(arm, STATE_HALTED | STATE_RAMP_END, 5.0)) return false;
  printf("halt: %.3f s\n", now(arm) - begin);
  if (module_ramp(&arm->line, arm->modules[0].id, arm->modules[0].start, 0.1f, 0.5f))
    return fail("refusing to move while halted", arm->modules[0].id);
  if (!command_all(arm, 0x00, "reset")) return false;
  printf("reset\n");
  return ramp(arm, false);
}

static int help(void) {
  puts(
      "Finds, homes and moves an arm of PowerCube modules on a serial line\n"
      "usage: visum-serial-arm DEVICE [BAUD] [TIME_SCALE]\n\n"
      "BAUD        the line's speed; 38400 by default\n"
      "TIME_SCALE  speed of the arm's time against the wall clock; 1 by default\n"
      "--help      prints this\n\n"
      "Moves the modules on ramps and in steps at 50 Hz, halts and resets them, and\n"
      "prints how long all that took.\n"
      "Exit codes: 0 all went well, 1 something did not, 2 bad usage.");
  return 0;
}

int main(int argc, char** argv) {
  static struct arm arm;
  if (argc == 2 && strcmp(argv[1], "--help") == 0) return help();
  const int baud = argc > 2 ? atoi(argv[2]) : 38400;
  arm.time_scale = argc > 3 ? atof(argv[3]) : 1.0;
  if (argc < 2 || argc > 4 || arm.time_scale <= 0.0) {
    fprintf(stderr, "usage: serial_arm DEVICE [BAUD] [TIME_SCALE]\n");
    return 2;
  }
  if (!line_open(&arm.line, argv[1], baud)) {
    fprintf(stderr, "serial_arm: cannot open '%s' with %d baud: %s\n", argv[1], baud, strerror(errno));
    return 2;
  }
  setvbuf(stdout, NULL, _IOLBF, 0);
  bool good = scan(&arm);
  arm.line.timeout_ms = 500; /* from here on, every module that is asked is there */
  good = good && identify(&arm) && home(&arm) && ramp(&arm, true) && ramp(&arm, false) && stream(&arm) &&
         halt_and_reset(&arm);
  printf("%ld requests, %ld without an answer\n%s\n", arm.line.requests, arm.line.timeouts,
         good ? "all well" : "not well");
  line_close(&arm.line);
  return good ? 0 : 1;
}
