#include <cstdio>
#include <filesystem>
#include <stdexcept>
#include <string>

#include "clients/visum/common/exit_code.h"
#include "clients/visum/common/json_writer.h"
#include "clients/visum/common/numbers.h"
#include "clients/visum/verbs/verbs.h"
#include "protocol/model_bundle.h"

namespace visum::cli {
namespace {

class SpawnVerb : public Verb {
 public:
  void declare(CLI::App& app) override {
    app.add_option("FILE", file_, "a file of this machine, or one of --list");
    app.add_option("--name", name_, "its name in the world; default: the file's");
    app.add_option("--pose", pose_, "where its origin goes: m, and rad about the fixed axes x, y, z")
        ->type_name("X,Y,Z[,R,P,Y]");
    app.add_flag("--unique", unique_, "put a number behind a name that is taken, instead of an error");
    app.add_flag("--list", list_, "show the models that the server has, and those that were spawned");
    add_link_options(app, link_, true);
    app.footer(
        "A robot's file (.urdf, .sdf, .mjcf) stands fixed where it is put and gets a part for its joints. A "
        "file of the scene format (.yaml) brings its models, parts and sensors; it has a parameter 'name'. "
        "Meshes and other files that it names are sent along.\n\nExamples:\n  visum spawn --list\n  visum "
        "spawn cart/cart.yaml --name second --pose 0,2,0\n  visum spawn my_arm.urdf --unique");
  }

  int run() override {
    if (list_ != file_.empty())
      throw ExitError(kUsage, list_ ? "--list takes no file" : "name a file, or ask for --list");
    protocol::SpawnModel model;
    std::error_code error;
    if (std::filesystem::is_regular_file(file_, error)) {
      model = bundle();
    } else {
      model.file = file_;
    }
    model.name = name_;
    model.make_unique = unique_;
    bool turned = false;
    if (!pose_.empty()) model.pose = parse_pose(pose_, turned);
    auto link = open_link(link_, protocol::Role::kAdmin);
    if (list_) return list(link);
    const auto spawned = link.request_as<protocol::ModelSpawned>(model);
    if (link_.json) {
      JsonWriter json;
      json.begin_object().member("name", spawned.name);
      json.member("bodies", spawned.bodies).member("parts", spawned.parts);
      std::printf("%s\n", json.end_object().text().c_str());
    } else {
      std::printf("%s: %zu bodies, parts: %s\n", spawned.name.c_str(), spawned.bodies.size(),
                  joined(spawned.parts).c_str());
    }
    return kDone;
  }

 private:
  protocol::SpawnModel bundle() const try {
    return protocol::bundle_of_model(file_);
  } catch (const std::runtime_error& error) {
    throw ExitError(kUsage, error.what());
  }

  int list(protocol::Connection& link) const {
    const auto models = link.request_as<protocol::ModelList>(protocol::ListModels{});
    if (link_.json) {
      JsonWriter json;
      json.begin_object().member("files", models.files).member("spawned", models.spawned);
      std::printf("%s\n", json.end_object().text().c_str());
      return kDone;
    }
    for (const auto& file : models.files) std::printf("%s\n", file.c_str());
    std::printf("spawned: %s\n", joined(models.spawned).c_str());
    return kDone;
  }

  static std::string joined(const std::vector<std::string>& words) {
    std::string text;
    for (const auto& word : words) text += (text.empty() ? "" : ", ") + word;
    return text.empty() ? "none" : text;
  }
  LinkOptions link_;
  std::string file_, name_, pose_;
  bool unique_ = false, list_ = false;
};

}  // namespace

std::unique_ptr<Verb> make_spawn() {
  return std::make_unique<SpawnVerb>();
}

}  // namespace visum::cli
