// A plug-in's settings, read from an entry of a scene. Errors name file and line. Keys that the plug-in did
// not ask for are found at the end (refuse_others). Used while the scene is loaded.
#pragma once

#include <set>
#include <string>
#include <vector>

#include "protocol/config/config.h"
#include "protocol/plugin/foreign_call.h"
#include "protocol/plugin/plugin.h"

namespace visum::plugin {

class NodeSettings final : public Settings {
 public:
  // `known`: the keys of the entry that do not belong to the plug-in.
  NodeSettings(config::Node entry, std::vector<std::string> known)
      : entry_(std::move(entry)), known_(known.begin(), known.end()) {}

  double number(std::string_view key, double lowest, double highest) override;
  double number_or(std::string_view key, double otherwise, double lowest, double highest) override;
  std::string text(std::string_view key) override;
  std::string text_or(std::string_view key, std::string_view otherwise) override;
  bool flag_or(std::string_view key, bool otherwise) override;
  [[noreturn]] void fail(std::string_view key, const std::string& why) override;

  // Throws ConfigError at a key that is neither known nor was asked for.
  void refuse_others() const;

 private:
  config::Node entry_;
  std::set<std::string, std::less<>> known_;
};

// Makes a node by the plug-in's `make`. An exception from there becomes a ConfigError at `entry`.
template <typename Kind, typename Context>
auto make_node(const Kind& kind, Context& context, const config::Node& entry) {
  const ForeignCall standing(kind.name);
  try {
    auto made = kind.make(context);
    if (!made) throw Error("makes nothing");
    return made;
  } catch (const config::ConfigError&) {
    throw;
  } catch (const std::exception& error) {
    entry.fail(std::string(kind.name) + ": " + error.what());
  } catch (...) {
    entry.fail(std::string(kind.name) + ": throws something that is no std::exception");
  }
}

// The text of the exception that is being handled. Call it in a catch block only.
std::string text_of_current_exception();

}  // namespace visum::plugin
