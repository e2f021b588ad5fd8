#include "server/world/world_model.h"

#include <algorithm>

namespace visum::world {
namespace {

template <typename IdType, typename Item>
IdType find_by_name(const std::vector<Item>& items, const std::string& name) {
  const auto found =
      std::find_if(items.begin(), items.end(), [&](const Item& item) { return item.name == name; });
  if (found == items.end()) return {};
  return {static_cast<std::int32_t>(found - items.begin())};
}

}  // namespace

BodyId WorldModel::find_body(const std::string& name) const {
  return find_by_name<BodyId>(bodies, name);
}
JointId WorldModel::find_joint(const std::string& name) const {
  return find_by_name<JointId>(joints, name);
}

}  // namespace visum::world
