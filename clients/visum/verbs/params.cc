#include <cstdio>

#include "clients/visum/common/parameters.h"
#include "clients/visum/verbs/verbs.h"

namespace visum::cli {
namespace {

class Params : public Verb {
 public:
  void declare(CLI::App& app) override {
    app.add_option("PART", part_, "the part's name")->required();
    add_link_options(app, link_);
    app.footer("Example:\n  visum params arm");
  }

  int run() override {
    auto link = open_link(link_, protocol::Role::kObserver);
    describe_part(link, part_);
    const auto list = link.request_as<protocol::ParameterList>(protocol::GetParameters{part_});
    if (!link_.json) {
      std::fputs(parameter_table(list.parameters).c_str(), stdout);
      return 0;
    }
    JsonWriter json;
    json.begin_object().member("part", part_).key("parameters");
    write_parameters(json, list.parameters);
    std::puts(json.end_object().text().c_str());
    return 0;
  }

 private:
  LinkOptions link_;
  std::string part_;
};

}  // namespace

std::unique_ptr<Verb> make_params() {
  return std::make_unique<Params>();
}

}  // namespace visum::cli
