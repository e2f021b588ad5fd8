#include "server/recording/player.h"

#include <algorithm>
#include <tuple>

#include "server/cycle/apply_input.h"
#include "server/world/world_state.h"

namespace visum::recording {

Player::Player(const std::filesystem::path& file, const PluginFolders& plugins, const Adjust& adjust)
    : file_(file),
      scenes_{std::make_shared<const LoadedScene>(scene_of(file_.header(), file_.take_files()))},
      world_(make_world(file_.header(), scenes_.front()->files, plugins, adjust)),
      beginning_(file_.place()) {
  world_->keep(initial_);
  read_through();
  seek(0);
}

void Player::read_through() {
  for (auto item = file_.next(); !std::holds_alternative<RecordingFile::End>(item); item = file_.next()) {
    if (std::holds_alternative<const Tick*>(item)) ++ticks_;
    if (std::holds_alternative<const State*>(item))
      points_.push_back({ticks_, file_.place_of_last(), scenes_.size() - 1});
    if (const auto* input = std::get_if<const TimedInput*>(&item))
      if (const auto* loaded = std::get_if<LoadScene>(&(*input)->input)) note_scene(loaded->scene);
    events_.take(item, ticks_);
  }
  // A state at the very end serves no seeking, and restoring it would drop the last tick's contacts.
  while (ticks_ > 0 && !points_.empty() && points_.back().position == ticks_) points_.pop_back();
  damage_ = file_.damage();
  position_ = ticks_ + 1;  // no position of the file: the first seek() must go to a state
}

// A scene that comes again is kept once.
void Player::note_scene(std::shared_ptr<const LoadedScene> scene) {
  for (const auto& known : scenes_)
    if (*known == *scene) return scenes_.push_back(known);
  scenes_.push_back(std::move(scene));
}

// A world that goes another way than the recorded one may refuse an input. It goes on without it, until the
// next state puts it right; Replayer is there to report the difference.
void Player::take(const TimedInput& input) {
  std::ignore = cycle::apply(*world_, input.input);
  if (std::holds_alternative<LoadScene>(input.input)) ++scene_;
}

bool Player::advance() {
  if (position_ == ticks_) return false;
  while (true) {
    const config::FilesGiven given(scenes_[scene_]->files);
    const auto item = file_.next();
    if (std::holds_alternative<RecordingFile::End>(item)) return false;
    if (const auto* input = std::get_if<const TimedInput*>(&item)) take(**input);
    if (const auto* sample = std::get_if<const protocol::PartSample*>(&item))
      samples_[(*sample)->part] = **sample;
    if (const auto* state = std::get_if<const State*>(&item)) put_right(**state);
    if (!std::holds_alternative<const Tick*>(item)) continue;
    world_->tick();
    ++position_;
    return true;
  }
}

// Restores only where the world differs: restoring drops the contacts, which are shown. Where this world
// cannot take the state, it is the scene's initial one and goes on from there.
void Player::put_right(const State& state) {
  if (world::hash_bytes(state.state) != world_->state_hash() || state.era != world_->era())
    std::ignore = world_->restore(state);
}

void Player::seek(std::uint64_t position) {
  position = std::min(position, ticks_);
  const auto after = std::ranges::upper_bound(points_, position, {}, &StatePoint::position);
  const bool near = position >= position_ && (after == points_.begin() || (after - 1)->position <= position_);
  if (!near) after == points_.begin() ? go_to_beginning() : go_to(*(after - 1));
  while (position_ < position && advance()) {
  }
}

void Player::put_scene(std::size_t number) {
  if (scene_ != number) std::ignore = world_->load_scene(scenes_[number]);
  scene_ = number;
}

void Player::go_to(const StatePoint& point) {
  put_scene(point.loads);
  const config::FilesGiven given(scenes_[scene_]->files);
  file_.go_to(point.place);
  samples_.clear();
  position_ = point.position;
  const auto item = file_.next();
  const auto* state = std::get_if<const State*>(&item);
  if (!state || !world_->restore(**state).done()) go_to_beginning();
}

void Player::go_to_beginning() {
  put_scene(0);
  const config::FilesGiven given(scenes_[scene_]->files);
  file_.go_to(beginning_);
  samples_.clear();
  position_ = 0;
  std::ignore = world_->restore(initial_);  // its own state; refused, it would be the scene's initial one too
}

const protocol::PartSample* Player::sample(const std::string& part) const {
  const auto found = samples_.find(part);
  const bool here = found != samples_.end() && found->second.tick == world_->tick_count() &&
                    found->second.era == world_->era();
  return here ? &found->second : nullptr;
}

}  // namespace visum::recording
