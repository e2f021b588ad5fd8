#include <algorithm>

#include "protocol/config/read_file.h"
#include "protocol/config/unknown_name.h"
#include "server/scene/mesh_path.h"
#include "server/scene/mesh_readers.h"
#include "server/scene/mjcf/meshes.h"
#include "server/scene/mjcf/reading.h"

namespace visum::scene::mjcf {
namespace {

namespace fs = std::filesystem;

std::vector<std::string> names_of(const std::map<std::string, const Element*>& entries) {
  std::vector<std::string> names;
  for (const auto& [name, element] : entries) names.push_back(name);
  return names;
}

// Without a name, a mesh has that of its file.
std::string asset_name(const Element& element) {
  if (const std::string* name = element.attribute("name")) return *name;
  const std::string* file = element.attribute("file");
  return file ? fs::path(*file).stem().string() : std::string();
}

// Corners of the faces that an asset gives in the text itself.
world::TriangleMesh read_inline(const Element& element) {
  constexpr std::size_t kMost = world::kMaxTriangles * 3;
  const auto numbers = numbers_of(element, "vertex", 12, kMost);
  if (!element.attribute("face")) element.fail("vertices without 'face' are not read");
  const auto corners = numbers_of(element, "face", 3, kMost);
  if (numbers.size() % 3 != 0 || corners.size() % 3 != 0) element.fail("vertex and face need 3 numbers each");
  MeshBuilder builder(*element.file);
  for (std::size_t i = 0; i < corners.size(); i += 3) {
    std::array<Eigen::Vector3d, 3> triangle;
    for (std::size_t k = 0; k < 3; ++k) {
      const double index = corners[i + k];
      if (index < 0 || index >= static_cast<double>(numbers.size() / 3))
        element.fail("face names a vertex that does not exist");
      const std::size_t at = 3 * static_cast<std::size_t>(index);
      triangle[k] = {numbers[at], numbers[at + 1], numbers[at + 2]};
    }
    builder.add(triangle, element.line);
  }
  return builder.take();
}

}  // namespace

Assets::Assets(const Element& root, const Defaults& defaults, const Settings& settings,
               const fs::path& model_file, const Packages& packages)
    : defaults_(defaults), settings_(settings), model_file_(model_file), packages_(packages) {
  each_child(root, "asset", [&](const Element& section) {
    each_child(section, "mesh", [&](const Element& mesh) { meshes_.try_emplace(asset_name(mesh), &mesh); });
    each_child(section, "material",
               [&](const Element& material) { materials_.try_emplace(material.name(), &material); });
  });
}

const world::TriangleMesh& Assets::mesh(const std::string& name, const Element& user) {
  if (const auto known = read_.find(name); known != read_.end()) return known->second;
  const auto found = meshes_.find(name);
  if (found == meshes_.end()) user.fail(config::unknown_name("mesh", name, names_of(meshes_)));
  world::TriangleMesh mesh = read(*found->second);
  triangles_ += mesh.triangles.size();
  if (triangles_ > world::kMaxTriangles)
    found->second->fail("the meshes have more than " + std::to_string(world::kMaxTriangles) + " triangles");
  return read_.emplace(name, std::move(mesh)).first->second;
}

std::optional<std::array<double, 4>> Assets::color(const std::string& material, const Element& user) const {
  const auto found = materials_.find(material);
  if (found == materials_.end()) user.fail(config::unknown_name("material", material, names_of(materials_)));
  const auto rgba = defaults_.of(*found->second, "").numbers("rgba", 4, 4);
  if (!rgba) return std::nullopt;
  return std::array<double, 4>{(*rgba)[0], (*rgba)[1], (*rgba)[2], (*rgba)[3]};
}

world::TriangleMesh Assets::read(const Element& element) const {
  const Values values = defaults_.of(element, "");
  const std::string* address = element.attribute("file");
  if (address == nullptr && !element.attribute("vertex")) element.fail("has neither 'file' nor 'vertex'");
  world::TriangleMesh mesh = address ? read_file(element, *address) : read_inline(element);
  Eigen::Vector3d p = Eigen::Vector3d::Zero(), scale = Eigen::Vector3d::Ones();
  if (const auto n = values.numbers("scale", 3, 3)) scale = {(*n)[0], (*n)[1], (*n)[2]};
  if (scale.cwiseAbs().minCoeff() == 0.0) values.fail("scale", "scale must not be zero");
  if (const auto n = values.numbers("refpos", 3, 3)) p = {(*n)[0], (*n)[1], (*n)[2]};
  Eigen::Quaterniond q = Eigen::Quaterniond::Identity();
  if (const auto n = values.numbers("refquat", 4, 4))
    q = Eigen::Quaterniond((*n)[0], (*n)[1], (*n)[2], (*n)[3]);
  if (q.norm() == 0.0) values.fail("refquat", "refquat must not be zero");
  const Eigen::Matrix3d R = q.normalized().toRotationMatrix().transpose();
  for (Eigen::Vector3d& vertex : mesh.vertices) vertex = scale.cwiseProduct(R * (vertex - p));
  if (scale.prod() < 0)
    for (auto& triangle : mesh.triangles) std::swap(triangle[1], triangle[2]);
  return mesh;
}

world::TriangleMesh Assets::read_file(const Element& element, const std::string& address) const {
  std::string path = settings_.strip_path ? fs::path(address).filename().string() : address;
  if (address.find("://") == std::string::npos) path = (fs::path(settings_.mesh_folder) / path).string();
  const fs::path file = resolve_mesh(path, model_file_, packages_, element.place());
  if (lower_extension(file) != ".msh") return read_mesh(file, element.place());
  const config::FileContent content = config::read_file(file, kMaxMeshBytes);
  if (!content.fault.empty()) element.fail("'" + file.string() + "': " + content.fault);
  world::TriangleMesh mesh = read_msh(content.bytes, {file.string(), 0, ""});
  mesh.name = file.filename().string();
  return mesh;
}

void Remarks::add(const std::string& sentence, const Element& about) {
  const auto known =
      std::find_if(kinds_.begin(), kinds_.end(), [&](const Kind& kind) { return kind.sentence == sentence; });
  if (known == kinds_.end())
    kinds_.push_back({sentence, &about, 1});
  else
    ++known->count;
}

std::vector<Remark> Remarks::all(const fs::path& file) const {
  std::vector<Remark> remarks;
  for (const Kind& kind : kinds_) {
    std::string text = kind.sentence + ": " + kind.first->place().key;
    if (kind.count > 1)
      text += " and " + std::to_string(kind.count - 1) + (kind.count == 2 ? " other" : " others");
    remarks.push_back({text, kind.first->line, *kind.first->file == file.string() ? "" : *kind.first->file});
  }
  return remarks;
}

}  // namespace visum::scene::mjcf
