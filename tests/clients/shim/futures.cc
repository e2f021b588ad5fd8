// Waits of the C++ library, for waits.c. Plain C++, as a controller's program has it.
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <future>
#include <semaphore>
#include <thread>

using std::chrono::milliseconds;

extern "C" void wait_future(long ms) {
  std::promise<void> promise;
  promise.get_future().wait_for(milliseconds(ms));
}

extern "C" void wait_future_until(long ms) {
  std::promise<void> promise;
  promise.get_future().wait_until(std::chrono::system_clock::now() + milliseconds(ms));
}

extern "C" void wait_promise(long ms) {
  std::promise<void> promise;
  std::thread other([&] {
    ::usleep(static_cast<useconds_t>(ms * 1000));
    promise.set_value();
  });
  if (promise.get_future().wait_for(std::chrono::seconds(100)) != std::future_status::ready) std::abort();
  other.join();
}

extern "C" void wait_acquire(long ms) {
  std::counting_semaphore<2> semaphore(0);
  if (semaphore.try_acquire_for(milliseconds(ms))) std::abort();
}
