#include "server/scene/mjcf/values.h"

#include <algorithm>
#include <cmath>

#include "protocol/config/unknown_name.h"
#include "server/scene/text_cursor.h"

namespace visum::scene::mjcf {
namespace {

std::string how_many(std::size_t least, std::size_t most) {
  if (most == 1) return "a number";
  if (least == most) return std::to_string(most) + " numbers";
  return std::to_string(least) + " to " + std::to_string(most) + " numbers";
}

// Fewer numbers than `least` are a fault only if `all_at_once`.
std::vector<double> parsed(const Element& element, std::string_view attribute, std::size_t least,
                           std::size_t most, bool all_at_once) {
  const std::string* text = element.attribute(attribute);
  std::vector<double> all;
  bool good = true;
  TextCursor cursor(text ? std::string_view(*text) : std::string_view());
  for (std::string_view word = cursor.word(); good && !word.empty(); word = cursor.word()) {
    double number = 0.0;
    good = parse_number(word, number) && std::isfinite(number) && all.size() < most;
    all.push_back(number);
  }
  if (good && (all.size() >= least || !all_at_once)) return all;
  element.fail(std::string(attribute) + " must be " + how_many(least, most) + ", is '" +
               (text ? text->substr(0, 60) : "") + "'");
}

}  // namespace

std::vector<double> numbers_of(const Element& element, std::string_view attribute, std::size_t least,
                               std::size_t most) {
  return parsed(element, attribute, least, most, true);
}

Values::Values(const Element& own, std::vector<const Element*> defaults) : chain_(std::move(defaults)) {
  chain_.insert(chain_.begin(), &own);
}

const std::string* Values::text(std::string_view attribute) const {
  for (const Element* element : chain_)
    if (const std::string* text = element->attribute(attribute)) return text;
  return nullptr;
}

std::string Values::text_or(std::string_view attribute, const std::string& otherwise) const {
  const std::string* given = text(attribute);
  return given ? *given : otherwise;
}

std::optional<bool> Values::flag(std::string_view attribute) const {
  const std::string* given = text(attribute);
  if (given == nullptr || *given == "auto") return std::nullopt;
  if (*given != "true" && *given != "false")
    fail(attribute,
         std::string(attribute) + " must be true, false or auto, is '" + given->substr(0, 60) + "'");
  return *given == "true";
}

double Values::number_or(std::string_view attribute, double otherwise) const {
  const auto all = numbers(attribute, 1, 1);
  return all ? all->front() : otherwise;
}

std::optional<std::vector<double>> Values::numbers(std::string_view attribute, std::size_t least,
                                                   std::size_t most) const {
  std::optional<std::vector<double>> merged;
  for (auto element = chain_.rbegin(); element != chain_.rend(); ++element) {
    if (!(*element)->attribute(attribute)) continue;
    std::vector<double> own = parsed(**element, attribute, least, most, false);
    if (merged && merged->size() > own.size())
      own.insert(own.end(), merged->begin() + static_cast<long>(own.size()), merged->end());
    merged = std::move(own);
  }
  if (merged && merged->size() < least)
    fail(attribute, std::string(attribute) + " must be " + how_many(least, most) + ", is '" +
                        text(attribute)->substr(0, 60) + "'");
  return merged;
}

const Element* Values::nearest_with(const std::vector<std::string_view>& attributes) const {
  for (const Element* element : chain_)
    for (const std::string_view attribute : attributes)
      if (element->attribute(attribute)) return element;
  return nullptr;
}

void Values::fail(std::string_view attribute, const std::string& message) const {
  const Element* at = nearest_with({attribute});
  (at ? *at : element()).fail(message);
}

Defaults::Defaults(const Element& root) {
  classes_[main_];
  each_child(root, "default", [&](const Element& section) {
    // The outermost class may have another name than `main`.
    if (const std::string* name = section.attribute("class"); name && *name != main_) {
      if (classes_.size() == 1 && classes_[main_].elements.empty()) {
        classes_.erase(main_);
        main_ = *name;
        classes_[main_];
      }
    }
    read(section, "");
  });
}

void Defaults::read(const Element& element, const std::string& parent) {
  const std::string* given = element.attribute("class");
  if (given == nullptr && !parent.empty()) element.fail("a <default> in another one needs 'class'");
  const std::string name = given ? *given : main_;
  if (name == parent) element.fail("class '" + name + "' stands in itself");
  const auto [entry, is_new] = classes_.try_emplace(name);
  if (is_new)
    entry->second.parent = parent.empty() ? main_ : parent;
  else if (name != main_ && entry->second.parent != (parent.empty() ? main_ : parent))
    element.fail("there is another class '" + name + "'");
  for (const Element& child : element.children) {
    if (child.tag == "default")
      read(child, name);
    else
      classes_[name].elements.push_back(&child);
  }
}

void Defaults::demand(const Element& element, const std::string& class_name) const {
  if (classes_.count(class_name) != 0) return;
  std::vector<std::string> known;
  for (const auto& [name, entry] : classes_) known.push_back(name);
  element.fail(config::unknown_name("default class", class_name, known));
}

Values Defaults::of(const Element& element, const std::string& class_name,
                    const std::vector<std::string_view>& tags) const {
  const std::string* own = element.attribute("class");
  std::string name = own ? *own : class_name.empty() ? main_ : class_name;
  if (own && name == "main" && main_ != "main") name = main_;
  demand(element, name);
  std::vector<const Element*> chain;
  // A class stands in one that was read before it, so the walk up ends.
  for (std::size_t steps = 0; !name.empty() && steps <= classes_.size(); ++steps) {
    const Class& here = classes_.at(name);
    for (auto e = here.elements.rbegin(); e != here.elements.rend(); ++e)
      if (std::find(tags.begin(), tags.end(), (*e)->tag) != tags.end()) chain.push_back(*e);
    name = here.parent;
  }
  return Values(element, std::move(chain));
}

}  // namespace visum::scene::mjcf
