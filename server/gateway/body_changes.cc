#include "server/gateway/body_changes.h"

#include <stdexcept>
#include <system_error>

#include "server/cycle/attempt.h"

namespace visum::gateway {
namespace {

using cycle::Refusal;
using protocol::AddBody;
using protocol::RemoveBody;
using protocol::Reset;
using protocol::ResetScope;

cycle::BodyChange change_of(const cycle::Simulation& simulation, const protocol::Request& request) {
  if (const auto* body = std::get_if<AddBody>(&request)) return simulation.begin_change(true, body->yaml);
  if (const auto* reset = std::get_if<Reset>(&request)) return simulation.begin_reset(reset->scope);
  return simulation.begin_change(false, std::get<RemoveBody>(request).body);
}

}  // namespace

BodyChanges::~BodyChanges() {
  end();
  if (recorder_) recorder_->end();
}

bool BodyChanges::takes(const protocol::Request& request) {
  const auto* reset = std::get_if<Reset>(&request);
  const auto* taken = std::get_if<protocol::TakeSnapshot>(&request);
  const auto* restored = std::get_if<protocol::RestoreSnapshot>(&request);
  return std::holds_alternative<AddBody>(request) || std::holds_alternative<RemoveBody>(request) ||
         std::holds_alternative<protocol::StartRecording>(request) ||
         std::holds_alternative<protocol::StopRecording>(request) || (taken && !taken->name.empty()) ||
         (restored && !restored->name.empty()) ||
         (reset && (reset->scope == ResetScope::kSpawned || reset->scope == ResetScope::kAll));
}

void BodyChanges::end() {
  if (!thread_.joinable()) return;
  ending_.store(true);
  wanted_.release();
  thread_.join();
}

bool BodyChanges::begin(std::unique_ptr<Command> command) {
  commands_.push_back(std::move(command));
  return commands_.size() == 1 && start();
}

bool BodyChanges::start() {
  job_.outcome = cycle::attempt(Refusal::kWrongState, [this] { begin_job(commands_.front()->request); });
  if (job_.outcome.done() && !thread_.joinable())
    job_.outcome = cycle::attempt(Refusal::kFull, [this] { start_thread(); });
  if (job_.outcome.done()) {
    wanted_.release();
    return false;
  }
  ready_.store(true, std::memory_order_release);
  return true;
}

void BodyChanges::begin_job(const protocol::Request& request) {
  const bool needs_disk = !std::holds_alternative<AddBody>(request) &&
                          !std::holds_alternative<RemoveBody>(request) &&
                          !std::holds_alternative<Reset>(request);
  if (needs_disk && !archive_) throw std::runtime_error("this server keeps no files");
  if (const auto* taken = std::get_if<protocol::TakeSnapshot>(&request)) {
    job_.kind = Kind::kSave;
    job_.name = taken->name;
    if (simulation_.frozen()) throw std::runtime_error("the world is frozen: " + simulation_.fault());
    job_.taken = {simulation_.take_snapshot(), simulation_.tick_count(), simulation_.state_hash()};
    simulation_.keep(job_.state);
    job_.state.snapshots.clear();
  } else if (const auto* restored = std::get_if<protocol::RestoreSnapshot>(&request)) {
    job_.kind = Kind::kLoad;
    job_.name = restored->name;
  } else if (const auto* record = std::get_if<protocol::StartRecording>(&request)) {
    job_.kind = Kind::kRecord;
    job_.name = record->name;
    if (recorder_) throw std::runtime_error("a recording is under way already");
    if (simulation_.frozen()) throw std::runtime_error("the world is frozen: " + simulation_.fault());
  } else if (std::holds_alternative<protocol::StopRecording>(request)) {
    job_.kind = Kind::kEndRecording;
    if (!recorder_) throw std::runtime_error("no client has started a recording");
    recorder_->end();
    job_.recorder = std::move(recorder_);
  } else {
    job_.change = change_of(simulation_, request);
    job_.revision = simulation_.revision() + 1;
  }
}

void BodyChanges::start_thread() try {
  thread_ = std::thread([this] { run(); });
} catch (const std::system_error&) {
  throw std::runtime_error("no thread is left to read it: the limit of processes or of memory is reached");
}

cycle::Outcome BodyChanges::prepare(Job& job) {
  switch (job.kind) {
    case Kind::kSave:
      return cycle::attempt(Refusal::kWrongState, [&] { archive_->save(simulation_, job.name, job.state); });
    case Kind::kLoad:
      return cycle::attempt(Refusal::kUnknownName,
                            [&] { job.state = archive_->load(simulation_, job.name); });
    case Kind::kRecord:
      return cycle::attempt(Refusal::kWrongState,
                            [&] { job.recorder = archive_->record(simulation_, job.name); });
    case Kind::kEndRecording:
      if (job.recorder->close()) return {};
      return {Refusal::kWrongState, "the recording is not whole: the server's log says why"};
    case Kind::kBodies:
      break;
  }
  auto outcome = cycle::prepare(job.change);
  if (!outcome.done() || !job.change.changed) return outcome;
  return cycle::attempt(Refusal::kBadValue, [&] {
    job.view = std::make_unique<WorldView>(describe_world(*job.change.changed, job.revision));
  });
}

void BodyChanges::run() {
  for (wanted_.acquire(); !ending_.load(); wanted_.acquire()) {
    job_.outcome = prepare(job_);
    ready_.store(true, std::memory_order_release);
    wake_();
  }
}

cycle::Outcome BodyChanges::act(Job& job, Finished& finished) {
  switch (job.kind) {
    case Kind::kSave:
      finished.reply = job.taken;
      return {};
    case Kind::kEndRecording:
      return {};
    case Kind::kRecord:
      return cycle::attempt(Refusal::kWrongState, [&] {
        job.recorder->begin();
        recorder_ = std::move(job.recorder);
      });
    case Kind::kLoad: {
      const auto revision = simulation_.revision();
      if (auto outcome = simulation_.restore_state(job.state); !outcome.done()) return outcome;
      if (simulation_.revision() != revision)
        finished.command->view =
            std::make_unique<WorldView>(describe_world(simulation_.scene(), simulation_.revision()));
      return {};
    }
    case Kind::kBodies:
      break;
  }
  if (auto outcome = simulation_.change_bodies(job.change); !outcome.done()) return outcome;
  finished.command->view = std::move(job.view);
  return {};
}

BodyChanges::Finished BodyChanges::finish() {
  ready_.store(false, std::memory_order_relaxed);
  auto job = std::exchange(job_, {});
  Finished finished{std::move(commands_.front()), std::move(job.outcome), protocol::Ok{}};
  commands_.erase(commands_.begin());
  if (finished.outcome.done()) finished.outcome = act(job, finished);
  finished.command->left_over = std::move(job.change);
  if (!commands_.empty()) start();
  return finished;
}

}  // namespace visum::gateway
