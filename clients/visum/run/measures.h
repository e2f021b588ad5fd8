// How each kind of quantity finds what it names, and measures it. Rows of the table in quantity.cc.
#pragma once

#include "clients/visum/run/quantity.h"

namespace visum::run::measures {

void tie_body(const Catalogue& catalogue, Quantity& quantity);
void tie_distance(const Catalogue& catalogue, Quantity& quantity);
void tie_touching(const Catalogue& catalogue, Quantity& quantity);
void tie_joint(const Catalogue& catalogue, Quantity& quantity);
void tie_joints_of_part(const Catalogue& catalogue, Quantity& quantity);
void tie_port(const Catalogue& catalogue, Quantity& quantity);
void tie_nothing(const Catalogue& catalogue, Quantity& quantity);

double distance(const Quantity& self, const Observation& now);
double position(const Quantity& self, const Observation& now);
double tilt(const Quantity& self, const Observation& now);
double speed(const Quantity& self, const Observation& now);
double angular_speed(const Quantity& self, const Observation& now);
double contact_force(const Quantity& self, const Observation& now);
double touching(const Quantity& self, const Observation& now);
double joint_position(const Quantity& self, const Observation& now);
double joint_speed(const Quantity& self, const Observation& now);
double joint_effort(const Quantity& self, const Observation& now);
double peak_following_error(const Quantity& self, const Observation& now);
double port(const Quantity& self, const Observation& now);
double time(const Quantity& self, const Observation& now);

}  // namespace visum::run::measures
