// Contacts of one step as ODE's contact joints, in the order in which they are given: ODE restores bit for
// bit only if that order is always the same.
#pragma once

#include <ode/ode.h>

#include <span>
#include <vector>

#include "server/collision/collision.h"
#include "server/dynamics/ode/ode_handles.h"
#include "server/dynamics/ode/ode_world.h"

namespace visum::dynamics::ode {

class OdeContacts {
 public:
  OdeContacts();

  // Those that touch a body of the engine's own. Wakes the stand-ins of what moves by another engine.
  void make(OdeWorld& world, const world::EngineSetting& setting,
            std::span<const collision::Contact> contacts, const world::WorldState& state);
  // After the step: fills the forces of the same contacts.
  void report(std::span<collision::Contact> contacts) const;
  void clear();

 private:
  struct Made {
    std::size_t contact = 0;
    bool turned = false;                              // its first body is the contact's b
    Eigen::Vector3d lever = Eigen::Vector3d::Zero();  // of the first body: from its centre of mass, in W
    dJointFeedback feedback{};
  };

  GroupHandle group_;
  std::vector<Made> made_;  // ODE keeps the addresses of the feedbacks: not to grow once they are handed out
};

}  // namespace visum::dynamics::ode
