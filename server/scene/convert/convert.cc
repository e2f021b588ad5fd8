#include "server/scene/convert/convert.h"

#include <functional>

#include "server/scene/bare_model.h"
#include "server/scene/convert/output.h"
#include "server/scene/convert/write_sdf.h"
#include "server/scene/convert/write_yaml.h"
#include "server/scene/convert/x3d_prototypes.h"
#include "server/scene/convert/x3d_scene.h"
#include "server/scene/mesh_readers.h"

namespace visum::scene {
namespace {

namespace fs = std::filesystem;

// An error about the file as a whole.
[[noreturn]] void fail(const fs::path& file, const std::string& message) {
  throw config::ConfigError({file.string(), 0, ""}, message);
}

enum class Format { kYaml, kModel, kX3dXml, kX3dClassic, kVrml97 };

Format format_of(const fs::path& file, const char* known) {
  const std::string ending = lower_extension(file);
  if (ending == ".yaml" || ending == ".yml") return Format::kYaml;
  if (is_model_file(file)) return Format::kModel;
  if (ending == ".x3d") return Format::kX3dXml;
  if (ending == ".x3dv") return Format::kX3dClassic;
  if (ending == ".wrl" || ending == ".vrml") return Format::kVrml97;
  fail(file, std::string("its extension names its format and must be one of ") + known);
}

std::string written(const Scene& scene, Output& output) {
  const Format format = format_of(output.file(), ".yaml, .sdf, .x3d, .x3dv, .wrl");
  for (const ModelPlan& model : scene.models)
    if (format != Format::kYaml && model.overlaps_never_collide)
      output.lose("links of '" + model.name +
                  "' that overlap at the start collide: no other format than YAML has 'overlapping'");
  switch (format) {
    case Format::kYaml:
      return to_yaml(scene, output);
    case Format::kModel:
      if (lower_extension(output.file()) != ".sdf" && lower_extension(output.file()) != ".world")
        fail(output.file(), "URDF and MJCF are read, not written: write .sdf or .yaml");
      return to_sdf(scene, output);
    case Format::kX3dXml:
      return write_x3d_xml(to_x3d(scene, output, true));
    case Format::kX3dClassic:
    case Format::kVrml97:
      break;
  }
  const bool vrml97 = format == Format::kVrml97;
  return write_x3d_classic(to_x3d(scene, output, !vrml97), vrml97);
}

}  // namespace

Scene read_any_scene(const fs::path& file, const Options& options) {
  switch (format_of(file, ".yaml, .urdf, .sdf, .world, .xacro, .mjcf, .xml, .x3d, .x3dv, .wrl")) {
    case Format::kYaml:
    case Format::kModel:
      return load_scene(file, options);
    case Format::kX3dXml:
    case Format::kX3dClassic:
    case Format::kVrml97:
      break;
  }
  return scene_of_x3d(read_x3d_file(file), file);
}

bool is_x3d_file(const fs::path& file) {
  const std::string ending = lower_extension(file);
  return ending == ".x3d" || ending == ".x3dv" || ending == ".wrl" || ending == ".vrml";
}

Scene load_any(const fs::path& file, const Options& options) {
  if (!is_x3d_file(file)) return load_scene(file, options);
  Scene scene = read_any_scene(file, options);
  if (options.engine.empty()) return scene;
  for (world::EngineSetting& engine : scene.world.engines) engine.name = options.engine;
  scene.engine_places.clear();
  return scene;
}

std::vector<std::string> convert(const fs::path& from, const fs::path& to, const Options& options) {
  const Scene scene = read_any_scene(from, options);
  Output output(to);
  const std::string text = written(scene, output);
  output.write(text);
  std::vector<std::string> losses = scene.losses;
  if (is_x3d_file(from))
    for (const PartPlan& part : scene.parts)
      if (part.kind == "ideal_joints")
        losses.push_back("part '" + part.context.name +
                         "' has the speed limits of ideal_joints, not the file's");
  losses.insert(losses.end(), output.losses().begin(), output.losses().end());
  return losses;
}

}  // namespace visum::scene
