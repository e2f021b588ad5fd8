#include "server/gateway/body_changes.h"

#include <stdexcept>
#include <system_error>

#include "server/cycle/attempt.h"

namespace visum::gateway {
namespace {

using cycle::Refusal;
using protocol::AddBody;
using protocol::RemoveBody;

cycle::BodyChange change_of(const cycle::Simulation& simulation, const protocol::Request& request) {
  if (const auto* body = std::get_if<AddBody>(&request)) return simulation.begin_change(true, body->yaml);
  return simulation.begin_change(false, std::get<RemoveBody>(request).body);
}

}  // namespace

void BodyChanges::end() {
  if (!thread_.joinable()) return;
  ending_.store(true);
  wanted_.release();
  thread_.join();
}

void BodyChanges::begin(std::unique_ptr<Command> command) {
  commands_.push_back(std::move(command));
  if (commands_.size() == 1) start();
}

void BodyChanges::start() {
  job_.outcome = cycle::attempt(Refusal::kFull, [this] {
    job_.change = change_of(simulation_, commands_.front()->request);
    job_.revision = simulation_.revision() + 1;
    if (!thread_.joinable()) start_thread();
  });
  if (job_.outcome.done())
    wanted_.release();
  else
    ready_.store(true, std::memory_order_release);
}

void BodyChanges::start_thread() try {
  thread_ = std::thread([this] { run(); });
} catch (const std::system_error&) {
  throw std::runtime_error("no thread is left to read it: the limit of processes or of memory is reached");
}

void BodyChanges::run() {
  for (wanted_.acquire(); !ending_.load(); wanted_.acquire()) {
    job_.outcome = cycle::prepare(job_.change);
    if (job_.outcome.done())
      job_.outcome = cycle::attempt(Refusal::kBadValue, [this] {
        job_.view = std::make_unique<WorldView>(describe_world(*job_.change.changed, job_.revision));
      });
    ready_.store(true, std::memory_order_release);
    wake_();
  }
}

BodyChanges::Finished BodyChanges::finish() {
  ready_.store(false, std::memory_order_relaxed);
  auto job = std::exchange(job_, {});
  Finished finished{std::move(commands_.front()), std::move(job.outcome)};
  commands_.erase(commands_.begin());
  if (finished.outcome.done()) finished.outcome = simulation_.change_bodies(job.change);
  if (finished.outcome.done()) finished.command->view = std::move(job.view);
  finished.command->left_over = std::move(job.change);
  if (!commands_.empty()) start();
  return finished;
}

}  // namespace visum::gateway
