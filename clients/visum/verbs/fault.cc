#include <cmath>

#include "clients/visum/common/exit_code.h"
#include "clients/visum/common/format.h"
#include "clients/visum/verbs/verbs.h"

namespace visum::cli {
namespace {

// "joint=3"
protocol::FaultNumber parse_number(const std::string& word) {
  const auto at = word.find('=');
  const std::string text = at == std::string::npos ? "" : word.substr(at + 1);
  std::size_t read = 0;
  protocol::FaultNumber number{word.substr(0, at), 0.0};
  try {
    number.value = std::stod(text, &read);
  } catch (const std::logic_error&) {
    read = 0;
  }
  if (at == 0 || text.empty() || read != text.size())
    throw ExitError(kUsage, "'" + word + "' must be NAME=NUMBER, as in joint=3");
  return number;
}

class Fault : public Verb {
 public:
  void declare(CLI::App& app) override {
    app.add_option("PART", part_, "the part's name")->required();
    app.add_option("KIND", kind_,
                   "the kind of fault, as `visum faults` lists them; with --clear, none means all");
    app.add_option("NUMBERS", words_, "the numbers of this kind, as joint=3")->type_name("NAME=NUMBER");
    auto* lasting = app.add_option("--for", duration_s_,
                                   "end it after this many simulated seconds; default: when it is cleared")
                        ->check(number_within(1e-9, 1e6));
    app.add_flag("--clear", clear_, "end the fault")->excludes(lasting);
    add_link_options(app, link_, false);
    app.footer(
        "The fault acts from the next tick on, whichever client holds the part's lease. A reset ends all "
        "faults.\n\nExamples:\n"
        "  visum fault arm encoder_stuck joint=3\n"
        "  visum fault arm supply_dip volts=12 --for 0.5\n"
        "  visum fault arm encoder_stuck joint=3 --clear\n"
        "  visum fault arm --clear");
  }

  int run() override {
    std::vector<protocol::FaultNumber> numbers;
    for (const auto& word : words_) numbers.push_back(parse_number(word));
    if (clear_) return clear(numbers);
    if (kind_.empty()) throw ExitError(kUsage, "no KIND given: `visum faults` lists the kinds");
    open_link(link_, protocol::Role::kAdmin)
        .request(protocol::InjectFault{part_, kind_, numbers, std::llround(duration_s_ * 1e9)});
    return kDone;
  }

 private:
  int clear(const std::vector<protocol::FaultNumber>& numbers) {
    protocol::ClearFault request{part_, kind_, 0};
    for (const auto& number : numbers) {
      const bool whole =
          number.value >= 1.0 && number.value <= 1e6 && number.value == std::floor(number.value);
      if (number.name != "joint" || !whole)
        throw ExitError(kUsage, "--clear takes only the number joint, which counts from 1");
      request.joint = static_cast<std::uint32_t>(number.value);
    }
    open_link(link_, protocol::Role::kAdmin).request(request);
    return kDone;
  }

  LinkOptions link_;
  std::string part_, kind_;
  std::vector<std::string> words_;
  double duration_s_ = 0.0;
  bool clear_ = false;
};

}  // namespace

std::unique_ptr<Verb> make_fault() {
  return std::make_unique<Fault>();
}

}  // namespace visum::cli
