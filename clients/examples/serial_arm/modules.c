#define _DEFAULT_SOURCE
#include "clients/examples/serial_arm/modules.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <string.h>
#include <termios.h>
#include <time.h>
#include <unistd.h>

enum { STX = 0x02, ETX = 0x03, DLE = 0x10, MAX_FRAME = 22 };
enum { SETPARAM = 0x08, GETPARAM = 0x0A, SETMOVE = 0x0B, DONE = 0x64, RAMP = 0x04, STEP_EXTENDED = 0x10 };

static speed_t speed_of(int baud) {
  switch (baud) {
    case 9600:
      return B9600;
    case 19200:
      return B19200;
    case 38400:
      return B38400;
    case 57600:
      return B57600;
    case 115200:
      return B115200;
    default:
      return B0;
  }
}

bool line_open(struct line* line, const char* device, int baud) {
  struct termios settings;
  const speed_t speed = speed_of(baud);
  memset(line, 0, sizeof *line);
  line->timeout_ms = 30;
  if (speed == B0) {
    errno = EINVAL;
    return false;
  }
  line->fd = open(device, O_RDWR | O_NOCTTY | O_CLOEXEC);
  if (line->fd < 0) return false;
  if (tcgetattr(line->fd, &settings) == 0) {
    cfmakeraw(&settings);
    settings.c_cflag |= CLOCAL | CREAD;
    if (cfsetspeed(&settings, speed) == 0 && tcsetattr(line->fd, TCSANOW, &settings) == 0) return true;
  }
  const int error = errno;
  close(line->fd);
  errno = error;
  return false;
}

void line_close(struct line* line) {
  close(line->fd);
}

static int escape(uint8_t byte, uint8_t* to) {
  if (byte != STX && byte != ETX && byte != DLE) {
    *to = byte;
    return 1;
  }
  to[0] = DLE;
  to[1] = (uint8_t)(byte + 0x80);
  return 2;
}

static int make_frame(int id, const uint8_t* data, int size, uint8_t frame[MAX_FRAME]) {
  const uint8_t header[2] = {(uint8_t)(0x04 | id >> 3), (uint8_t)((id & 7) << 5 | size)};
  unsigned sum = header[0] + header[1];
  int length = 0;
  frame[length++] = STX;
  for (int i = 0; i < 2; ++i) length += escape(header[i], frame + length);
  for (int i = 0; i < size; ++i) {
    length += escape(data[i], frame + length);
    sum += data[i];
  }
  length += escape((uint8_t)(sum + (sum >> 8)), frame + length);
  frame[length++] = ETX;
  return length;
}

static long now_ms(void) {
  struct timespec now;
  clock_gettime(CLOCK_MONOTONIC, &now);
  return now.tv_sec * 1000L + now.tv_nsec / 1000000L;
}

/* One frame, from behind its STX to before its ETX, without escapes. Its length, 0 at the time-out, -1:
 * broken. */
static int read_frame(struct line* line, long until, uint8_t body[MAX_FRAME]) {
  int length = -1; /* before the STX */
  bool escaped = false;
  for (;;) {
    uint8_t byte;
    const long left = until - now_ms();
    struct pollfd set = {line->fd, POLLIN, 0};
    const int ready = poll(&set, 1, left > 0 ? (int)left : 0);
    if (ready == 0) return 0;
    if (ready < 0 && errno == EINTR) continue;
    if (ready < 0 || read(line->fd, &byte, 1) != 1) return -1;
    if (byte == STX) {
      length = 0;
      escaped = false;
    } else if (length >= 0 && byte == ETX) {
      return length;
    } else if (length >= 0 && byte == DLE) {
      escaped = true;
    } else if (length >= 0) {
      if (length == MAX_FRAME) length = 0; /* noise */
      body[length++] = escaped ? (uint8_t)(byte - 0x80) : byte;
      escaped = false;
    }
  }
}

/* True if a frame is the answer to a request: same module, same command, same parameter. */
static bool answers(const uint8_t* body, int length, int id, const uint8_t* request, int size) {
  const int count = length - 3; /* without headers and checksum */
  if (count < 1 || count > MODULES_MAX_DATA || (body[0] & 0xFC) != 0x08) return false;
  if ((((body[0] & 3) << 3) | body[1] >> 5) != id || body[2] != request[0]) return false;
  return size < 2 || (count > 1 && body[3] == request[1]);
}

int line_request(struct line* line, int id, const uint8_t* data, int size, uint8_t answer[MODULES_MAX_DATA]) {
  uint8_t frame[MAX_FRAME], body[MAX_FRAME];
  const int length = make_frame(id, data, size, frame);
  const long until = now_ms() + line->timeout_ms;
  ++line->requests;
  tcflush(line->fd, TCIFLUSH); /* what came too late for the last request */
  if (write(line->fd, frame, (size_t)length) != length) return -1;
  for (;;) {
    const int got = read_frame(line, until, body);
    if (got == 0) ++line->timeouts;
    if (got <= 0) return got;
    if (!answers(body, got, id, data, size)) continue;
    memcpy(answer, body + 2, (size_t)(got - 3));
    return got - 3;
  }
}

bool line_broadcast(struct line* line, uint8_t command) {
  uint8_t frame[MAX_FRAME];
  const uint8_t data[2] = {command, 0};
  const int length = make_frame(0, data, 2, frame);
  return write(line->fd, frame, (size_t)length) == length;
}

bool module_command(struct line* line, int id, uint8_t command) {
  uint8_t answer[MODULES_MAX_DATA];
  return line_request(line, id, &command, 1, answer) == 1;
}

static uint32_t little_endian(const uint8_t* bytes, int count) {
  uint32_t value = 0;
  for (int i = 0; i < count; ++i) value |= (uint32_t)bytes[i] << (8 * i);
  return value;
}

static void put_float(float value, uint8_t* to) {
  uint32_t bits;
  memcpy(&bits, &value, sizeof bits);
  for (int i = 0; i < 4; ++i) to[i] = (uint8_t)(bits >> (8 * i));
}

static float get_float(const uint8_t* from) {
  const uint32_t bits = little_endian(from, 4);
  float value;
  memcpy(&value, &bits, sizeof value);
  return value;
}

bool module_get_word(struct line* line, int id, uint8_t parameter, uint32_t* value) {
  const uint8_t request[2] = {GETPARAM, parameter};
  uint8_t answer[MODULES_MAX_DATA];
  const int size = line_request(line, id, request, 2, answer);
  if (size < 3 || size > 6) return false;
  *value = little_endian(answer + 2, size - 2);
  return true;
}

bool module_get_float(struct line* line, int id, uint8_t parameter, float* value) {
  const uint8_t request[2] = {GETPARAM, parameter};
  uint8_t answer[MODULES_MAX_DATA];
  if (line_request(line, id, request, 2, answer) != 6) return false;
  *value = get_float(answer + 2);
  return true;
}

bool module_set_float(struct line* line, int id, uint8_t parameter, float value) {
  uint8_t request[6] = {SETPARAM, parameter}, answer[MODULES_MAX_DATA];
  put_float(value, request + 2);
  return line_request(line, id, request, 6, answer) == 3 && answer[2] == DONE;
}

bool module_ramp(struct line* line, int id, float target, float speed, float acceleration) {
  uint8_t request[6] = {SETMOVE, RAMP}, answer[MODULES_MAX_DATA];
  put_float(target, request + 2);
  return module_set_float(line, id, PAR_TARGET_SPEED, speed) &&
         module_set_float(line, id, PAR_TARGET_ACCELERATION, acceleration) &&
         line_request(line, id, request, 6, answer) == 3 && answer[2] == DONE;
}

bool module_step(struct line* line, int id, float target, unsigned ms, float* position) {
  uint8_t request[8] = {SETMOVE, STEP_EXTENDED}, answer[MODULES_MAX_DATA];
  put_float(target, request + 2);
  request[6] = (uint8_t)ms;
  request[7] = (uint8_t)(ms >> 8);
  if (line_request(line, id, request, 8, answer) != 8) return false;
  *position = get_float(answer + 2);
  return true;
}
