// For each kind of quantity, the function that finds the named bodies, joints or ports, and the one that
// measures. The table in quantity.cc lists them.
#pragma once

#include "clients/visum/run/quantity.h"

namespace visum::run::measures {

void tie_body(const Catalogue& catalogue, Quantity& quantity);
void tie_distance(const Catalogue& catalogue, Quantity& quantity);
void tie_touching(const Catalogue& catalogue, Quantity& quantity);
void tie_joint(const Catalogue& catalogue, Quantity& quantity);
void tie_joints_of_part(const Catalogue& catalogue, Quantity& quantity);
void tie_port(const Catalogue& catalogue, Quantity& quantity);
void tie_coverage(const Catalogue& catalogue, Quantity& quantity);
void tie_nothing(const Catalogue& catalogue, Quantity& quantity);

double distance(Quantity& self, const Observation& now);
double position(Quantity& self, const Observation& now);
double tilt(Quantity& self, const Observation& now);
double speed(Quantity& self, const Observation& now);
double angular_speed(Quantity& self, const Observation& now);
double contact_force(Quantity& self, const Observation& now);
double touching(Quantity& self, const Observation& now);
double joint_position(Quantity& self, const Observation& now);
double joint_speed(Quantity& self, const Observation& now);
double joint_effort(Quantity& self, const Observation& now);
double peak_following_error(Quantity& self, const Observation& now);
double port(Quantity& self, const Observation& now);
double coverage(Quantity& self, const Observation& now);
double time(Quantity& self, const Observation& now);

}  // namespace visum::run::measures
