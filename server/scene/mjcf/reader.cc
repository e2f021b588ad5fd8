// Reads MJCF, the XML of MuJoCo: read_mjcf() of robot_model.h.
#include "server/scene/mjcf/contacts.h"
#include "server/scene/mjcf/devices.h"
#include "server/scene/mjcf/links.h"
#include "server/scene/model_errors.h"

namespace visum::scene {

bool is_mjcf(std::string_view text) {
  const auto past = [&](std::string_view mark) {
    const std::size_t end = text.find(mark);
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + mark.size());
  };
  // Each round takes something away, so it ends.
  for (std::size_t at = text.find('<'); at != std::string_view::npos; at = text.find('<')) {
    text.remove_prefix(at);
    if (text.starts_with("<!--"))
      past("-->");
    else if (text.starts_with("<?"))
      past("?>");
    else
      break;
  }
  constexpr std::string_view kRoot = "<mujoco";
  return text.starts_with(kRoot) && text.size() > kRoot.size() &&
         std::string_view(" \t\r\n>/").find(text[kRoot.size()]) != std::string_view::npos;
}

RobotModel read_mjcf(const std::filesystem::path& file, const std::string& text, const Packages& packages) {
  RobotModel model;
  model.file = file;
  const mjcf::Element document = mjcf::read_document(file, text);
  mjcf::Reading reading(document, model, packages);
  model.says_what_is_fixed = true;
  model.gravity = reading.settings.gravity;
  auto bodies = mjcf::read_bodies(reading);
  mjcf::let_pairs_collide(reading, bodies);
  mjcf::read_home(reading, bodies);
  mjcf::add_links(reading, bodies);
  mjcf::separate_links(reading, bodies);
  // These name joints and bodies, so they would only repeat the errors of those.
  if (reading.errors.empty()) {
    mjcf::read_actuators(reading);
    mjcf::read_equalities(reading, bodies);
  }
  throw_all(std::move(reading.errors));
  mjcf::note_unread(reading);
  model.losses = reading.losses.all(file);
  model.repairs = reading.repairs.all(file);
  return model;
}

}  // namespace visum::scene
