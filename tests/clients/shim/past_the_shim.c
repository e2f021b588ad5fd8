/* Sleeps ten times for 20 ms. Linked statically it never loads the shim; with an argument it sleeps by the
 * system call itself, past the C library. */
#include <stdio.h>
#include <sys/syscall.h>
#include <time.h>

static long sleep_past_the_library(const struct timespec* length) {
  long result;
  __asm__ volatile("syscall"
                   : "=a"(result)
                   : "a"(SYS_nanosleep), "D"(length), "S"(0)
                   : "rcx", "r11", "memory");
  return result;
}

int main(int argc, char** argv) {
  const struct timespec length = {0, 20000000};
  (void)argv;
  for (int i = 0; i < 10; ++i)
    if ((argc > 1 ? sleep_past_the_library(&length) : nanosleep(&length, NULL)) != 0) return 1;
  puts("done");
  return 0;
}
