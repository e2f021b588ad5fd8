// The session whose client speaks most. A server that looks busily for messages reads this one's socket
// itself: one call of the kernel for each message, where Asio needs a look at epoll, a read, and another read
// that finds nothing.
//
// Used on the server's thread. Internal to the server.
#pragma once

namespace visum::protocol {

// A session, as far as it can be looked after.
class Speaker {
 public:
  virtual ~Speaker() = default;
  // True from the moment at which Talker::takes() has taken it until it has read something, waits or ends.
  virtual bool is_looked_after() const { return false; }
  // Handles what has come. False: nothing has.
  virtual bool take_now() { return false; }
  // Waits by itself from now on, as it does where nobody looks after it.
  virtual void wait_for_bytes() {}
};

class Talker {
 public:
  // A session wants to read on, and its last read has emptied its socket. True: look() takes what comes next.
  // False: it waits by itself.
  bool takes(Speaker& session);
  // Handles what has come from it. False: nothing has.
  bool look();
  // True: this turn is the talker's alone. One of kTurns is for all.
  bool takes_turn() { return is_looked_after() && ++turns_ % kTurns != 0; }
  // It waits by itself from now on, because nobody will look for a while.
  void rest();
  void forget(const Speaker& session);  // which ends

  static constexpr unsigned kTurns = 4;
  static constexpr int kMostInVain = 1000;  // looks in a row; then it waits by itself

 private:
  bool is_looked_after() const { return session_ != nullptr && session_->is_looked_after(); }

  Speaker* session_ = nullptr;
  int others_ = 0;  // reads of others since it has spoken
  int in_vain_ = 0;
  unsigned turns_ = 0;
};

}  // namespace visum::protocol
