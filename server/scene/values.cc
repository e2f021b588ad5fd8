#include "server/scene/values.h"

#include <cmath>

#include "protocol/config/printable.h"
#include "server/world/turn.h"

namespace visum::scene {
namespace {

constexpr double kQuaternionTolerance = 1e-3;  // rounding to four digits may cost so much
// A unit vector may be off by so much. It is then left as it is, so that a number written with all its digits
// is read with all its bits.
constexpr double kRounding = 1e-15;

Eigen::Quaterniond read_quaternion(const config::Node& node) {
  const std::vector<double> wxyz = node.numbers(4, config::Range{-1.0, 1.0});
  const Eigen::Quaterniond q(wxyz[0], wxyz[1], wxyz[2], wxyz[3]);
  if (std::abs(q.norm() - 1.0) > kQuaternionTolerance)
    node.fail("must be a unit quaternion [w, x, y, z], has length " + std::to_string(q.norm()));
  return std::abs(q.squaredNorm() - 1.0) <= kRounding ? q : q.normalized();
}

}  // namespace

std::string name_fault(const std::string& name) {
  if (name.empty()) return "must not be empty";
  if (name.size() > kMaxNameBytes) return "must have at most " + std::to_string(kMaxNameBytes) + " bytes";
  if (!config::is_printable(name)) return config::kNotPrintable;
  if (name.find('/') != std::string::npos) return "must not hold a '/', is '" + name + "'";
  if (name.front() == ' ' || name.back() == ' ')
    return "must not begin or end with a blank, is '" + name + "'";
  return "";
}

std::string yaml_quoted(const std::string& text) {
  std::string quoted = "'";
  for (const char c : text) quoted += c == '\'' ? "''" : std::string(1, c);
  return quoted + "'";
}

std::string read_name(const config::Node& node) {
  const std::string name = node.text();
  if (const std::string fault = name_fault(name); !fault.empty()) node.fail(fault);
  return name;
}

Eigen::Vector3d read_vector(const config::Node& node, config::Range range) {
  const std::vector<double> xyz = node.numbers(3, range);
  return {xyz[0], xyz[1], xyz[2]};
}

Eigen::Quaterniond quaternion_from_rpy(const Eigen::Vector3d& rpy) {
  using Eigen::Vector3d;
  return world::turn_about(Vector3d::UnitZ(), rpy[2]) * world::turn_about(Vector3d::UnitY(), rpy[1]) *
         world::turn_about(Vector3d::UnitX(), rpy[0]);
}

world::Pose read_pose(const config::Node& node) {
  if (const auto in = node.find("in"))
    in->fail("only things that are placed in the world can stand in a frame");
  return read_pose_in(node);
}

world::Pose read_pose_in(const config::Node& node) {
  node.allow_only({"in", "xyz", "rpy", "wxyz"});
  world::Pose pose;
  if (const auto xyz = node.find("xyz")) pose.p = read_vector(*xyz);
  const auto rpy = node.find("rpy");
  const auto wxyz = node.find("wxyz");
  if (rpy && wxyz) node.fail("has both 'rpy' and 'wxyz', one is enough");
  if (rpy) pose.q = quaternion_from_rpy(read_vector(*rpy));
  if (wxyz) pose.q = read_quaternion(*wxyz);
  return pose;
}

world::Pose read_pose_or_identity(const config::Node& map, std::string_view key) {
  const auto node = map.find(key);
  return node ? read_pose(*node) : world::Pose{};
}

std::array<double, 4> read_color(const config::Node& node) {
  const std::size_t count = node.size();
  if (count != 3 && count != 4)
    node.fail("must be [r, g, b] or [r, g, b, a], has " + std::to_string(count) + " numbers");
  const std::vector<double> rgba = node.numbers(count, config::Range{0.0, 1.0});
  return {rgba[0], rgba[1], rgba[2], count == 4 ? rgba[3] : 1.0};
}

Eigen::Vector3d read_axis(const config::Node& node) {
  const Eigen::Vector3d axis = read_vector(node);
  if (axis.norm() < 1e-6) node.fail("must not be zero");
  return std::abs(axis.squaredNorm() - 1.0) <= kRounding ? axis : axis.normalized();
}

std::filesystem::path read_path(const config::Node& node) {
  const std::string text = node.text();
  if (text.empty()) node.fail("must not be empty");
  if (text.find('\0') != std::string::npos) node.fail("must not hold a zero byte");
  if (text.find("://") != std::string::npos) node.fail("must be a file, is the address '" + text + "'");
  return (node.folder() / text).lexically_normal();
}

}  // namespace visum::scene
