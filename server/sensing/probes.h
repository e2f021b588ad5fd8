// Makes the probes of the built-in kinds. hwparts/sensors says what the truth of each kind is.
#pragma once

#include "server/sensing/probe.h"

namespace visum::plugged {
class PluggedSensor;
}

namespace visum::sensing {

std::unique_ptr<Probe> make_distance_probe(const ProbeContext& context);
std::unique_ptr<Probe> make_scanner_probe(const ProbeContext& context);
std::unique_ptr<Probe> make_imu_probe(const ProbeContext& context);
std::unique_ptr<Probe> make_pose_probe(const ProbeContext& context);
std::unique_ptr<Probe> make_contact_probe(const ProbeContext& context);
std::unique_ptr<Probe> make_joint_wrench_probe(const ProbeContext& context);
std::unique_ptr<Probe> make_camera_probe(const ProbeContext& context);

// For a sensor that a plug-in brings: all of them share this probe, which is in no table.
std::unique_ptr<Probe> make_plugged_probe(const Mount& mount, const plugged::PluggedSensor& sensor);

}  // namespace visum::sensing
