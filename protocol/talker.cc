#include "protocol/talker.h"

#include <utility>

namespace visum::protocol {

// Another session takes the place once it has spoken twice in a row.
bool Talker::takes(Speaker& session) {
  if (session_ != nullptr && session_ != &session && std::exchange(rival_, &session) != &session)
    return false;
  if (session_ != &session) rest();
  session_ = &session;
  rival_ = nullptr;
  return true;
}

void Talker::rest() {
  if (session_ != nullptr) std::exchange(session_, nullptr)->wait_for_bytes();
}

void Talker::forget(const Speaker& session) {
  if (session_ == &session) session_ = nullptr;
  if (rival_ == &session) rival_ = nullptr;
}

}  // namespace visum::protocol
