// The contacts of one step as ODE's contact joints, in the order in which they are given. ODE restores bit
// for bit only if that order is always the same.
#pragma once

#include <span>
#include <vector>

#include "server/collision/collision.h"
#include "server/dynamics/ode/ode_handles.h"
#include "server/dynamics/ode/ode_library.h"
#include "server/dynamics/ode/ode_world.h"

namespace visum::dynamics::ode {

// The Mechanism of ode_engine.cc owns it; tick's thread. Order of calls in a step: make(), ODE's step,
// report().
class OdeContacts {
 public:
  OdeContacts();

  // Makes those that touch a body of this engine, and wakes the stand-ins of bodies that another engine
  // moves.
  void make(OdeWorld& world, const world::EngineSetting& setting, double tick_s,
            std::span<const collision::Contact> contacts, const world::WorldState& state);
  // After the step: fills in the forces of the same contacts.
  void report(std::span<collision::Contact> contacts) const;
  void clear();

 private:
  struct Made {
    std::size_t contact = 0;
    bool turned = false;  // ODE's first body is the contact's body b
    Eigen::Vector3d lever =
        Eigen::Vector3d::Zero();  // from the first body's centre of mass to the contact, in W
    dJointFeedback feedback{};
  };

  GroupHandle group_;
  std::vector<Made>
      made_;  // ODE keeps the addresses of the feedbacks, so it must not grow once they are given out
};

}  // namespace visum::dynamics::ode
