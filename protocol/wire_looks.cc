#include "protocol/wire_looks.h"

#include "visum.pb.h"

namespace visum::protocol::wire {
namespace {

void put(const MaterialDescription& from, v1::MaterialDescription& to) {
  to.set_name(from.name);
  to.set_roughness(from.roughness);
  to.set_metalness(from.metalness);
  to.set_texture(from.texture);
  put_numbers(from.texture_size, to.mutable_texture_size());
}

void take(const v1::MaterialDescription& from, MaterialDescription& to) {
  to.name = from.name();
  to.roughness = from.roughness();
  to.metalness = from.metalness();
  to.texture = from.texture();
  take_numbers(from.texture_size(), to.texture_size);
}

void put(const LightDescription& from, v1::LightDescription& to) {
  to.set_name(from.name);
  to.set_kind(from.kind);
  put_numbers(from.color, to.mutable_color());
  to.set_intensity(from.intensity);
  put_numbers(from.position, to.mutable_position());
  put_numbers(from.direction, to.mutable_direction());
  to.set_angle(from.angle);
  to.set_shadows(from.shadows);
}

void take(const v1::LightDescription& from, LightDescription& to) {
  to.name = from.name();
  to.kind = from.kind();
  take_numbers(from.color(), to.color);
  to.intensity = from.intensity();
  take_numbers(from.position(), to.position);
  take_numbers(from.direction(), to.direction);
  to.angle = from.angle();
  to.shadows = from.shadows();
}

void put(const ViewpointDescription& from, v1::ViewpointDescription& to) {
  to.set_name(from.name);
  put_numbers(from.position, to.mutable_position());
  put_numbers(from.target, to.mutable_target());
  to.set_fov(from.fov);
}

void take(const v1::ViewpointDescription& from, ViewpointDescription& to) {
  to.name = from.name();
  take_numbers(from.position(), to.position);
  take_numbers(from.target(), to.target);
  to.fov = from.fov();
}

void put(const SensorDescription& from, v1::SensorDescription& to) {
  to.set_part(from.part);
  to.set_kind(from.kind);
  to.set_body(from.body);
  put_numbers(from.pose, to.mutable_pose());
  put_numbers(from.range, to.mutable_range());
  put_numbers(from.angle, to.mutable_angle());
  to.set_fov(from.fov);
  to.set_aspect(from.aspect);
}

void take(const v1::SensorDescription& from, SensorDescription& to) {
  to.part = from.part();
  to.kind = from.kind();
  to.body = from.body();
  take_numbers(from.pose(), to.pose);
  take_numbers(from.range(), to.range);
  take_numbers(from.angle(), to.angle);
  to.fov = from.fov();
  to.aspect = from.aspect();
}

}  // namespace

void put_looks(const WorldDescription& from, v1::WorldDescription& to) {
  for (const auto& material : from.materials) put(material, *to.add_materials());
  for (const auto& light : from.lights) put(light, *to.add_lights());
  for (const auto& viewpoint : from.viewpoints) put(viewpoint, *to.add_viewpoints());
  for (const auto& panel : from.panels) {
    auto& added = *to.add_panels();
    added.set_name(panel.name);
    added.set_text(panel.text);
  }
  for (const auto& loss : from.losses) to.add_losses(loss);
  for (const auto& sensor : from.sensors) put(sensor, *to.add_sensors());
}

void take_looks(const v1::WorldDescription& from, WorldDescription& to) {
  for (const auto& material : from.materials()) take(material, to.materials.emplace_back());
  for (const auto& light : from.lights()) take(light, to.lights.emplace_back());
  for (const auto& viewpoint : from.viewpoints()) take(viewpoint, to.viewpoints.emplace_back());
  for (const auto& panel : from.panels()) to.panels.push_back({panel.name(), panel.text()});
  for (const auto& loss : from.losses()) to.losses.push_back(loss);
  for (const auto& sensor : from.sensors()) take(sensor, to.sensors.emplace_back());
}

}  // namespace visum::protocol::wire
