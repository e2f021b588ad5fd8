/* PowerCube modules on a serial line: frames, one request and its answer, and the few commands that a test
 * program needs. Speaks to real modules and to virtual ones alike. One thread; every call returns within its
 * time-out. */
#pragma once

#include <stdbool.h>
#include <stdint.h>

enum { MODULES_MAX_ID = 31, MODULES_MAX_DATA = 8 };

/* The state word (parameter 27). */
enum {
  STATE_ERROR = 0x00000001,
  STATE_HOME_OK = 0x00000002,
  STATE_HALTED = 0x00000004,
  STATE_MOTION = 0x00000800,
  STATE_RAMP_END = 0x00008000,
  STATE_INPROGRESS = 0x00010000
};

enum { CONFIG_LINEAR = 0x00020000 };

/* Parameters. */
enum {
  PAR_SERIAL = 0x1A,
  PAR_CONFIG = 0x1B,
  PAR_VERSION = 0x1D,
  PAR_STATE = 0x27,
  PAR_POSITION = 0x3C,
  PAR_MIN_POSITION = 0x45,
  PAR_MAX_POSITION = 0x46,
  PAR_MAX_SPEED = 0x48,
  PAR_TARGET_SPEED = 0x4F,
  PAR_TARGET_ACCELERATION = 0x50
};

struct line {
  int fd;
  int timeout_ms; /* for an answer */
  long requests, timeouts;
};

/* Opens a tty, raw, 8N1. False: errno has the reason; EINVAL also for an unknown baud rate. */
bool line_open(struct line* line, const char* device, int baud);
void line_close(struct line* line);

/* Sends a request of `size` bytes to module `id` and waits for the answer with the same command (and, for
 * those that have one, parameter). Returns the answer's size, 0 for none within the time-out, -1 if the line
 * is broken. */
int line_request(struct line* line, int id, const uint8_t* data, int size, uint8_t answer[MODULES_MAX_DATA]);
/* Sends a request to all modules. None answers. */
bool line_broadcast(struct line* line, uint8_t command);

/* Each of these returns false if no answer came, or an answer other than "done". */
bool module_command(struct line* line, int id, uint8_t command); /* 00 reset, 01 home, 02 halt */
bool module_get_word(struct line* line, int id, uint8_t parameter, uint32_t* value);
bool module_get_float(struct line* line, int id, uint8_t parameter, float* value);
bool module_set_float(struct line* line, int id, uint8_t parameter, float value);
/* Moves to `target` with these limits: rad or m, per s, per s^2. */
bool module_ramp(struct line* line, int id, float target, float speed, float acceleration);
/* Moves so that it is at `target` in `ms`. `position` is its place when the request came. */
bool module_step(struct line* line, int id, float target, unsigned ms, float* position);
