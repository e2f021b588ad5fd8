/* Ways to let time pass, each by other means. Every one waits for about `ms` milliseconds. */
#pragma once

struct kind {
  const char* name;
  void (*wait)(long ms);
};
extern const struct kind kinds[]; /* ends with a null name */

/* futures.cc: of the C++ library. */
void wait_future(long ms);
void wait_future_until(long ms);
void wait_promise(long ms);
void wait_acquire(long ms);
