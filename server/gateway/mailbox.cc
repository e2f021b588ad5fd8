#include "server/gateway/mailbox.h"

#include <utility>

namespace visum::gateway {

Mailbox::Mailbox(std::size_t most_ports) : pool_(kInputs) {
  for (auto& input : pool_) {
    input.values.reserve(most_ports);
    blanks_.push(&input);
  }
}

Mailbox::~Mailbox() {
  for (Item item; sent_.pop(item);) delete item.command;
  for (Command* command = nullptr; done_.pop(command);) delete command;
}

Input* Mailbox::blank_input(bool urgent) {
  if (!urgent && blanks_.read_available() <= kUrgent) return nullptr;
  Input* input = nullptr;
  blanks_.pop(input);
  return input;
}

void Mailbox::send(Input* input) {
  input->arrival = ++arrivals_;
  sent_.push(Item{input, nullptr});
  wake();
}

bool Mailbox::send(std::unique_ptr<Command> command) {
  if (commands_out_ == kCommands) return false;
  ++commands_out_;
  sent_.push(Item{nullptr, command.release()});
  wake();
  return true;
}

std::unique_ptr<Command> Mailbox::next_done() {
  Command* command = nullptr;
  if (!done_.pop(command)) return nullptr;
  --commands_out_;
  return std::unique_ptr<Command>(command);
}

bool Mailbox::next_notice(Notice& notice) {
  return notices_.pop(notice);
}

bool Mailbox::next(Item& item) {
  return sent_.pop(item);
}

void Mailbox::give_back(Input* input) {
  blanks_.push(input);
}

void Mailbox::give_back(std::unique_ptr<Command> command) {
  done_.push(command.release());
}

void Mailbox::tell(const Notice& notice) {
  notices_.push(notice);
}

void Mailbox::wake() {
  if (!woken_.exchange(true)) arrived_.release();
}

void Mailbox::wait_for(std::chrono::milliseconds at_most) {
  if (arrived_.try_acquire_for(at_most)) woken_.store(false);
}

}  // namespace visum::gateway
