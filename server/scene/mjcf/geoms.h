// Reads <geom>: the shape, the mass that it gives to its body, and what it may touch.
#pragma once

#include "server/scene/mjcf/reading.h"

namespace visum::scene::mjcf {

struct Geom {
  const Element* element;
  std::vector<RobotShape> shapes;  // none: it is not simulated; two: the hull that collides, and its look
  MassProperties mass;             // in the frame of `X_BF`'s B; 0 where it does not count
  unsigned types = 1, meets = 1;   // contype and conaffinity: one's types and the other's must share a bit
};

// `X_BF`: the frame around the geom, in its body. `class_name`: the body's childclass. `with_mass`: the body
// needs it. Throws ConfigError.
Geom read_geom(Reading& reading, const Element& element, const std::string& class_name,
               const world::Pose& X_BF, bool with_mass);

}  // namespace visum::scene::mjcf
