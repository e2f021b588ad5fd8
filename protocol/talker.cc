#include "protocol/talker.h"

#include <utility>

namespace visum::protocol {

// Others take its place once they have read twice without a word from it.
bool Talker::takes(Speaker& session) {
  if (session_ != nullptr && session_ != &session && ++others_ < 2) return false;
  if (session_ != &session) rest();
  session_ = &session;
  others_ = in_vain_ = 0;
  return true;
}

bool Talker::look() {
  if (!is_looked_after()) return false;
  if (session_->take_now()) return true;
  if (++in_vain_ >= kMostInVain) rest();
  return false;
}

void Talker::rest() {
  if (session_ != nullptr) std::exchange(session_, nullptr)->wait_for_bytes();
}

void Talker::forget(const Speaker& session) {
  if (session_ == &session) session_ = nullptr;
}

}  // namespace visum::protocol
