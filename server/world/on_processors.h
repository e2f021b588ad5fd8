// Shares work out among the processors.
#pragma once

#include <cstddef>
#include <functional>

namespace visum::world {

// Calls act(0) to act(count - 1), each once, and returns when all are done: on as many threads as there are
// processors for this one, up to `most_threads`, this one among them. Where the system gives fewer threads,
// those do all the work. If a call throws, no other call begins, and its exception comes from here when all
// threads have ended; of several, the first one does.
void on_processors(std::size_t count, std::size_t most_threads, const std::function<void(std::size_t)>& act);

}  // namespace visum::world
