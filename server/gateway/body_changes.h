// Carries out what takes longer than a tick has, one after the other, in the order in which it came: bodies
// and models that come and go, another scene, resets of what was spawned, snapshots on disk, and recordings
// that begin and end. A thread of its own makes each change ready, or completes it, so that neither the tick
// nor the sessions wait for a disk or for the reading of a body. The tick's side takes it between two ticks.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <semaphore>
#include <thread>
#include <utility>
#include <vector>

#include "server/cycle/simulation.h"
#include "server/gateway/mailbox.h"
#include "server/recording/archive.h"

namespace visum::gateway {

// Owned by the TickSide; all public functions are for the tick's thread, and none of them waits but end(),
// which lets the thread finish the change that it is at.
class BodyChanges {
 public:
  static constexpr std::size_t kMost = 4;  // under way at once

  // `archive`: null where nothing is kept on disk.
  BodyChanges(cycle::Simulation& simulation, recording::Archive* archive)
      : simulation_(simulation), archive_(archive) {
    commands_.reserve(kMost);
  }
  ~BodyChanges();

  // `wake` is called on the thread when a change is ready. Before the first command.
  void on_ready(std::function<void()> wake) { wake_ = std::move(wake); }

  // Where the installation's models and scenes lie, and how its scenes are read (`scenes`, without a file).
  // Before the first command.
  void serve_models(std::filesystem::path folder, cycle::SceneOrder scenes) {
    models_ = std::move(folder);
    scenes_ = std::move(scenes);
  }
  // `why` says at each load why no other scene may come; empty: one may. Before the first command.
  void refuse_scenes(std::function<std::string()> why) { refuses_scene_ = std::move(why); }
  // On another thread, while the tick's thread is abandoned: completes the recording that a client started.
  void close_recording();

  // Ends the thread; nothing may be begun afterwards.
  void end();

  // True for the requests that this class carries out.
  static bool takes(const protocol::Request& request);
  bool full() const { return commands_.size() == kMost; }
  // Takes a command with a request that takes() names. Only where it is not full. True: it is refused at
  // once, and ready.
  bool begin(std::unique_ptr<Command> command);
  bool under_way() const { return !commands_.empty(); }
  bool ready() const { return ready_.load(std::memory_order_acquire); }
  struct Finished {
    std::unique_ptr<Command> command;  // with the world's new description, where the change was done
    cycle::Outcome outcome;
    protocol::Reply reply;  // where it was done
  };
  // Only where it is ready: carries out the change, and begins the next one. Nothing: the thread completes
  // what has been carried out, and will be ready again.
  std::optional<Finished> finish();

 private:
  enum class Kind { kBodies, kScene, kSave, kLoad, kRecord, kFirstState, kEndRecording };
  struct Job {
    Kind kind = Kind::kBodies;
    cycle::BodyChange change;
    cycle::SceneChange scene;
    recording::Origin origin;  // of that scene; once it is taken, of the one before
    cycle::Outcome outcome;
    std::uint64_t revision = 0;       // of the changed world
    std::unique_ptr<WorldView> view;  // of the changed world
    protocol::Reply reply = protocol::Ok{};
    std::string name;                               // of a snapshot or recording
    recording::State state;                         // kSave, kLoad
    std::unique_ptr<recording::Recorder> recorder;  // kRecord: to begin; kEndRecording: to be completed
  };

  // Hands the first of the commands to the thread. True: it is ready at once, refused, as where there is no
  // memory or no thread for it.
  bool start();
  // The part of start() on the tick's thread, for the first command. Throws where it cannot be done.
  void begin_job(const protocol::Request& request);
  void begin_scene(const std::string& name);
  void start_thread();
  // The thread's part of a job.
  cycle::Outcome prepare(Job& job);
  // The tick's part of a job that is ready.
  cycle::Outcome act(Job& job, Command& command);
  cycle::Outcome prepare_bodies(Job& job);
  cycle::Outcome prepare_scene(Job& job);
  cycle::Outcome load(Job& job);
  void run();

  cycle::Simulation& simulation_;
  recording::Archive* const archive_;              // where there is one: the thread's while a job is its own
  std::unique_ptr<recording::Recorder> recorder_;  // that clients started
  std::function<void()> wake_ = [] {};
  std::vector<std::unique_ptr<Command>> commands_;  // in their order; the first one is being made ready
  std::filesystem::path models_;
  cycle::SceneOrder scenes_;
  std::function<std::string()> refuses_scene_ = [] { return std::string(); };
  std::shared_ptr<Job> job_;  // the thread's from start() until it is ready
  std::atomic<bool> ready_{false}, ending_{false};
  std::binary_semaphore wanted_{0};
  std::thread thread_;  // started with the first command
};

}  // namespace visum::gateway
