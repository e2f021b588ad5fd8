#include "server/programs/drives_file.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <fstream>
#include <iostream>
#include <span>

#include "protocol/config/new_file.h"
#include "protocol/config/number_text.h"
#include "protocol/json_text.h"
#include "server/programs/drive_choice.h"
#include "server/programs/program.h"
#include "server/programs/scene_check.h"
#include "server/scene/convert/convert.h"
#include "server/world/joint_tree.h"

namespace visum::programs {
namespace {

namespace fs = std::filesystem;
using config::number_text;

constexpr std::size_t kMostDrives = 31;  // of a part: a bus has no more modules

struct DrivesOptions {
  std::string from, to, scene;
  bool force = false;
  bool json = false;
  scene::Options of_scene;
};

struct Planned {
  hwparts::JointInfo joint;
  std::string full_name;  // "arm/elbow"
  JointLoad load;
  DriveChoice choice;
  bool begins_limb;  // it does not hang on the drive before it
};

// Drives that one part has, and the file that holds them.
struct DrivesOfPart {
  std::string file;
  std::span<const Planned> drives;
};

// At most three significant digits, as for a person.
std::string shown(double value) {
  if (value == 0.0) return "0";
  const double scale = std::pow(10.0, 2.0 - std::floor(std::log10(std::abs(value))));
  return number_text(std::round(value * scale) / scale);
}

// The joint that carries `joint`'s parent, past those without a drive; invalid if there is none.
world::JointId drive_below(const world::WorldModel& model, const std::vector<world::JointId>& carriers,
                           const std::vector<world::JointId>& driven, world::JointId joint) {
  for (std::size_t steps = 0; steps < model.joints.size(); ++steps) {
    const world::BodyId parent = model.joints[joint.index()].parent;
    joint = parent.valid() ? carriers[parent.index()] : world::JointId{};
    if (!joint.valid() || std::find(driven.begin(), driven.end(), joint) != driven.end()) return joint;
  }
  return {};
}

std::vector<Planned> plan(const scene::Scene& scene, const std::string& file) {
  std::vector<Planned> all;
  std::vector<world::JointId> ids;
  for (const auto& part : scene.parts) {
    for (std::size_t i = 0; i < part.joints.size(); ++i) {
      all.push_back({part.context.joints[i], scene.world.joints[part.joints[i].index()].name, {}, {}, true});
      ids.push_back(part.joints[i]);
    }
  }
  if (all.empty()) throw config::ConfigError({file, 0, ""}, "has no joint that a drive could move");
  const auto loads = worst_loads(scene.world, ids);
  const auto carriers = world::carrying_joints(scene.world);
  for (std::size_t i = 0; i < all.size(); ++i) {
    all[i].load = loads[i];
    all[i].choice = choose_drive(all[i].joint, loads[i]);
    all[i].begins_limb = i == 0 || drive_below(scene.world, carriers, ids, ids[i]) != ids[i - 1];
  }
  return all;
}

// "drives.yaml", then "drives_2.yaml" beside it, and so on.
std::string file_of_part(const std::string& first, std::size_t index) {
  const fs::path path = first;
  const std::string number = index == 0 ? "" : "_" + std::to_string(index + 1);
  return (path.parent_path() / (path.stem().string() + number + path.extension().string())).string();
}

// As many drives a part as fit, in their order. A limb is parted only if it is longer than that.
std::vector<DrivesOfPart> divide(std::span<const Planned> all, const std::string& first) {
  std::vector<DrivesOfPart> parts;
  while (!all.empty()) {
    std::size_t count = std::min(all.size(), kMostDrives);
    if (count < all.size()) {
      std::size_t limb = count;
      while (limb > 0 && !all[limb].begins_limb) --limb;
      if (limb > 0) count = limb;
    }
    parts.push_back({file_of_part(first, parts.size()), all.first(count)});
    all = all.subspan(count);
  }
  return parts;
}

std::string quoted(const std::string& text) {
  std::string quoted = "'";
  for (const char c : text) quoted += c == '\'' ? "''" : std::string(1, c);
  return quoted + "'";
}

std::string comment_of(const Planned& drive) {
  const auto& [joint, full_name, load, choice, begins_limb] = drive;
  const char* mass = joint.prismatic ? " kg" : " kg·m²";
  const char* force = joint.prismatic ? " N" : " N·m";
  std::string text = "  # Behind it: " + shown(load.inertia) + mass + ", and " + shown(load.gravity) + force +
                     " of gravity. The motor holds " +
                     shown(drive::nominal_effort(*choice.servo, choice.ratio)) + force +
                     ".\n  # Its rotor is " + shown(choice.rotor_inertia) + mass + " behind the gear; kp " +
                     shown(choice.kp) + force + (joint.prismatic ? "/m" : "/rad") + ", kd " +
                     shown(choice.kd) + force + (joint.prismatic ? "·s/m" : "·s/rad") + ".\n";
  for (const auto& missing : choice.missing) text += "  # NOTE: " + missing + ".\n";
  return text;
}

std::string entry_of(const Planned& drive) {
  const auto& [joint, full_name, load, choice, begins_limb] = drive;
  const std::string u = joint.prismatic ? "m" : "rad";
  std::string limits = "{speed_" + u + "_per_s: " + number_text(choice.speed) + ", acceleration_" + u +
                       "_per_s2: " + number_text(choice.acceleration) + ", following_error_" + u + ": " +
                       number_text(choice.following_error);
  if (joint.prismatic && joint.lower > joint.upper) limits += ", soft_m: [-1, 1], hard_m: [-1, 1]";
  return comment_of(drive) + "  - joints: [" + quoted(joint.name) + "]\n    servo: " + choice.servo->name +
         "\n    motor: {current_limit_a: " + number_text(choice.current_limit) + "}\n    gear: {" +
         (joint.prismatic ? "ratio_rad_per_m: " : "ratio: ") + number_text(choice.ratio) +
         "}\n    limits: " + limits +
         "}\n    loop: {position_gain_per_s: " + number_text(choice.position_gain) +
         ", velocity_bandwidth_per_s: " + number_text(choice.velocity_bandwidth) +
         ", integral_time_s: " + number_text(choice.integral_time) + "}\n";
}

std::string file_text(const DrivesOptions& options, std::span<const Planned> drives) {
  std::string text =
      "# Drives for " + fs::path(options.from).filename().string() +
      ", as `visum drives` chose them. Change what you know better.\n"
      "# A class gives the motor of a public data sheet, and all keys that are left out:\n"
      "# hwparts/drive/DRIVES.md. Loads are the worst of a few poses: the start, all joints at 0,\n"
      "# in the middle, and each at a quarter turn. The gains give the velocity loop 60/s with that\n"
      "# load, at most 250/s around the bare rotor, and the position loop a quarter of it. They\n"
      "# suit a tick of 1 ms.\n"
      "source: 'visum drives; motors: maxon data sheets; the rest: chosen'\ndrives:\n";
  for (const auto& drive : drives) text += entry_of(drive);
  return text;
}

std::string part_text(const std::string& model, const DrivesOfPart& part, std::size_t index, bool all,
                      const fs::path& folder) {
  std::string text = "  - name: " + quoted(index == 0 ? model : model + "_" + std::to_string(index + 1)) +
                     "\n    kind: servo_group\n    model: " + quoted(model) + "\n";
  if (!all) {
    std::string joints;
    for (const auto& drive : part.drives) joints += (joints.empty() ? "" : ", ") + quoted(drive.joint.name);
    text += "    joints: [" + joints + "]\n";
  }
  const std::string file = fs::relative(fs::absolute(part.file), folder).string();
  return text + "    drives: " + quoted(file) + "\n";
}

// A scene in which the model has these drives; the model file's own floor and name.
std::string scene_text(const DrivesOptions& options, const scene::Scene& scene,
                       const std::vector<DrivesOfPart>& parts) {
  if (scene.models.size() != 1 || scene.parts.size() != 1)
    throw config::ConfigError({options.from, 0, ""}, "--scene is for a model file: .urdf or .sdf");
  const fs::path folder = fs::absolute(options.scene).parent_path();
  const std::string& name = scene.models[0].name;
  double floor = 0.0;
  for (const auto& shape : scene.world.shapes)
    if (shape.kind == world::ShapeKind::kPlane)
      floor = scene.world.bodies[shape.body.index()].X_WB.p.z() + 0.0;  // no -0
  std::string text = "visum: 1\nname: " + quoted(name) +
                     "\nbodies:\n  - {name: floor, fixed: true, pose: {xyz: [0, 0, " + number_text(floor) +
                     "]}, shapes: [{plane: true}]}\nmodels:\n  - name: " + quoted(name) +
                     "\n    file: " + quoted(fs::relative(fs::absolute(options.from), folder).string()) +
                     "\n    no_collision: {overlapping: true}\nparts:\n";
  for (std::size_t i = 0; i < parts.size(); ++i)
    text += part_text(name, parts[i], i, parts.size() == 1, folder);
  return text;
}

void refuse_existing(const std::string& file, bool force) {
  std::error_code error;
  if (!force && fs::exists(file, error))
    throw std::runtime_error("'" + file +
                             "' exists already: choose another name, or replace it with --force");
}

void write(const std::string& file, const std::string& text) {
  const config::NewFile fresh(file);
  errno = 0;
  std::ofstream out(fresh.path(), std::ios::binary);
  out << text;
  out.close();
  if (!out)
    throw std::runtime_error("cannot write '" + file + "'" +
                             (errno == 0 ? std::string() : std::string(": ") + std::strerror(errno)));
  fresh.keep();
}

std::string json_of(const std::vector<DrivesOfPart>& parts, const std::vector<Planned>& drives) {
  std::string files, joints, missing;
  for (const auto& part : parts) files += (files.empty() ? "" : ",") + protocol::json_quoted(part.file);
  for (const auto& [joint, full_name, load, choice, begins_limb] : drives) {
    joints += (joints.empty() ? "{" : ",{") + std::string("\"name\":") + protocol::json_quoted(joint.name) +
              ",\"class\":" + protocol::json_quoted(choice.servo->name) +
              ",\"kp\":" + number_text(choice.kp) + ",\"kd\":" + number_text(choice.kd) +
              ",\"source\":" + protocol::json_quoted(choice.servo->motor) + "}";
    for (const auto& one : choice.missing)
      missing += (missing.empty() ? "" : ",") + protocol::json_quoted(one);
  }
  return "{\"written\":" + protocol::json_quoted(parts[0].file) + ",\"files\":[" + files + "],\"joints\":[" +
         joints + "],\"missing\":[" + missing + "]}";
}

void print(const DrivesOptions& options, const std::vector<DrivesOfPart>& parts,
           const std::vector<Planned>& drives) {
  for (const auto& [joint, full_name, load, choice, begins_limb] : drives)
    std::cout << full_name << ": " << choice.servo->name << " (" << choice.servo->motor << "), ratio "
              << number_text(choice.ratio) << "\n";
  for (const auto& drive : drives)
    for (const auto& missing : drive.choice.missing) std::cout << missing << "\n";
  if (parts.size() > 1)
    std::cout << drives.size() << " drives make " << parts.size() << " parts: a part has at most "
              << kMostDrives << ", like a bus\n";
  std::string files;
  for (const auto& part : parts) files += (files.empty() ? "" : ", ") + part.file;
  std::cout << files << (parts.size() > 1 ? " are" : " is") << " written"
            << (options.scene.empty() ? "" : ", and " + options.scene) << "\n";
}

int run(const DrivesOptions& options) {
  refuse_existing(options.to, options.force);
  if (!options.scene.empty()) refuse_existing(options.scene, options.force);
  try {
    const auto scene = scene::load_any(options.from, options.of_scene);
    const auto drives = plan(scene, options.from);
    const auto parts = divide(drives, options.to);
    const std::string around = options.scene.empty() ? "" : scene_text(options, scene, parts);
    for (const auto& part : std::span(parts).subspan(1)) refuse_existing(part.file, options.force);
    for (const auto& part : parts) write(part.file, file_text(options, part.drives));
    if (!options.scene.empty()) write(options.scene, around);
    if (options.json)
      std::cout << json_of(parts, drives) << "\n";
    else
      print(options, parts, drives);
    return kPassed;
  } catch (const config::ConfigError& error) {
    if (options.json) print_wrong_as_json({error});
    throw;
  }
}

}  // namespace

int write_drives(const Command& command) {
  DrivesOptions options;
  PluginOptions plugins;
  OutputOptions output{.verbosity = 1};
  CLI::App app{"Writes a drives file for a model: a servo class, a gear and gains for each joint",
               command.name};
  app.add_option("FILE", options.from, "the model or scene: .urdf, .sdf, .x3d, .wrl or .yaml")->required();
  app.add_option("-o,--output", options.to, "the drives file to write")->required()->type_name("FILE");
  app.add_option("--scene", options.scene, "also write a scene with the model and these drives")
      ->type_name("FILE");
  app.add_flag("--force", options.force, "replace files that exist");
  declare_plugins(app, plugins);
  declare_packages(app, options.of_scene.packages);
  declare_cache(app);
  app.add_flag("--json", output.json, "print one line of JSON");
  app.footer(
      "Each joint gets the smallest class that moves what hangs behind it at the model's speed, and gains "
      "for the worst of a few poses. The file says how it was chosen. Beyond 31 joints there are several "
      "parts, whose files are numbered: drives.yaml, drives_2.yaml.\n\nExample:\n  " +
      command.name +
      " robot.urdf -o drives.yaml --scene robot.yaml\n"
      "Exit codes: 0 the file is written, 2 bad usage or a file that exists or cannot be written, 3 the "
      "model is wrong.");
  return run_command(app, command, "visumd", output, [&] {
    options.json = output.json;
    options.of_scene.plugin_folders = plugin::plugin_folders(plugins.folders);
    return run(options);
  });
}

}  // namespace visum::programs
