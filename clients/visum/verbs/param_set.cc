#include "clients/visum/common/parameters.h"
#include "clients/visum/verbs/verbs.h"

namespace visum::cli {
namespace {

class ParamSet : public Verb {
 public:
  void declare(CLI::App& app) override {
    app.add_option("PART", part_, "the part's name")->required();
    app.add_option("NAME", name_, "the parameter's name")->required();
    app.add_option("VALUE", value_, "its new value")->required();
    add_link_options(app, link_, false);
    app.footer(
        "Also works while a controller holds the lease.\n\nExample:\n  visum param-set arm \"On Controller "
        "Lost\" hold");
  }

  int run() override {
    auto link = open_link(link_, protocol::Role::kAdmin);
    describe_part(link, part_);
    const auto list = link.request_as<protocol::ParameterList>(protocol::GetParameters{part_});
    const auto& parameter = find_parameter(part_, list.parameters, name_);
    link.request(protocol::SetParameter{part_, name_, parse_value(parameter, value_)});
    return 0;
  }

 private:
  LinkOptions link_;
  std::string part_, name_, value_;
};

}  // namespace

std::unique_ptr<Verb> make_param_set() {
  return std::make_unique<ParamSet>();
}

}  // namespace visum::cli
