#include "server/world/on_processors.h"

#include <sched.h>

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace visum::world {

void on_processors(std::size_t count, std::size_t most_threads, const std::function<void(std::size_t)>& act) {
  cpu_set_t set;
  const int processors = ::sched_getaffinity(0, sizeof set, &set) == 0 ? CPU_COUNT(&set) : 1;
  const std::size_t wanted = std::min({count, static_cast<std::size_t>(processors), most_threads});
  std::atomic<std::size_t> next = 0;
  std::mutex mutex;
  std::exception_ptr first;
  const auto work = [&] {
    try {
      for (std::size_t i = next++; i < count; i = next++) act(i);
    } catch (...) {
      next = count;
      const std::lock_guard lock(mutex);
      if (!first) first = std::current_exception();
    }
  };
  {
    std::vector<std::jthread> threads;
    try {
      threads.reserve(wanted);
      while (threads.size() + 1 < wanted) threads.emplace_back(work);
    } catch (...) {
      // No thread or no memory for one: those that run do its work.
    }
    work();
  }
  if (first) std::rethrow_exception(first);
}

}  // namespace visum::world
