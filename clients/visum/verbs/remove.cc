#include <algorithm>

#include "clients/visum/verbs/verbs.h"

namespace visum::cli {
namespace {

class RemoveVerb : public Verb {
 public:
  void declare(CLI::App& app) override {
    app.add_option("NAME", name_, "a model that was spawned, or a body that belongs to no model")->required();
    add_link_options(app, link_, false);
    app.footer(
        "A model goes with its parts and sensors; `visum reset --scope spawned` removes all that came since "
        "the scene was loaded.\n\nExample:\n  visum remove cart_2");
  }

  int run() override {
    auto link = open_link(link_, protocol::Role::kAdmin);
    const auto models = link.request_as<protocol::ModelList>(protocol::ListModels{}).spawned;
    const auto bodies = link.request_as<protocol::WorldDescription>(protocol::DescribeWorld{}).bodies;
    const bool is_model = std::ranges::find(models, name_) != models.end();
    if (!is_model && std::ranges::find(bodies, name_, &protocol::BodyDescription::name) != bodies.end())
      link.request(protocol::RemoveBody{name_});
    else
      link.request(protocol::RemoveModel{name_});
    return 0;
  }

 private:
  LinkOptions link_;
  std::string name_;
};

}  // namespace

std::unique_ptr<Verb> make_remove() {
  return std::make_unique<RemoveVerb>();
}

}  // namespace visum::cli
