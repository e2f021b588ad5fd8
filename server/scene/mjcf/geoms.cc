#include "server/scene/mjcf/geoms.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "server/scene/hulls.h"
#include "server/scene/mjcf/meshes.h"

namespace visum::scene::mjcf {
namespace {

using Eigen::Vector3d;
using world::ShapeKind;

constexpr double kDensity = 1000.0;   // kg/m³, MuJoCo's
constexpr int kLastShownGroup = 2;    // viewers of MuJoCo hide those above
constexpr double kSheetM = 1e-3;      // thickness of a plane that is only seen
constexpr double kSheetSideM = 20.0;  // of one that is infinite
constexpr double kLeastSizeM = 1e-6;

class GeomReader {
 public:
  GeomReader(Reading& reading, const Element& element, const std::string& class_name)
      : reading_(reading), values_(reading.defaults.of(element, class_name)), element_(element) {}

  Geom read(const world::Pose& X_BF, bool with_mass) {
    geom_.element = &element_;
    geom_.types = bits("contype");
    geom_.meets = bits("conaffinity");
    type_ = values_.text_or("type", "sphere");
    shape_.name = element_.name().empty() ? type_ : element_.name();
    shape_.collides = geom_.types != 0 || geom_.meets != 0;
    X_BS_ = X_BF * read_pose(values_, reading_.settings);
    if (shape_.collides && values_.text("friction"))
      reading_.losses.add("friction of geoms is not read, surfaces are the scene's", element_);
    group_ = static_cast<int>(std::clamp(values_.number_or("group", 0.0), -1.0, 1000.0));
    read_color();
    if (const std::string* mesh = values_.text("mesh"); mesh && (type_ == "mesh" || type_ != "sdf"))
      read_mesh(*mesh, with_mass);
    else
      read_primitive(X_BF);
    if (!with_mass) geom_.mass = {};
    return std::move(geom_);
  }

 private:
  unsigned bits(std::string_view attribute) const {
    return static_cast<unsigned>(
        static_cast<std::int64_t>(std::clamp(values_.number_or(attribute, 1.0), -2e9, 2e9)));
  }

  void read_color() {
    if (const auto rgba = values_.numbers("rgba", 4, 4))
      shape_.color = {(*rgba)[0], (*rgba)[1], (*rgba)[2], (*rgba)[3]};
    else if (const std::string* material = values_.text("material"); material && !material->empty())
      shape_.color = reading_.assets.color(*material, element_);
    if (shape_.color)
      for (double& share : *shape_.color) share = std::clamp(share, 0.0, 1.0);
    if (group_ > kLastShownGroup) shape_.color = {0.0, 0.0, 0.0, 0.0};
  }

  // The given sizes: `count` of them, all positive.
  std::vector<double> sizes(std::size_t count) const {
    const auto all = values_.numbers("size", count, 3);
    if (!all && count > 0)
      element_.fail("a " + type_ + " needs " + std::to_string(count) + " numbers as size");
    std::vector<double> used(all->begin(), all->begin() + static_cast<long>(count));
    for (const double size : used)
      if (!(size > 0)) values_.fail("size", "size must be greater than 0");
    for (double& size : used) size = std::max(size, kLeastSizeM);
    return used;
  }

  // The sizes of a form along z; `fromto` gives its place and half its length. A box has two sides across.
  std::vector<double> long_sizes(std::size_t across, const world::Pose& X_BF) {
    const Element* given = values_.nearest_with({"fromto"});
    if (given == nullptr) return sizes(across + 1);
    const auto n = numbers_of(*given, "fromto", 6, 6);
    const Vector3d from(n[0], n[1], n[2]), to(n[3], n[4], n[5]);
    if ((from - to).norm() < kLeastSizeM) given->fail("fromto has no length");
    X_BS_ = X_BF * world::Pose{(from + to) / 2, turn_of_z(from - to)};
    auto used = sizes(1);
    used.resize(across, used[0]);
    used.push_back((from - to).norm() / 2);
    return used;
  }

  void read_primitive(const world::Pose& X_BF) {
    if (type_ == "plane") return read_plane();
    if (type_ == "hfield" || type_ == "sdf") return lose("geoms of type " + type_ + " are not simulated");
    if (type_ == "mesh") element_.fail("a geom of type mesh needs 'mesh'");
    if (type_ == "sphere") {
      const double r = sizes(1)[0];
      return add_solid(ShapeKind::kSphere, {r, 0, 0});
    }
    if (type_ == "capsule" || type_ == "cylinder") {
      const auto size = long_sizes(1, X_BF);
      return add_solid(type_ == "capsule" ? ShapeKind::kCapsule : ShapeKind::kCylinder,
                       {size[0], 2 * size[1], 0});
    }
    if (type_ != "box" && type_ != "ellipsoid")
      values_.fail("type", "there is no type '" + type_.substr(0, 60) + "' of geoms");
    const auto size = long_sizes(2, X_BF);
    if (type_ == "box") return add_solid(ShapeKind::kBox, {2 * size[0], 2 * size[1], 2 * size[2]});
    add_ellipsoid({size[0], size[1], size[2]});
  }

  void lose(const std::string& why) { reading_.losses.add(why, element_); }

  void read_plane() {
    const auto size = values_.numbers("size", 0, 3).value_or(std::vector<double>{});
    shape_.X_LS = X_BS_;
    shape_.kind = ShapeKind::kPlane;
    if (!shape_.collides) {
      const auto side = [&](std::size_t i) {
        return size.size() > i && size[i] > kLeastSizeM ? 2 * size[i] : kSheetSideM;
      };
      shape_.kind = ShapeKind::kBox;
      shape_.size = {side(0), side(1), kSheetM};
      shape_.X_LS = X_BS_ * world::Pose{{0, 0, -kSheetM / 2}, Eigen::Quaterniond::Identity()};
    }
    geom_.shapes.push_back(shape_);
  }

  void add_solid(ShapeKind kind, std::array<double, 3> size) {
    shape_.kind = kind;
    shape_.size = size;
    shape_.X_LS = X_BS_;
    world::Shape solid;
    solid.kind = kind;
    solid.size = size;
    set_mass(solid_of(solid, nullptr));
    geom_.shapes.push_back(shape_);
  }

  void add_ellipsoid(const Vector3d& radii) {
    const Vector3d squares = radii.cwiseAbs2();
    MassProperties solid;
    solid.mass_kg = 4.0 / 3.0 * std::numbers::pi * radii.prod();
    solid.inertia_C = solid.mass_kg / 5 *
                      (squares.sum() * Eigen::Matrix3d::Identity() - Eigen::Matrix3d(squares.asDiagonal()));
    set_mass(solid);
    static const world::TriangleMesh ball = ball_mesh();
    reading_.repairs.add("ellipsoids are made of triangles", element_);
    shape_.kind = shape_.collides ? ShapeKind::kConvex : ShapeKind::kMesh;
    add_mesh("(ball)", ball, radii);
  }

  // MuJoCo's mass of a solid of density 1, in the frame of `X_BS_`, becomes the geom's.
  void set_mass(const MassProperties& solid) {
    const int least = reading_.settings.least_mass_group, most = reading_.settings.most_mass_group;
    if (group_ < least || group_ > most || solid.mass_kg <= 0) return;
    double factor = values_.number_or("density", kDensity);
    if (values_.text("mass")) factor = values_.number_or("mass", 0.0) / solid.mass_kg;
    if (factor < 0) element_.fail("mass and density must be at least 0");
    geom_.mass = moved(scaled(solid, factor), X_BS_);
  }

  // Puts the mesh into the model, once for each name.
  void add_mesh(const std::string& name, const world::TriangleMesh& mesh, const Vector3d& scale) {
    shape_.mesh = reading_.model.file.string() + "#" + name;
    shape_.scale = scale;
    shape_.X_LS = X_BS_;
    auto& known = reading_.model.converted[shape_.mesh];
    if (known.parts.empty()) known.parts.push_back({mesh, std::nullopt});
    geom_.shapes.push_back(shape_);
  }

  // A mesh that is only seen may be missing.
  void read_mesh(const std::string& name, bool with_mass) {
    const world::TriangleMesh* mesh = nullptr;
    try {
      mesh = &reading_.assets.mesh(name, element_);
    } catch (const config::ConfigError& error) {
      if (shape_.collides || with_mass) throw;
      return lose("a mesh is not shown (" + error.message() + ")");
    }
    const MassProperties solid = with_mass || type_ != "mesh"
                                     ? solid_of_mesh(*mesh, reading_.settings.exact_mesh_inertia)
                                     : MassProperties{};
    if (type_ != "mesh") return fit(solid);
    if (with_mass && solid.mass_kg <= 0)
      element_.fail("mesh '" + name + "' has no volume, so it has no mass");
    set_mass(solid);
    const bool flat = is_flat(*mesh);
    if (shape_.collides && flat) {
      lose("a mesh without volume does not collide");
      shape_.collides = false;
    }
    if (!shape_.collides) {
      shape_.kind = ShapeKind::kMesh;
      return add_mesh(name, *mesh, Vector3d::Ones());
    }
    add_hull(name, *mesh);
  }

  void add_hull(const std::string& name, const world::TriangleMesh& mesh) {
    shape_.kind = ShapeKind::kConvex;
    if (mesh.vertices.size() <= kMaxHullVertices) return add_mesh(name, mesh, Vector3d::Ones());
    reading_.repairs.add(
        "hulls of more than " + std::to_string(kMaxHullVertices) + " vertices are thinned out", element_);
    const auto color = shape_.color;
    shape_.color = {0.0, 0.0, 0.0, 0.0};
    add_mesh(name + " (hull)", thin_hull(mesh), Vector3d::Ones());
    if (group_ > kLastShownGroup) return;
    shape_.color = color;
    shape_.collides = false;
    shape_.kind = ShapeKind::kMesh;
    add_mesh(name, mesh, Vector3d::Ones());
  }

  // A simple form of the mesh's moments of inertia replaces it, as in MuJoCo.
  void fit(const MassProperties& solid) {
    if (solid.mass_kg <= 0) element_.fail("a mesh without volume has no " + type_ + " around it");
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(solid.inertia_C);
    const Vector3d moments = solver.eigenvalues().reverse();  // the largest first: z is the longest way
    Eigen::Matrix3d R;
    R << solver.eigenvectors().col(2), solver.eigenvectors().col(1), solver.eigenvectors().col(0);
    if (R.determinant() < 0) R.col(2) = -R.col(2);
    Vector3d half;
    for (int i = 0; i < 3; ++i)
      half[i] = std::sqrt(std::max(6 * (moments.sum() - 2 * moments[i]) / solid.mass_kg, 0.0)) / 2;
    half = half.cwiseMax(kLeastSizeM);
    X_BS_ = X_BS_ * world::Pose{solid.com, Eigen::Quaterniond(R).normalized()};
    const double across = (half[0] + half[1]) / 2;
    if (type_ == "sphere") return add_solid(ShapeKind::kSphere, {half.mean(), 0, 0});
    if (type_ == "capsule")
      return add_solid(ShapeKind::kCapsule, {across, 2 * std::max(half[2] - across / 2, kLeastSizeM), 0});
    if (type_ == "cylinder") return add_solid(ShapeKind::kCylinder, {across, 2 * half[2], 0});
    if (type_ == "box") return add_solid(ShapeKind::kBox, {2 * half[0], 2 * half[1], 2 * half[2]});
    if (type_ == "ellipsoid") return add_ellipsoid(half);
    values_.fail("type", "no geom of type '" + type_.substr(0, 60) + "' can be fitted to a mesh");
  }

  Reading& reading_;
  const Values values_;
  const Element& element_;
  Geom geom_;
  RobotShape shape_;
  std::string type_;
  world::Pose X_BS_;
  int group_ = 0;
};

}  // namespace

Geom read_geom(Reading& reading, const Element& element, const std::string& class_name,
               const world::Pose& X_BF, bool with_mass) {
  return GeomReader(reading, element, class_name).read(X_BF, with_mass);
}

}  // namespace visum::scene::mjcf
