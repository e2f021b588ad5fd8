#include <algorithm>
#include <cstdio>

#include "clients/visum/common/exit_code.h"
#include "clients/visum/common/format.h"
#include "clients/visum/common/json_writer.h"
#include "clients/visum/common/picture.h"
#include "clients/visum/verbs/verbs.h"

namespace visum::cli {
namespace {

constexpr const char* kShows[] = {"color", "depth", "segmentation"};

class Camera : public Verb {
 public:
  void declare(CLI::App& app) override {
    app.add_option("PART", part_, "the camera's name")->required();
    app.add_option("-o,--output", file_, "the file to write")->required()->type_name("FILE.png");
    add_link_options(app, link_);
    app.footer(
        "Colours become 8-bit RGB, and depths 16-bit grey in mm. Bodies become 16-bit grey: 0 for nothing, "
        "else the "
        "number of the body in the world, from 1.\n\nExample:\n  visum camera eye -o picture.png");
  }

  int run() override {
    auto link = open_link(link_, protocol::Role::kObserver);
    const auto described = describe_part(link, part_);
    const auto& boards = described.description.blackboards;
    if (std::ranges::find(boards, "image", &protocol::Blackboard::name) == boards.end())
      throw ExitError(kUsage, "the part '" + part_ + "' takes no pictures");
    const auto data = link.request_as<protocol::BlackboardData>(protocol::ReadBlackboard{part_, "image"});
    const Picture picture = read_picture(data.data);
    if (picture.taken_ns < 0)
      throw ExitError(kFailed, "'" + part_ + "' has taken no picture yet: let time run");
    write_png(picture, file_);
    report(picture);
    return 0;
  }

 private:
  void report(const Picture& picture) const {
    const double taken_s = static_cast<double>(picture.taken_ns) * 1e-9;
    const char* shows = kShows[static_cast<std::size_t>(picture.shows)];
    if (link_.json) {
      JsonWriter json;
      json.begin_object().member("file", file_).member("width", std::uint64_t{picture.width});
      json.member("height", std::uint64_t{picture.height}).member("shows", shows).member("taken_s", taken_s);
      std::puts(json.end_object().text().c_str());
    } else {
      std::printf("%s: %u x %u, %s, taken at %s s\n", file_.c_str(), picture.width, picture.height, shows,
                  fixed(taken_s, 3).c_str());
    }
  }

  LinkOptions link_;
  std::string part_, file_;
};

}  // namespace

std::unique_ptr<Verb> make_camera() {
  return std::make_unique<Camera>();
}

}  // namespace visum::cli
