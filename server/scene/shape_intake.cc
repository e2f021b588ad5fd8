#include "server/scene/shape_intake.h"

#include <set>

#include "protocol/config/config.h"
#include "server/scene/mesh_path.h"
#include "server/scene/mesh_readers.h"

namespace visum::scene {
namespace {

void fade(RobotShape& shape, double opacity) {
  if (opacity == 1.0) return;
  if (!shape.color) shape.color = world::Shape{}.color;
  (*shape.color)[3] *= opacity;
}

}  // namespace

config::Place ShapeIntake::place_of(const RobotLink& link) const {
  return {link.file.empty() ? model_.file.string() : link.file, link.line, "link '" + link.name + "'"};
}

void ShapeIntake::convert_ahead(const std::vector<MeshAddress>& meshes) {
  std::set<std::filesystem::path> files;
  for (const auto& [address, model_file] : meshes) {
    if (!is_collada(address)) continue;
    try {
      files.insert(resolve_mesh(address, model_file, packages_, {model_file, 0, ""}));
    } catch (const config::ConfigError&) {
      // find_mesh() reports it where its shape is read.
    }
  }
  const std::vector<std::filesystem::path> list(files.begin(), files.end());
  std::vector<ColladaResult> results = read_all_collada(list);
  for (std::size_t i = 0; i < list.size(); ++i)
    take(list[i], [&] {
      if (results[i].fault) std::rethrow_exception(results[i].fault);
      return std::move(results[i].mesh);
    });
}

std::string ShapeIntake::find_mesh(const std::string& address, const RobotLink& link, RobotShape& shape) {
  const bool collada = is_collada(address);
  if (!collada && !is_mesh_format(address))
    return "is the mesh '" + address + "', and only .stl, .obj and .dae are read";
  shape.kind = world::ShapeKind::kMesh;
  const config::Place place = place_of(link);
  try {
    shape.mesh = resolve_mesh(address, place.file, packages_, place);
  } catch (const config::ConfigError& error) {
    if (shape.collides) throw;
    return "is the " + error.message();
  }
  return collada ? convert(shape.mesh) : check_seen_mesh(shape, link);
}

void ShapeIntake::add(RobotShape shape, const std::string& fault, double opacity, RobotLink& link) {
  if (!fault.empty() && shape.collides)
    throw config::ConfigError(place_of(link), "collision '" + shape.name + "' " + fault);
  if (!fault.empty()) {
    leave_out(shape, fault, link);
  } else if (is_collada(shape.mesh)) {
    add_parts(shape, opacity, link);
  } else {
    fade(shape, opacity);
    link.shapes.push_back(std::move(shape));
  }
}

void ShapeIntake::leave_out(const RobotShape& shape, const std::string& fault, const RobotLink& link) {
  const std::string what = shape.collides ? "collision '" : "visual '";
  const std::string fate = shape.collides ? "' collides with nothing: it " : "' is not shown: it ";
  model_.losses.push_back(
      {what + shape.name + "' of link '" + shape.link + fate + fault, link.line, link.file});
}

void ShapeIntake::add_parts(const RobotShape& whole, double opacity, RobotLink& link) {
  const ColladaMesh& mesh = model_.converted.at(whole.mesh);
  for (std::size_t part = 0; part < mesh.parts.size(); ++part) {
    link.shapes.push_back(whole);
    link.shapes.back().mesh_part = part;
    if (!whole.color) link.shapes.back().color = mesh.parts[part].color;
    fade(link.shapes.back(), opacity);
  }
  if (mesh.textured && !whole.collides)
    model_.losses.push_back(
        {"visual '" + whole.name + "' of link '" + link.name + "' is shown without the textures of its mesh",
         link.line, link.file});
}

// A mesh that is only seen may be broken. Returns the reason.
std::string ShapeIntake::check_seen_mesh(const RobotShape& shape, const RobotLink& link) {
  if (shape.collides) return "";
  const auto [entry, is_new] = seen_meshes_.try_emplace(shape.mesh);
  if (!is_new) return entry->second;
  try {
    model_.seen.emplace(shape.mesh, read_mesh(shape.mesh, place_of(link)));
  } catch (const config::ConfigError& error) {
    entry->second = "is the mesh '" + shape.mesh.string() + "', which " + error.message();
  }
  return entry->second;
}

// Converts each file once. If it cannot, returns the reason.
std::string ShapeIntake::convert(const std::filesystem::path& file) {
  if (const auto failed = not_converted_.find(file); failed != not_converted_.end()) return failed->second;
  if (model_.converted.count(file) != 0) return "";
  return take(file, [&] { return read_collada(file); });
}

std::string ShapeIntake::take(const std::filesystem::path& file, const std::function<ColladaMesh()>& mesh) {
  try {
    model_.converted.emplace(file, mesh());
    return "";
  } catch (const std::runtime_error& error) {
    return not_converted_[file] = "is the mesh '" + file.string() + "': " + error.what();
  }
}

}  // namespace visum::scene
