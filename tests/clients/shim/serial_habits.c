// Habits of programs that were written for real modules, on a serial line. `serial_habits HABIT DEVICE COUNT`
// does so COUNT times:
//
//   resend   writes a request, asks FIONREAD up to ten times with usleep(1000) between, and writes it again
//   bytes    asks, waits until all answers are there, and reads byte by byte with looks at the clock between
//   spun     the same, by a thread that has spun before
//   stale    polls for an answer, gets rid of it in one of several ways, and reads what is no longer there
//   scan     asks the modules 1 to 31 once, and spins for 0.93 s on each that is silent
//   serve    a server that drives the bus, and its client: two processes that talk over TCP by fgets()
#include <arpa/inet.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <poll.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <sys/uio.h>
#include <sys/wait.h>
#include <termios.h>
#include <unistd.h>

enum { STX = 0x02, ETX = 0x03, DLE = 0x10, MODULES = 31 };

static int line;

static int open_line(const char* device) {
  struct termios settings;
  line = open(device, O_RDWR | O_NOCTTY);
  if (line < 0 || tcgetattr(line, &settings) != 0) return 0;
  cfmakeraw(&settings);
  return tcsetattr(line, TCSANOW, &settings) == 0;
}

/* GET of a parameter, as libm5api makes it. Returns its size. */
static size_t make_request(unsigned char* out, int module, int parameter) {
  const unsigned char body[] = {(unsigned char)(0x04 | module >> 3), (unsigned char)((module & 7) << 5 | 2),
                                0x0A, (unsigned char)parameter};
  unsigned total = 0;
  size_t size = 0;
  out[size++] = STX;
  for (size_t i = 0; i <= sizeof body; ++i) {
    const unsigned char byte = i < sizeof body ? body[i] : (unsigned char)(total + (total >> 8));
    const int special = byte == STX || byte == ETX || byte == DLE;
    total += byte;
    if (special) out[size++] = DLE;
    out[size++] = (unsigned char)(special ? byte + 0x80 : byte);
  }
  out[size++] = ETX;
  return size;
}

static int send_request(int module, int parameter) {
  unsigned char request[16];
  const size_t size = make_request(request, module, parameter);
  return write(line, request, size) == (ssize_t)size;
}

static int waiting(void) {
  int count = 0;
  return ioctl(line, FIONREAD, &count) == 0 ? count : 0;
}

static int take_answer(void) {
  unsigned char bytes[64];
  return read(line, bytes, sizeof bytes) > 0;
}

static int resend(int count) {
  int resent = 0;
  for (int k = 0; k < count; ++k) {
    int there = 0;
    tcflush(line, TCIFLUSH);
    for (int attempt = 0; attempt < 5 && !there; ++attempt) {
      resent += attempt > 0;
      if (!send_request(1, 0x27)) return 1;
      for (int look = 0; look < 10 && !there; ++look) {
        usleep(1000);
        there = waiting() > 0;
      }
    }
    if (!there || !take_answer()) return 1;
  }
  printf("%d resent\n", resent);
  return 0;
}

static double now_s(void) {
  struct timeval now;
  gettimeofday(&now, NULL);
  return (double)now.tv_sec + 1e-6 * (double)now.tv_usec;
}

static int scan(void) {
  int found = 0;
  for (int module = 1; module <= MODULES; ++module) {
    const double end_s = now_s() + 0.93;
    tcflush(line, TCIFLUSH);
    if (!send_request(module, 0x1D)) return 1;
    while (now_s() < end_s && waiting() == 0) {
    }
    if (waiting() > 0) found += take_answer();
  }
  printf("%d found\n", found);
  return 0;
}

static int bytes(int count, double spin_s) {
  unsigned char byte;
  int got = 0;
  for (const double end_s = now_s() + spin_s; now_s() < end_s;) {
  }
  for (int k = 0; k < count; ++k)
    if (!send_request(1, 0x27)) return 1;
  usleep(20000);
  for (const double begin_s = now_s(); waiting() > 0; ++got) {
    struct pollfd set = {line, POLLIN, 0};
    for (int looks = got % 2 ? 150 : 99; looks > 0; --looks)
      if (now_s() != begin_s) return 1;
    if (poll(&set, 1, 100) != 1 || read(line, &byte, 1) != 1) return 1;
  }
  printf("%d bytes\n", got);
  return 0;
}

static int drop_by_flush(void) {
  return tcflush(line, TCIFLUSH) == 0;
}

static int drop_by_ioctl(void) {
  return ioctl(line, TCFLSH, TCIFLUSH) == 0;
}

static int drop_by_settings(void) {
  struct termios settings;
  return tcgetattr(line, &settings) == 0 && tcsetattr(line, TCSAFLUSH, &settings) == 0;
}

static int drop_by_readv(void) {
  unsigned char bytes[64];
  struct iovec to = {bytes, sizeof bytes};
  return readv(line, &to, 1) > 0;
}

static int drop_by_reading_all(void) {
  return take_answer();
}

static int stale(int count) {
  static int (*const ways[])(void) = {drop_by_flush, drop_by_ioctl, drop_by_settings, drop_by_readv,
                                      drop_by_reading_all};
  struct termios settings;
  unsigned char byte;
  if (tcgetattr(line, &settings) != 0) return 1;
  settings.c_cc[VMIN] = 0;
  settings.c_cc[VTIME] = 2;
  if (tcsetattr(line, TCSANOW, &settings) != 0) return 1;
  for (int k = 0; k < count; ++k) {
    struct pollfd set = {line, POLLIN, 0};
    if (!send_request(1, 0x27) || poll(&set, 1, 100) != 1 || poll(&set, 1, 0) != 1) return 1;
    if (!ways[(size_t)k % (sizeof ways / sizeof *ways)]()) return 1;
    const double begin_s = now_s();
    if (read(line, &byte, 1) != 0 || now_s() - begin_s < 0.1999 || now_s() - begin_s > 0.2011) return 1;
  }
  printf("%d reads found nothing\n", count);
  return 0;
}

static int be_client(const struct sockaddr_in* address, int count) {
  char text[64];
  const int connection = socket(AF_INET, SOCK_STREAM, 0);
  if (connect(connection, (const struct sockaddr*)address, sizeof *address) != 0) return 1;
  FILE* in = fdopen(connection, "r");
  for (int k = 0; k < count; ++k) {
    if (write(connection, "get\n", 4) != 4 || !fgets(text, sizeof text, in)) return 1;
    usleep(20000);
  }
  return write(connection, "quit\n", 5) != 5;
}

static int serve(int count) {
  struct sockaddr_in address = {.sin_family = AF_INET, .sin_addr.s_addr = htonl(INADDR_LOOPBACK)};
  socklen_t size = sizeof address;
  char text[64];
  int status = 1;
  const int listener = socket(AF_INET, SOCK_STREAM, 0);
  if (bind(listener, (struct sockaddr*)&address, size) != 0 || listen(listener, 1) != 0 ||
      getsockname(listener, (struct sockaddr*)&address, &size) != 0)
    return 1;
  const pid_t client = fork();
  if (client == 0) _exit(be_client(&address, count));
  const int connection = accept(listener, NULL, NULL);
  FILE* in = fdopen(dup(connection), "r");
  while (in && fgets(text, sizeof text, in) && text[0] != 'q')
    if (!send_request(1, 0x27) || !take_answer() || write(connection, "here\n", 5) != 5) return 1;
  waitpid(client, &status, 0);
  printf("the client ended with %d\n", status);
  return status != 0;
}

int main(int argc, char** argv) {
  const int count = argc > 3 ? atoi(argv[3]) : 0;
  if (argc < 3 || !open_line(argv[2])) return 2;
  if (strcmp(argv[1], "resend") == 0) return resend(count);
  if (strcmp(argv[1], "bytes") == 0) return bytes(count, 0.0);
  if (strcmp(argv[1], "spun") == 0) return bytes(count, 0.05);
  if (strcmp(argv[1], "stale") == 0) return stale(count);
  if (strcmp(argv[1], "scan") == 0) return scan();
  if (strcmp(argv[1], "serve") == 0) return serve(count);
  return 2;
}
