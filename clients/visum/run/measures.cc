#include "clients/visum/run/measures.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "clients/visum/common/format.h"
#include "clients/visum/run/lookup.h"

namespace visum::run::measures {
namespace {

using Vector = std::array<double, 3>;

constexpr double kNothing = std::numeric_limits<double>::quiet_NaN();

// A short sample gives NaN, which holds no bound.
double at(const std::vector<double>& values, std::size_t index) {
  return index < values.size() ? values[index] : kNothing;
}

Vector vector_at(const std::vector<double>& values, std::size_t first) {
  return {at(values, first), at(values, first + 1), at(values, first + 2)};
}

double norm(const Vector& v) {
  return std::hypot(v[0], v[1], v[2]);
}

Vector body_position(const Observation& now, std::size_t body) {
  return vector_at(now.world.poses, 7 * body);
}

// The z component, in the world, of the body's own axis 0, 1 or 2; from its unit quaternion (w, x, y, z).
double axis_upward(const Observation& now, std::size_t body, int axis) {
  const std::size_t first = 7 * body + 3;
  const double w = at(now.world.poses, first);
  const Vector v = vector_at(now.world.poses, first + 1);
  if (axis == 0) return 2.0 * (v[0] * v[2] - w * v[1]);
  if (axis == 1) return 2.0 * (v[1] * v[2] + w * v[0]);
  return 1.0 - 2.0 * (v[0] * v[0] + v[1] * v[1]);
}

int axis_index(char axis) {
  return axis - 'x';
}

std::string unit_of(const std::vector<protocol::JointDescription>& joints,
                    const std::vector<std::size_t>& indices) {
  const auto is_slider = [&](std::size_t i) { return joints[i].type == "slider"; };
  if (std::all_of(indices.begin(), indices.end(), is_slider)) return "m";
  return std::none_of(indices.begin(), indices.end(), is_slider) ? "rad" : "rad or m";
}

std::string joint_unit(const std::string& kind, const std::string& unit) {
  if (kind == "joint_speed") return unit + "/s";
  if (kind == "joint_effort") return unit == "m" ? "N" : "Nm";
  return unit;
}

std::string body_unit(const std::string& kind) {
  if (kind == "tilt") return "rad";
  if (kind == "speed") return "m/s";
  if (kind == "angular_speed") return "rad/s";
  return kind == "contact_force" ? "N" : "m";
}

std::string readable(std::string kind) {
  std::replace(kind.begin(), kind.end(), '_', ' ');
  return kind;
}

}  // namespace

// ------------------------------------------------------------------------------------------------ tying

void tie_body(const Catalogue& catalogue, Quantity& quantity) {
  const QuantitySpec& spec = *quantity.spec;
  quantity.indices = {find_body(catalogue, spec.body, spec.place)};
  quantity.unit = body_unit(spec.kind);
  quantity.text = (spec.kind == "position" ? spec.axes : readable(spec.kind)) + " of " + spec.body;
}

void tie_distance(const Catalogue& catalogue, Quantity& quantity) {
  const QuantitySpec& spec = *quantity.spec;
  quantity.indices = {find_body(catalogue, spec.body, spec.place)};
  quantity.unit = "m";
  std::string target = spec.other_body;
  if (!target.empty()) {
    quantity.indices.push_back(find_body(catalogue, target, spec.place));
  } else {
    for (const double x : spec.point) target += (target.empty() ? "(" : " ") + cli::exact(x);
    target += ")";
  }
  quantity.text =
      "distance of " + spec.body + " to " + target + (spec.axes == "xyz" ? "" : " in " + spec.axes);
}

void tie_touching(const Catalogue& catalogue, Quantity& quantity) {
  const QuantitySpec& spec = *quantity.spec;
  quantity.indices = {find_body(catalogue, spec.body, spec.place),
                      find_body(catalogue, spec.other_body, spec.place)};
  quantity.text = spec.body + " touching " + spec.other_body;
}

void tie_joint(const Catalogue& catalogue, Quantity& quantity) {
  const QuantitySpec& spec = *quantity.spec;
  quantity.indices = {find_joint(catalogue, spec.joint, spec.place)};
  quantity.unit = joint_unit(spec.kind, unit_of(catalogue.world.joints, quantity.indices));
  quantity.text = readable(spec.kind) + " of " + spec.joint;
}

void tie_joints_of_part(const Catalogue& catalogue, Quantity& quantity) {
  const QuantitySpec& spec = *quantity.spec;
  if (!spec.joint.empty()) return tie_joint(catalogue, quantity);
  find_part(catalogue, spec.part, spec.place);
  for (std::size_t i = 0; i < catalogue.world.joints.size(); ++i) {
    if (catalogue.world.joints[i].part == spec.part) quantity.indices.push_back(i);
  }
  if (quantity.indices.empty())
    throw config::ConfigError(spec.place, "part '" + spec.part + "' drives no joint");
  quantity.unit = unit_of(catalogue.world.joints, quantity.indices);
  quantity.text = readable(spec.kind) + " of " + spec.part;
}

void tie_port(const Catalogue& catalogue, Quantity& quantity) {
  const QuantitySpec& spec = *quantity.spec;
  const PortPlace found = find_port(find_part(catalogue, spec.part, spec.place), spec.port, spec.place);
  quantity.indices = {found.index};
  quantity.output = found.output;
  quantity.unit = found.port->unit;
  quantity.port = *found.port;
  quantity.text = spec.part + ": " + spec.port;
  if (spec.mask) quantity.text += " & " + std::to_string(*spec.mask);
}

void tie_coverage(const Catalogue& catalogue, Quantity& quantity) {
  const QuantitySpec& spec = *quantity.spec;
  quantity.indices = {find_body(catalogue, spec.body, spec.place)};
  std::vector<Coverage::Obstacle> obstacles;
  for (std::size_t i = 0; i < catalogue.world.bodies.size(); ++i) {
    const auto& body = catalogue.world.bodies[i];
    for (const auto& shape : body.shapes) {
      if (!body.fixed || !shape.collides) continue;
      if (!is_plain(shape))
        throw config::ConfigError(spec.place, "the floor below '" + body.name + "', which has a " +
                                                  shape.kind +
                                                  ", cannot be told; of boxes, spheres, cylinders, capsules "
                                                  "and planes it can");
      obstacles.push_back({i, shape});
    }
  }
  quantity.coverage = Coverage(spec.floor, std::move(obstacles));
  quantity.text = "share of the floor within " + cli::exact(spec.floor.within_m) + " m of " + spec.body;
}

void tie_nothing(const Catalogue&, Quantity& quantity) {
  quantity.unit = "s";
  quantity.text = "time";
}

// ------------------------------------------------------------------------------------------------ measuring

double distance(Quantity& self, const Observation& now) {
  const Vector from = body_position(now, self.indices[0]);
  const auto& point = self.spec->point;
  const Vector to =
      self.indices.size() > 1 ? body_position(now, self.indices[1]) : Vector{point[0], point[1], point[2]};
  Vector difference{};
  for (const char axis : self.spec->axes) {
    const auto i = static_cast<std::size_t>(axis_index(axis));
    difference[i] = to[i] - from[i];
  }
  return norm(difference);
}

double position(Quantity& self, const Observation& now) {
  return body_position(now, self.indices[0])[static_cast<std::size_t>(axis_index(self.spec->axes[0]))];
}

double tilt(Quantity& self, const Observation& now) {
  const double upward = axis_upward(now, self.indices[0], axis_index(self.spec->axes[0]));
  return std::acos(std::clamp(upward, -1.0, 1.0));
}

double speed(Quantity& self, const Observation& now) {
  return norm(vector_at(now.world.velocities, 6 * self.indices[0]));
}

double angular_speed(Quantity& self, const Observation& now) {
  return norm(vector_at(now.world.velocities, 6 * self.indices[0] + 3));
}

double contact_force(Quantity& self, const Observation& now) {
  return at(now.world.peak_contact_forces, self.indices[0]);
}

double touching(Quantity& self, const Observation& now) {
  const auto a = self.indices[0], b = self.indices[1];
  const auto between = [&](const protocol::ContactSample& contact) {
    return (contact.body_a == a && contact.body_b == b) || (contact.body_a == b && contact.body_b == a);
  };
  return std::any_of(now.world.contacts.begin(), now.world.contacts.end(), between) ? 1.0 : 0.0;
}

double joint_position(Quantity& self, const Observation& now) {
  return at(now.world.joint_positions, self.indices[0]);
}

double joint_speed(Quantity& self, const Observation& now) {
  return at(now.world.joint_velocities, self.indices[0]);
}

double joint_effort(Quantity& self, const Observation& now) {
  return at(now.world.joint_efforts, self.indices[0]);
}

double peak_following_error(Quantity& self, const Observation& now) {
  double largest = 0.0;
  for (const std::size_t joint : self.indices) {
    const double error = at(now.world.peak_following_errors, joint);
    if (!(error <= largest)) largest = error;  // NaN wins
    if (std::isnan(largest)) break;
  }
  return largest;
}

double port(Quantity& self, const Observation& now) {
  const auto sample = now.parts.find(self.spec->part);
  if (sample == now.parts.end()) return kNothing;
  const double value =
      at(self.output ? sample->second.sensor_outputs : sample->second.controller_inputs, self.indices[0]);
  if (!self.spec->mask || !(value >= 0.0 && value < 0x1p63)) return value;
  return static_cast<double>(static_cast<std::uint64_t>(value) & *self.spec->mask);
}

double coverage(Quantity& self, const Observation& now) {
  const Vector here = body_position(now, self.indices[0]);
  self.coverage.note(here[0], here[1], now.world.poses);
  return self.coverage.share();
}

double time(Quantity&, const Observation& now) {
  return static_cast<double>(now.world.sim_time_ns) * 1e-9;
}

}  // namespace visum::run::measures
