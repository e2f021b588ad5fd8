// Models that come and go, and the models, scenes and scenarios that a server has.
#include "protocol/wire.h"
#include "visum.pb.h"

namespace visum::protocol::wire {
namespace {

void take(const v1::SpawnModel& from, SpawnModel& to) {
  to.file = from.file();
  to.name = from.name();
  take_numbers(from.pose(), to.pose);
  to.make_unique = from.make_unique();
  for (const auto& file : from.files()) to.files.push_back({file.path(), file.content()});
}

}  // namespace

void PutModelRequest::operator()(const SpawnModel& from) const {
  auto& w = *to.mutable_spawn_model();
  w.set_file(from.file);
  w.set_name(from.name);
  put_numbers(from.pose, w.mutable_pose());
  w.set_make_unique(from.make_unique);
  for (const auto& file : from.files) {
    auto& entry = *w.add_files();
    entry.set_path(file.path);
    entry.set_content(file.content);
  }
}
void PutModelRequest::operator()(const RemoveModel& from) const {
  to.mutable_remove_model()->set_name(from.name);
}
void PutModelRequest::operator()(const ListModels&) const {
  to.mutable_list_models();
}
void PutModelRequest::operator()(const ListScenes&) const {
  to.mutable_list_scenes();
}
void PutModelRequest::operator()(const LoadScene& from) const {
  to.mutable_load_scene()->set_scene(from.scene);
}

bool take_model_request(const v1::ClientMessage& from, Request& to) {
  switch (from.request_case()) {
    case v1::ClientMessage::kSpawnModel:
      take(from.spawn_model(), to.emplace<SpawnModel>());
      return true;
    case v1::ClientMessage::kRemoveModel:
      to = RemoveModel{from.remove_model().name()};
      return true;
    case v1::ClientMessage::kListModels:
      to = ListModels{};
      return true;
    case v1::ClientMessage::kListScenes:
      to = ListScenes{};
      return true;
    case v1::ClientMessage::kLoadScene:
      to = LoadScene{from.load_scene().scene()};
      return true;
    default:
      return false;
  }
}

void PutModelReply::operator()(const ModelSpawned& from) const {
  auto& w = *to.mutable_model_spawned();
  w.set_name(from.name);
  put_texts(from.bodies, w.mutable_bodies());
  put_texts(from.parts, w.mutable_parts());
}
void PutModelReply::operator()(const ModelList& from) const {
  put_texts(from.files, to.mutable_models()->mutable_files());
  put_texts(from.spawned, to.mutable_models()->mutable_spawned());
}
void PutModelReply::operator()(const SceneList& from) const {
  put_texts(from.scenes, to.mutable_scenes()->mutable_scenes());
  put_texts(from.scenarios, to.mutable_scenes()->mutable_scenarios());
}

void take_model_reply(const v1::ServerMessage& from, Reply& to) {
  if (from.has_model_spawned())
    to = ModelSpawned{from.model_spawned().name(), texts_of(from.model_spawned().bodies()),
                      texts_of(from.model_spawned().parts())};
  else if (from.has_models())
    to = ModelList{texts_of(from.models().files()), texts_of(from.models().spawned())};
  else
    to = SceneList{texts_of(from.scenes().scenes()), texts_of(from.scenes().scenarios())};
}

}  // namespace visum::protocol::wire
