// The attributes of an MJCF element, with those of its default classes behind them. Pure functions.
#pragma once

#include <map>
#include <optional>
#include <vector>

#include "server/scene/mjcf/document.h"

namespace visum::scene::mjcf {

// One element with its defaults. It points into the document, which must outlive it.
class Values {
 public:
  // `defaults`: the nearest class first.
  Values(const Element& own, std::vector<const Element*> defaults);

  const Element& element() const { return *chain_.front(); }
  // As the nearest element says; null if none does.
  const std::string* text(std::string_view attribute) const;
  std::string text_or(std::string_view attribute, const std::string& otherwise) const;
  // True for `true`, false for `false`; nothing for `auto` and if it is not there.
  std::optional<bool> flag(std::string_view attribute) const;
  double number_or(std::string_view attribute, double otherwise) const;
  // `least` to `most` finite numbers. Of a class that gives more numbers than the element, the rest is kept.
  std::optional<std::vector<double>> numbers(std::string_view attribute, std::size_t least,
                                             std::size_t most) const;
  // The nearest element that has one of these attributes, alone; null if there is none.
  const Element* nearest_with(const std::vector<std::string_view>& attributes) const;

  // Fails at the element that gives the attribute, or at the element itself.
  [[noreturn]] void fail(std::string_view attribute, const std::string& message) const;

 private:
  std::vector<const Element*> chain_;
};

// The numbers of one element's attribute; fails if it holds others than `least` to `most` finite ones.
std::vector<double> numbers_of(const Element& element, std::string_view attribute, std::size_t least,
                               std::size_t most);

// The classes of <default>. It points into the document.
class Defaults {
 public:
  // Throws ConfigError for a class without a name, or one that stands in two others.
  explicit Defaults(const Element& root);

  // `class_name`: the class that an element without `class` has; empty: the main class. Defaults of all
  // `tags` count, because all kinds of actuators share theirs.
  Values of(const Element& element, const std::string& class_name,
            const std::vector<std::string_view>& tags) const;
  Values of(const Element& element, const std::string& class_name) const {
    return of(element, class_name, {element.tag});
  }
  // Fails at `element` if there is no such class.
  void demand(const Element& element, const std::string& class_name) const;

 private:
  struct Class {
    std::string parent;
    std::vector<const Element*> elements;
  };
  void read(const Element& element, const std::string& parent);

  std::string main_ = "main";
  std::map<std::string, Class> classes_;
};

}  // namespace visum::scene::mjcf
