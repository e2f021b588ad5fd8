// libvisum-tty.so, which `visum exec --tty` loads into a program. It keeps the program from discarding its
// own output on the placed devices. libm5api discards its output before every write. A serial port has sent
// the former write by then. In a pseudo terminal its bytes can still wait, because a worker of the kernel
// carries them over whenever it gets to run. Input is discarded as the program asks.
//
// VISUM_TTYS: the devices' numbers (st_rdev), as "34821,34822".
#define _GNU_SOURCE
#include <errno.h>
#include <stdarg.h>
#include <stdlib.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <termios.h>
#include <unistd.h>

#define MOST_DEVICES 16

static dev_t devices[MOST_DEVICES];
static int count;

__attribute__((constructor)) static void read_devices(void) {
  const char* text = getenv("VISUM_TTYS");
  while (text && *text && count < MOST_DEVICES) {
    char* end;
    devices[count++] = (dev_t)strtoull(text, &end, 10);
    text = *end == ',' ? end + 1 : "";
  }
}

static int is_placed(int fd) {
  const int before = errno;
  struct stat status;
  const int known = fstat(fd, &status) == 0 && S_ISCHR(status.st_mode);
  errno = before;
  for (int i = 0; known && i < count; ++i)
    if (devices[i] == status.st_rdev) return 1;
  return 0;
}

static int flush(int fd, int queue) {
  if (queue != TCIFLUSH && is_placed(fd)) {
    if (queue == TCOFLUSH) return 0;
    if (queue == TCIOFLUSH) queue = TCIFLUSH;
  }
  return (int)syscall(SYS_ioctl, fd, TCFLSH, queue);
}

int tcflush(int fd, int queue) {
  return flush(fd, queue);
}

int ioctl(int fd, unsigned long request, ...) {
  va_list list;
  va_start(list, request);
  void* argument = va_arg(list, void*);
  va_end(list);
  if (request == TCFLSH) return flush(fd, (int)(long)argument);
  return (int)syscall(SYS_ioctl, fd, request, argument);
}
