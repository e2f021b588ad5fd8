#include "protocol/plugin/node_settings.h"

namespace visum::plugin {

double NodeSettings::number(std::string_view key, double lowest, double highest) {
  known_.emplace(key);
  return entry_.get(key).number({lowest, highest});
}

double NodeSettings::number_or(std::string_view key, double otherwise, double lowest, double highest) {
  known_.emplace(key);
  return entry_.number_or(key, otherwise, {lowest, highest});
}

std::string NodeSettings::text(std::string_view key) {
  known_.emplace(key);
  return entry_.get(key).text();
}

std::string NodeSettings::text_or(std::string_view key, std::string_view otherwise) {
  known_.emplace(key);
  return entry_.text_or(key, std::string(otherwise));
}

bool NodeSettings::flag_or(std::string_view key, bool otherwise) {
  known_.emplace(key);
  return entry_.boolean_or(key, otherwise);
}

void NodeSettings::fail(std::string_view key, const std::string& why) {
  entry_.find(key).value_or(entry_).fail(why);
}

void NodeSettings::refuse_others() const {
  entry_.allow_only({known_.begin(), known_.end()});
}

std::string text_of_current_exception() {
  try {
    throw;
  } catch (const std::exception& error) {
    return error.what();
  } catch (...) {
    return "threw something that is no std::exception";
  }
}

}  // namespace visum::plugin
