// Shares work out among the processors.
#pragma once

#include <cstddef>
#include <functional>

namespace visum::world {

// Calls act(0) to act(count - 1), each once, and returns when all are done: on as many threads as there are
// processors for this one, up to `most_threads`, this one among them. `act` must not throw.
void on_processors(std::size_t count, std::size_t most_threads, const std::function<void(std::size_t)>& act);

}  // namespace visum::world
