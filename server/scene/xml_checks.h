// Checks that model_xml.cc and urdf_xml.cc share. Inner header: the only one that includes tinyxml2.
#pragma once

#include <tinyxml2.h>

#include <functional>
#include <string>
#include <vector>

#include "server/scene/model_xml.h"
#include "server/scene/packages.h"

namespace visum::scene {

using tinyxml2::XMLElement;

// Where an element stands. `file` is empty in the model's own file.
struct XmlPlace {
  std::string file;
  int line = 0;
};
XmlPlace place_of(const XMLElement& element);
Remark remark(const XMLElement& element, const std::string& text);

// Parses a file without document types. Throws ConfigError.
void parse_xml(tinyxml2::XMLDocument& document, const std::string& text, const std::string& file);

// Throws ConfigError at the element and names the link or joint around it.
[[noreturn]] void fail_at(const XMLElement& element, const std::string& file, const std::string& message);

// The text of an attribute. Fails if it is missing or empty.
std::string required(const XMLElement& element, const char* attribute, const std::string& file);

// kNotZero: at least one number is not 0. kNoneZero: no number is 0.
enum class NumberRule { kAny, kPositive, kNotNegative, kNotZero, kNoneZero, kMayBeInfinite };

// Checks that `text` holds `least` to `most` numbers that satisfy `rule`. `what` names it in the error ("mass
// value").
void check_numbers(const XMLElement& element, const std::string& what, const char* text, std::size_t least,
                   std::size_t most, NumberRule rule, const std::string& file);

// Calls `visit` for each element below `root`, in the order of the file. If `skip` returns true, the
// element's subtree is left out. Returns the number of elements.
std::size_t walk(const XMLElement& root, const std::function<bool(const XMLElement&)>& skip,
                 const std::function<void(const XMLElement&)>& visit);

// "2 <transmission> elements are not read", for each of `names` that occurs in the file.
std::vector<Remark> unread_elements(const XMLElement& root, const std::vector<const char*>& names);

// Bounds for a model's file, so that none can take all memory.
inline constexpr std::size_t kMaxModelElements = 50000;
inline constexpr std::size_t kMaxModelLinks = 1000;
void check_amount(std::size_t elements, const ModelXml& xml, const std::string& file);

// Takes out of a URDF what cannot be used and need not be (faults of looks and of fixed joints), and notes
// what the links' masses lack. urdf_repair.cc. Each change is a loss or a repair of `xml`.
void repair_urdf(XMLElement& root, ModelXml& xml);

// Repairs a URDF and checks all that read_urdf_robot() relies on: names, numbers, and the tree.
ModelXml check_urdf(tinyxml2::XMLDocument& document, const std::string& file);

// Checks the text of an element that holds numbers in SDF. Throws ConfigError.
void check_sdf_text(const XMLElement& element, const std::string& file);

}  // namespace visum::scene
