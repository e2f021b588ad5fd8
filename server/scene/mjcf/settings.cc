#include "server/scene/mjcf/settings.h"

#include <algorithm>
#include <cmath>

#include "protocol/config/trig.h"

namespace visum::scene::mjcf {
namespace {

constexpr double kLeastLength = 1e-10;
constexpr double kMaxAngle = 1e5;

bool is_true(const Element& element, std::string_view attribute) {
  return Values(element, {}).flag(attribute).value_or(false);
}

double number(const Element& element, std::string_view attribute, double otherwise) {
  return element.attribute(attribute) ? numbers_of(element, attribute, 1, 1)[0] : otherwise;
}

void read_angles(const Element& compiler, Settings& settings) {
  if (const std::string* angle = compiler.attribute("angle")) {
    if (*angle != "radian" && *angle != "degree")
      compiler.fail("angle must be radian or degree, is '" + angle->substr(0, 60) + "'");
    settings.radians_per_angle = *angle == "radian" ? 1.0 : Settings().radians_per_angle;
  }
  if (const std::string* sequence = compiler.attribute("eulerseq")) {
    if (sequence->size() != 3 || sequence->find_first_not_of("xyzXYZ") != std::string::npos)
      compiler.fail("eulerseq must be 3 letters of xyzXYZ, is '" + sequence->substr(0, 60) + "'");
    settings.euler_sequence = *sequence;
  }
  if (const std::string* frame = compiler.attribute("coordinate"); frame && *frame != "local")
    compiler.fail("coordinate '" + frame->substr(0, 60) +
                  "' is not read: only local ones are; MuJoCo 2.3 and later want them, too");
}

void read_masses(const Element& compiler, Settings& settings) {
  if (compiler.attribute("balanceinertia")) settings.balance_inertia = is_true(compiler, "balanceinertia");
  if (compiler.attribute("exactmeshinertia"))
    settings.exact_mesh_inertia = is_true(compiler, "exactmeshinertia");
  if (compiler.attribute("inertiafromgeom"))
    settings.inertia_from_geoms = Values(compiler, {}).flag("inertiafromgeom");
  settings.least_mass = number(compiler, "boundmass", settings.least_mass);
  settings.least_inertia = number(compiler, "boundinertia", settings.least_inertia);
  settings.total_mass = number(compiler, "settotalmass", settings.total_mass);
  if (compiler.attribute("inertiagrouprange")) {
    const auto range = numbers_of(compiler, "inertiagrouprange", 2, 2);
    settings.least_mass_group = static_cast<int>(std::clamp(range[0], -1.0, 1000.0));
    settings.most_mass_group = static_cast<int>(std::clamp(range[1], -1.0, 1000.0));
  }
}

void read_compiler(const Element& compiler, Settings& settings) {
  read_angles(compiler, settings);
  read_masses(compiler, settings);
  if (const std::string* folder = compiler.attribute("assetdir")) settings.mesh_folder = *folder;
  if (const std::string* folder = compiler.attribute("meshdir")) settings.mesh_folder = *folder;
  if (compiler.attribute("strippath")) settings.strip_path = is_true(compiler, "strippath");
  if (compiler.attribute("autolimits")) settings.auto_limits = is_true(compiler, "autolimits");
}

Eigen::Vector3d unit(const Element& element, std::string_view attribute, const Eigen::Vector3d& v) {
  if (v.norm() < kLeastLength) element.fail(std::string(attribute) + " must not be zero");
  return v.normalized();
}

double angle(const Element& element, std::string_view attribute, double given, const Settings& settings) {
  if (std::abs(given) > kMaxAngle) element.fail(std::string(attribute) + " is an angle beyond 1e5");
  return given * settings.radians_per_angle;
}

Eigen::Quaterniond of_euler(const Element& element, const Settings& settings) {
  const auto angles = numbers_of(element, "euler", 3, 3);
  Eigen::Quaterniond q = Eigen::Quaterniond::Identity();
  for (std::size_t i = 0; i < 3; ++i) {
    const char axis = settings.euler_sequence[i];
    const bool fixed = axis >= 'X' && axis <= 'Z';  // capital letters: about the axes that do not turn along
    const int index = axis - (fixed ? 'X' : 'x');
    const auto turn = turn_about(Eigen::Vector3d::Unit(index), angle(element, "euler", angles[i], settings));
    q = fixed ? turn * q : q * turn;
  }
  return q.normalized();
}

Eigen::Quaterniond of_axes(const Element& element) {
  const auto n = numbers_of(element, "xyaxes", 6, 6);
  const Eigen::Vector3d x = unit(element, "xyaxes", {n[0], n[1], n[2]});
  const Eigen::Vector3d given(n[3], n[4], n[5]);
  const Eigen::Vector3d y = unit(element, "xyaxes", given - given.dot(x) * x);
  Eigen::Matrix3d R;
  R << x, y, x.cross(y);
  return Eigen::Quaterniond(R).normalized();
}

}  // namespace

Eigen::Quaterniond turn_about(const Eigen::Vector3d& unit_axis, double radians) {
  const config::SinCos half = config::sin_cos(radians / 2);
  const Eigen::Vector3d v = half.sin * unit_axis;
  return {half.cos, v[0], v[1], v[2]};
}

Eigen::Quaterniond turn_of_z(const Eigen::Vector3d& direction) {
  const Eigen::Vector3d d = direction.normalized();
  const Eigen::Vector3d axis = Eigen::Vector3d::UnitZ().cross(d);
  if (axis.norm() < kLeastLength)
    return d.z() > 0 ? Eigen::Quaterniond::Identity() : Eigen::Quaterniond(0, 1, 0, 0);
  return turn_about(axis.normalized(), config::arc_tangent(axis.norm(), d.z()));
}

std::optional<Eigen::Quaterniond> read_turn(const Values& values, const Settings& settings) {
  const Element* element = values.nearest_with({"quat", "axisangle", "euler", "xyaxes", "zaxis"});
  if (element == nullptr) return std::nullopt;
  if (element->attribute("axisangle")) {
    const auto n = numbers_of(*element, "axisangle", 4, 4);
    return turn_about(unit(*element, "axisangle", {n[0], n[1], n[2]}),
                      angle(*element, "axisangle", n[3], settings));
  }
  if (element->attribute("euler")) return of_euler(*element, settings);
  if (element->attribute("xyaxes")) return of_axes(*element);
  if (element->attribute("zaxis")) {
    const auto n = numbers_of(*element, "zaxis", 3, 3);
    return turn_of_z(unit(*element, "zaxis", {n[0], n[1], n[2]}));
  }
  const auto n = numbers_of(*element, "quat", 4, 4);
  const Eigen::Quaterniond q(n[0], n[1], n[2], n[3]);
  if (q.norm() < kLeastLength) element->fail("quat must not be zero");
  return q.normalized();
}

world::Pose read_pose(const Values& values, const Settings& settings) {
  world::Pose pose;
  if (const auto p = values.numbers("pos", 3, 3)) pose.p = {(*p)[0], (*p)[1], (*p)[2]};
  pose.q = read_turn(values, settings).value_or(Eigen::Quaterniond::Identity());
  return pose;
}

Settings read_settings(const Element& root) {
  Settings settings;
  each_child(root, "compiler", [&](const Element& compiler) { read_compiler(compiler, settings); });
  each_child(root, "option", [&](const Element& option) {
    if (option.attribute("gravity")) {
      const auto g = numbers_of(option, "gravity", 3, 3);
      settings.gravity = {g[0], g[1], g[2]};
    }
    if (const std::string* which = option.attribute("collision"))
      settings.only_pairs_collide = *which == "predefined";
    each_child(option, "flag", [&](const Element& flag) {
      const std::string* gravity = flag.attribute("gravity");
      if (gravity && *gravity == "disable") settings.gravity.setZero();
    });
  });
  return settings;
}

}  // namespace visum::scene::mjcf
