#include "server/gateway/body_changes.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <stdexcept>
#include <system_error>

#include "server/bus/address.h"
#include "server/cycle/attempt.h"
#include "server/gateway/model_files.h"
#include "server/gateway/scene_files.h"

namespace visum::gateway {
namespace {

using cycle::Refusal;
using protocol::AddBody;
using protocol::RemoveBody;
using protocol::Reset;
using protocol::ResetScope;

using Edit = recording::State::Edit;

// Begins the change for a model that a client sends, or for one of the installation's.
cycle::BodyChange spawning(const cycle::Simulation& simulation, const protocol::SpawnModel& request,
                           const std::filesystem::path& models) {
  world::Pose X_WM;
  if (const auto& p = request.pose; !p.empty())
    X_WM = {Eigen::Vector3d(p.data()), Eigen::Quaterniond(p[3], p[4], p[5], p[6]).normalized()};
  const bool sent = !request.files.empty();
  const scene::SpawnOrder order{(sent ? sent_folder() : models) / request.file, request.name, X_WM,
                                request.make_unique};
  return simulation.begin_spawn(order, sent ? std::optional(files_of(request.files)) : std::nullopt);
}

cycle::BodyChange change_of(const cycle::Simulation& simulation, const protocol::Request& request,
                            const std::filesystem::path& models) {
  const auto edit = [&](Edit::Kind kind, const std::string& text) {
    return simulation.begin_change({kind, text, nullptr});
  };
  if (const auto* model = std::get_if<protocol::SpawnModel>(&request))
    return spawning(simulation, *model, models);
  if (const auto* model = std::get_if<protocol::RemoveModel>(&request))
    return edit(Edit::Kind::kModelWent, model->name);
  if (const auto* body = std::get_if<AddBody>(&request)) return edit(Edit::Kind::kBodyCame, body->yaml);
  if (const auto* reset = std::get_if<Reset>(&request)) return simulation.begin_reset(reset->scope);
  return edit(Edit::Kind::kBodyWent, std::get<RemoveBody>(request).body);
}

bool is_about_bodies(const protocol::Request& request) {
  return std::holds_alternative<AddBody>(request) || std::holds_alternative<RemoveBody>(request) ||
         std::holds_alternative<protocol::SpawnModel>(request) ||
         std::holds_alternative<protocol::RemoveModel>(request) || std::holds_alternative<Reset>(request);
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
  return (is_about_bodies(request) && !reset) || std::holds_alternative<protocol::LoadScene>(request) ||
         std::holds_alternative<protocol::StartRecording>(request) ||
         std::holds_alternative<protocol::StopRecording>(request) || (taken && !taken->name.empty()) ||
         (restored && !restored->name.empty()) ||
         (reset && (reset->scope == ResetScope::kSpawned || reset->scope == ResetScope::kAll));
}

void BodyChanges::close_recording() {
  if (recorder_) recorder_->close();
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
  job_ = std::make_shared<Job>();
  job_->outcome = cycle::attempt(Refusal::kWrongState, [this] { begin_job(commands_.front()->request); });
  if (job_->outcome.done() && !thread_.joinable())
    job_->outcome = cycle::attempt(Refusal::kFull, [this] { start_thread(); });
  if (job_->outcome.done()) {
    wanted_.release();
    return false;
  }
  ready_.store(true, std::memory_order_release);
  return true;
}

void BodyChanges::begin_job(const protocol::Request& request) {
  if (const auto* load = std::get_if<protocol::LoadScene>(&request)) return begin_scene(load->scene);
  if (!is_about_bodies(request) && !archive_) throw std::runtime_error("this server keeps no files");
  if (const auto* taken = std::get_if<protocol::TakeSnapshot>(&request)) {
    job_->kind = Kind::kSave;
    job_->name = taken->name;
    if (simulation_.frozen()) throw std::runtime_error("the world is frozen: " + simulation_.fault());
    job_->reply = protocol::SnapshotTaken{simulation_.take_snapshot(), simulation_.tick_count(),
                                          simulation_.state_hash()};
    simulation_.keep(job_->state);
    job_->state.snapshots.clear();
  } else if (const auto* restored = std::get_if<protocol::RestoreSnapshot>(&request)) {
    job_->kind = Kind::kLoad;
    job_->name = restored->name;
    job_->change = simulation_.begin_restore();
    job_->revision = simulation_.revision() + 1;
  } else if (const auto* record = std::get_if<protocol::StartRecording>(&request)) {
    job_->kind = Kind::kRecord;
    job_->name = record->name;
    if (recorder_) throw std::runtime_error("a recording is under way already");
    if (simulation_.frozen()) throw std::runtime_error("the world is frozen: " + simulation_.fault());
  } else if (std::holds_alternative<protocol::StopRecording>(request)) {
    job_->kind = Kind::kEndRecording;
    if (!recorder_) throw std::runtime_error("no client has started a recording");
    recorder_->end();
    job_->recorder = std::move(recorder_);
  } else {
    job_->change = change_of(simulation_, request, models_);
    job_->revision = simulation_.revision() + 1;
  }
}

void BodyChanges::begin_scene(const std::string& name) {
  if (const auto why = refuses_scene_(); !why.empty()) throw std::runtime_error(why);
  auto order = scenes_;
  order.file = scene_file(models_, name);
  job_->kind = Kind::kScene;
  job_->scene = simulation_.begin_load(std::move(order));
  job_->revision = simulation_.revision() + 1;
}

void BodyChanges::start_thread() try {
  thread_ = std::thread([this] { run(); });
} catch (const std::system_error&) {
  throw std::runtime_error("no thread is left to read it: the limit of processes or of memory is reached");
}

cycle::Outcome BodyChanges::prepare_bodies(Job& job) {
  auto outcome = cycle::prepare(job.change);
  if (!outcome.done() || !job.change.changed) return outcome;
  return cycle::attempt(Refusal::kBadValue, [&] {
    job.view = std::make_unique<WorldView>(describe_world(*job.change.changed, job.revision));
    if (job.change.order) job.reply = job.view->spawned.back();
  });
}

// Its field buses would have to be opened while the world runs.
cycle::Outcome BodyChanges::prepare_scene(Job& job) {
  auto outcome = cycle::prepare(job.scene);
  if (!outcome.done()) return outcome;
  return cycle::attempt(Refusal::kWrongState, [&] {
    const auto& scene = std::as_const(*job.scene.world).scene();
    if (!bus::scene_buses(scene).empty())
      throw std::runtime_error("the scene '" + scene.name +
                               "' has field buses, which open with the server alone: start one with it");
    job.view = std::make_unique<WorldView>(describe_world(scene, job.revision));
    job.origin = recording::origin_of(*job.scene.loaded);
    for (const auto& loss : scene.losses) spdlog::warn("{}", loss);
  });
}

// Bodies and models that came before the snapshot was taken are read here, where no tick waits for them.
cycle::Outcome BodyChanges::load(Job& job) {
  auto outcome =
      cycle::attempt(Refusal::kUnknownName, [&] { job.state = archive_->load(simulation_, job.name); });
  if (!outcome.done() || std::ranges::equal(job.state.edits, job.change.present)) return outcome;
  job.change.edits = job.state.edits;
  return prepare_bodies(job);
}

cycle::Outcome BodyChanges::prepare(Job& job) {
  switch (job.kind) {
    case Kind::kScene:
      return prepare_scene(job);
    case Kind::kSave:
      return cycle::attempt(Refusal::kWrongState, [&] { archive_->save(simulation_, job.name, job.state); });
    case Kind::kLoad:
      return load(job);
    case Kind::kRecord:
      return cycle::attempt(Refusal::kWrongState,
                            [&] { job.recorder = archive_->record(simulation_, job.name); });
    case Kind::kFirstState:
      return cycle::attempt(Refusal::kWrongState, [&] { recorder_->write_first(); });
    case Kind::kEndRecording:
      if (job.recorder->close()) return {};
      return {Refusal::kWrongState, "the recording is not whole: the server's log says why"};
    case Kind::kBodies:
      break;
  }
  return prepare_bodies(job);
}

void BodyChanges::run() {
  for (wanted_.acquire(); !ending_.load(); wanted_.acquire()) {
    job_->outcome = prepare(*job_);
    ready_.store(true, std::memory_order_release);
    wake_();
  }
}

cycle::Outcome BodyChanges::act(Job& job, Command& command) {
  switch (job.kind) {
    case Kind::kSave:
    case Kind::kFirstState:
    case Kind::kEndRecording:
      return {};
    case Kind::kRecord:
      return cycle::attempt(Refusal::kWrongState, [&] {
        job.recorder->begin();
        recorder_ = std::move(job.recorder);
        job.kind = Kind::kFirstState;
      });
    case Kind::kLoad: {
      auto* const change = job.change.changed ? &job.change : nullptr;
      if (!change && !simulation_.has_bodies_of(job.state))
        return {Refusal::kWrongState, "the bodies have changed meanwhile"};
      if (auto outcome = simulation_.restore_state(job.state, change); !outcome.done()) return outcome;
      command.view = std::move(job.view);
      return {};
    }
    case Kind::kScene:
      if (auto outcome = simulation_.load_scene(job.scene); !outcome.done()) return outcome;
      if (archive_) archive_->swap_origin(job.origin);
      command.view = std::move(job.view);
      return {};
    case Kind::kBodies:
      break;
  }
  if (auto outcome = simulation_.change_bodies(job.change); !outcome.done()) return outcome;
  command.view = std::move(job.view);
  return {};
}

std::optional<BodyChanges::Finished> BodyChanges::finish() {
  ready_.store(false, std::memory_order_relaxed);
  const auto kind = job_->kind;
  if (job_->outcome.done()) job_->outcome = act(*job_, *commands_.front());
  if (kind != job_->kind) {  // its second half is the thread's
    wanted_.release();
    return {};
  }
  if (kind == Kind::kFirstState && !job_->outcome.done()) {
    recorder_->end();
    job_->recorder = std::move(recorder_);
  }
  Finished finished{std::move(commands_.front()), job_->outcome, job_->reply};
  commands_.erase(commands_.begin());
  finished.command->left_over = std::exchange(job_, nullptr);
  if (!commands_.empty()) start();
  return finished;
}

}  // namespace visum::gateway
