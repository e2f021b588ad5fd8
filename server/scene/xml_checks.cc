#include "server/scene/xml_checks.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "protocol/config/config.h"
#include "server/scene/text_cursor.h"

namespace visum::scene {
namespace {

// "joint 'elbow'": the innermost link or joint with a name around an element; empty if there is none.
std::string owner(const XMLElement& element) {
  for (const tinyxml2::XMLNode* node = &element; node != nullptr; node = node->Parent()) {
    const XMLElement* around = node->ToElement();
    if (around == nullptr) break;
    const std::string tag = around->Name();
    const char* name = around->Attribute("name");
    if (name != nullptr && (tag == "link" || tag == "joint")) return tag + " '" + name + "'";
  }
  return "";
}

// Says what is wrong with the number by `rule`; null if nothing is. kNotZero is checked by the caller.
const char* number_fault(double number, NumberRule rule) {
  if (std::isnan(number)) return "must be a finite number";
  if (std::isinf(number)) return rule == NumberRule::kMayBeInfinite ? nullptr : "must be a finite number";
  if (rule == NumberRule::kPositive && !(number > 0)) return "must be greater than 0";
  if (rule == NumberRule::kNotNegative && number < 0) return "must be at least 0";
  if (rule == NumberRule::kNoneZero && number == 0) return "must not be zero";
  return nullptr;
}

std::string how_many(std::size_t least, std::size_t most) {
  if (least == 1 && most == 1) return "a number";
  if (least == most) return std::to_string(most) + " numbers";
  return std::to_string(least) + " to " + std::to_string(most) + " numbers";
}

}  // namespace

XmlPlace place_of(const XMLElement& element) {
  // Elements that were copied or made have no line; their user data, or that of one around them, has it.
  for (const tinyxml2::XMLNode* node = &element; node != nullptr; node = node->Parent()) {
    if (const auto* place = static_cast<const XmlPlace*>(node->GetUserData())) return *place;
    if (node->GetLineNum() > 0 && node->ToElement() != nullptr) return {"", node->GetLineNum()};
  }
  return {};
}

Remark remark(const XMLElement& element, const std::string& text) {
  const XmlPlace place = place_of(element);
  return {text, place.line, place.file};
}

void fail_at(const XMLElement& element, const std::string& file, const std::string& message) {
  const XmlPlace place = place_of(element);
  throw config::ConfigError({place.file.empty() ? file : place.file, place.line, owner(element)}, message);
}

std::string required(const XMLElement& element, const char* attribute, const std::string& file) {
  const char* text = element.Attribute(attribute);
  if (text == nullptr || *text == '\0')
    fail_at(element, file, "<" + std::string(element.Name()) + "> needs '" + attribute + "'");
  return text;
}

void check_numbers(const XMLElement& element, const std::string& what, const char* text, std::size_t least,
                   std::size_t most, NumberRule rule, const std::string& file) {
  const std::string shown = text == nullptr ? "" : std::string(text).substr(0, 60);
  TextCursor cursor(text == nullptr ? std::string_view() : std::string_view(text));
  std::size_t count = 0;
  bool all_zero = true;
  for (std::string_view word = cursor.word(); !word.empty(); word = cursor.word(), ++count) {
    double number = 0.0;
    if (!parse_number(word, number))
      fail_at(element, file, what + " must be " + how_many(least, most) + ", is '" + shown + "'");
    if (const char* fault = number_fault(number, rule))
      fail_at(element, file, what + " " + fault + ", is '" + shown + "'");
    all_zero = all_zero && number == 0.0;
  }
  if (count < least || count > most)
    fail_at(element, file, what + " must be " + how_many(least, most) + ", is '" + shown + "'");
  if (rule == NumberRule::kNotZero && all_zero) fail_at(element, file, what + " must not be zero");
}

std::size_t walk(const XMLElement& root, const std::function<bool(const XMLElement&)>& skip,
                 const std::function<void(const XMLElement&)>& visit) {
  std::size_t count = 0;
  for (const XMLElement* child = root.FirstChildElement(); child; child = child->NextSiblingElement()) {
    if (skip(*child)) continue;
    visit(*child);
    count += 1 + walk(*child, skip, visit);
  }
  return count;
}

void check_amount(std::size_t elements, const ModelXml& xml, const std::string& file) {
  const auto refuse = [&](std::size_t count, std::size_t most, const std::string& what) {
    if (count > most)
      throw config::ConfigError({file, 0, ""}, "has " + std::to_string(count) + " " + what + ", at most " +
                                                   std::to_string(most) + " are read");
  };
  refuse(elements, kMaxModelElements, "XML elements");
  refuse(xml.links.size(), kMaxModelLinks, "links");
}

std::vector<Remark> unread_elements(const XMLElement& root, const std::vector<const char*>& names) {
  std::vector<std::size_t> counts(names.size(), 0);
  std::vector<int> lines(names.size(), 0);
  const auto index = [&](const XMLElement& element) {
    return std::find_if(names.begin(), names.end(),
                        [&](const char* n) { return !std::strcmp(n, element.Name()); }) -
           names.begin();
  };
  const auto is_counted = [&](const XMLElement& element) {
    const auto i = static_cast<std::size_t>(index(element));
    if (i < counts.size() && counts[i]++ == 0) lines[i] = element.GetLineNum();
    return i < counts.size();  // its subtree is skipped, too
  };
  walk(root, is_counted, [](const XMLElement&) {});
  std::vector<Remark> sentences;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (counts[i] == 0) continue;
    const std::string element = std::string(" <") + names[i] + "> element";
    sentences.push_back(
        {std::to_string(counts[i]) + element + (counts[i] == 1 ? " is" : "s are") + " not read", lines[i]});
  }
  return sentences;
}

}  // namespace visum::scene
