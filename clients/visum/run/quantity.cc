#include "clients/visum/run/quantity.h"

#include <algorithm>
#include <utility>

#include "clients/visum/run/lookup.h"
#include "clients/visum/run/measures.h"

namespace visum::run {
namespace {

using config::Node;

void read_body(const Node& node, QuantitySpec& spec) {
  spec.body = node.get("body").text();
}

void read_axis(const Node& node, QuantitySpec& spec, const char* otherwise) {
  const auto axis = node.find("axis");
  spec.axes = axis ? axis->one_of({"x", "y", "z"}) : otherwise;
}

void read_position(const Node& node, QuantitySpec& spec) {
  read_body(node, spec);
  node.get("axis");
  read_axis(node, spec, "");
}

void read_tilt(const Node& node, QuantitySpec& spec) {
  read_body(node, spec);
  read_axis(node, spec, "z");
}

void read_distance(const Node& node, QuantitySpec& spec) {
  read_body(node, spec);
  const Node to = node.get("to");
  if (to.kind() == Node::Kind::kList) {
    spec.point = to.numbers(3);
  } else {
    spec.other_body = to.text();
  }
  const auto axes = node.find("axes");
  spec.axes = axes ? axes->one_of({"xyz", "xy", "xz", "yz", "x", "y", "z"}) : "xyz";
}

void read_touching(const Node& node, QuantitySpec& spec) {
  read_body(node, spec);
  spec.other_body = node.get("with").text();
}

void read_joint(const Node& node, QuantitySpec& spec) {
  spec.joint = node.get("joint").text();
}

void read_part_or_joint(const Node& node, QuantitySpec& spec) {
  const auto part = node.find("part"), joint = node.find("joint");
  if (part.has_value() == joint.has_value()) node.fail("needs either 'part' or 'joint'");
  if (part) spec.part = part->text();
  if (joint) spec.joint = joint->text();
}

void read_port(const Node& node, QuantitySpec& spec) {
  spec.part = node.get("part").text();
  spec.port = node.get("name").text();
  if (const auto mask = node.find("mask")) spec.mask = static_cast<std::uint64_t>(mask->integer(1));
}

std::array<double, 2> read_corner(const Node& node) {
  const auto numbers = node.numbers(2);
  return {numbers[0], numbers[1]};
}

void read_coverage(const Node& node, QuantitySpec& spec) {
  constexpr config::Range kLength{1e-3, 1e4};
  read_body(node, spec);
  FloorSpec& floor = spec.floor;
  floor.within_m = node.get("within").number(kLength);
  floor.from = read_corner(node.get("from"));
  floor.to = read_corner(node.get("to"));
  floor.cell_m = node.number_or("cell", floor.cell_m, kLength);
  floor.height_m = node.number_or("height", floor.height_m);
  const double wide = (floor.to[0] - floor.from[0]) / floor.cell_m;
  const double deep = (floor.to[1] - floor.from[1]) / floor.cell_m;
  if (!(wide > 0.0 && deep > 0.0)) node.get("to").fail("must be greater than 'from' in x and y");
  if (!(wide * deep <= kMaxFloorCells))
    node.fail("the floor has more than " + std::to_string(kMaxFloorCells) + " cells");
}

void read_nothing(const Node&, QuantitySpec&) {}

const QuantityKind kKinds[] = {
    {"distance",
     "between a body's origin and a point or another body's origin, m",
     {"body", "to", "axes"},
     read_distance,
     measures::tie_distance,
     measures::distance},
    {"position",
     "one coordinate of a body's origin in the world, m",
     {"body", "axis"},
     read_position,
     measures::tie_body,
     measures::position},
    {"tilt",
     "angle between an axis of the body (z) and the world's vertical, rad",
     {"body", "axis"},
     read_tilt,
     measures::tie_body,
     measures::tilt},
    {"speed", "of a body's origin, m/s", {"body"}, read_body, measures::tie_body, measures::speed},
    {"angular_speed", "of a body, rad/s", {"body"}, read_body, measures::tie_body, measures::angular_speed},
    {"contact_force",
     "largest sum of the normal forces on a body since the step before, N",
     {"body"},
     read_body,
     measures::tie_body,
     measures::contact_force},
    {"touching",
     "1 while two bodies are in contact, else 0",
     {"body", "with"},
     read_touching,
     measures::tie_touching,
     measures::touching},
    {"joint_position", "rad or m", {"joint"}, read_joint, measures::tie_joint, measures::joint_position},
    {"joint_speed", "rad/s or m/s", {"joint"}, read_joint, measures::tie_joint, measures::joint_speed},
    {"joint_effort",
     "of a joint's drive, Nm or N",
     {"joint"},
     read_joint,
     measures::tie_joint,
     measures::joint_effort},
    {"peak_following_error",
     "largest difference of commanded and actual position since the step before, of a joint or "
     "of all joints of a part, rad or m",
     {"part", "joint"},
     read_part_or_joint,
     measures::tie_joints_of_part,
     measures::peak_following_error},
    {"port",
     "a port's value, or only the bits of `mask` in it",
     {"part", "name", "mask"},
     read_port,
     measures::tie_port,
     measures::port},
    {"coverage",
     "share of a floor's free cells that the body's origin has been near so far",
     {"body", "within", "from", "to", "cell", "height"},
     read_coverage,
     measures::tie_coverage,
     measures::coverage},
    {"time", "simulated time, s", {}, read_nothing, measures::tie_nothing, measures::time},
};

const QuantityKind* find_kind(const std::string& name) {
  const auto found = std::find_if(std::begin(kKinds), std::end(kKinds),
                                  [&](const QuantityKind& kind) { return name == kind.name; });
  return found == std::end(kKinds) ? nullptr : found;
}

}  // namespace

std::span<const QuantityKind> quantity_kinds() {
  return kKinds;
}

QuantitySpec read_quantity(const std::string& name, const Node& node) {
  const QuantityKind* kind = find_kind(name);
  if (kind == nullptr) {
    std::vector<std::string> known;
    for (const QuantityKind& one : kKinds) known.emplace_back(one.name);
    fail_unknown(node.place(), "quantity", name, known);
  }
  if (node.kind() != Node::Kind::kMap) node.fail("must be a map, as {body: box}");
  node.allow_only(kind->keys);
  QuantitySpec spec;
  spec.kind = name;
  spec.place = node.place();
  kind->read(node, spec);
  return spec;
}

Quantity tie(const QuantitySpec& spec, const Catalogue& catalogue) {
  const QuantityKind* kind = find_kind(spec.kind);
  Quantity quantity;
  quantity.spec = &spec;
  quantity.measure = kind->measure;
  kind->tie(catalogue, quantity);
  return quantity;
}

void tie_again(Quantity& quantity, const Catalogue& catalogue) {
  Quantity tied = tie(*quantity.spec, catalogue);
  tied.coverage.go_on(std::move(quantity.coverage));
  quantity = std::move(tied);
}

}  // namespace visum::run
