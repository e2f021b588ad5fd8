#include "server/scene/mjcf/document.h"

#include <tinyxml2.h>

#include "protocol/config/read_file.h"
#include "server/scene/model_xml.h"

namespace visum::scene::mjcf {
namespace {

namespace fs = std::filesystem;

class Reader {
 public:
  explicit Reader(const fs::path& main) : folder_(main.parent_path()) {}

  Element read(const fs::path& file, const std::string& text, std::size_t depth) {
    const auto name = std::make_shared<const std::string>(file.string());
    bytes_ += text.size();
    if (bytes_ > kMaxTextBytes) refuse(*name, 0, "has more than 32 MiB with all that it includes");
    if (text.find('\0') != std::string::npos) refuse(*name, 0, "not valid XML: holds a zero byte");
    tinyxml2::XMLDocument document;
    document.Parse(text.data(), text.size());
    if (document.ErrorID() == tinyxml2::XML_ELEMENT_DEPTH_EXCEEDED)
      refuse(*name, document.ErrorLineNum(), "XML elements are nested too deeply");
    if (document.Error())
      refuse(*name, document.ErrorLineNum(),
             std::string("not valid XML: ") + tinyxml2::XMLDocument::ErrorIDToName(document.ErrorID()));
    for (const tinyxml2::XMLNode* node = document.FirstChild(); node; node = node->NextSibling())
      if (node->ToUnknown())
        refuse(*name, node->GetLineNum(), "document types and entities (<!...>) are not supported");
    if (document.RootElement() == nullptr) refuse(*name, 0, "has no root element");
    return copied(*document.RootElement(), name, file, depth);
  }

 private:
  [[noreturn]] static void refuse(const std::string& file, int line, const std::string& message) {
    throw config::ConfigError({file, line, ""}, message);
  }

  Element copied(const tinyxml2::XMLElement& from, const std::shared_ptr<const std::string>& name,
                 const fs::path& file, std::size_t depth) {
    Element element;
    element.tag = from.Name();
    element.file = name;
    element.line = from.GetLineNum();
    if (++count_ > kMaxElements)
      element.fail("has more than " + std::to_string(kMaxElements) +
                   " XML elements with all that it includes");
    if (depth > kMaxDepth) element.fail("XML elements are nested too deeply");
    for (auto attribute = from.FirstAttribute(); attribute; attribute = attribute->Next())
      element.attributes.emplace_back(attribute->Name(), attribute->Value());
    for (auto child = from.FirstChildElement(); child; child = child->NextSiblingElement()) {
      Element inner = copied(*child, name, file, depth + 1);
      if (inner.tag != "include") {
        element.children.push_back(std::move(inner));
        continue;
      }
      Element included = include(inner, file, depth);
      for (Element& below : included.children) element.children.push_back(std::move(below));
    }
    return element;
  }

  // Files are named relative to the main file. Some collections count from the including one.
  Element include(const Element& entry, const fs::path& by, std::size_t depth) {
    const std::string* address = entry.attribute("file");
    if (address == nullptr || address->empty()) entry.fail("<include> needs 'file'");
    if (++includes_ > kMaxIncludes)
      entry.fail("there are more than " + std::to_string(kMaxIncludes) + " includes");
    fs::path file = (folder_ / *address).lexically_normal();
    if (!config::is_file(file)) file = (by.parent_path() / *address).lexically_normal();
    const config::FileContent content = config::read_file(file, kMaxModelBytes);
    if (!content.fault.empty()) entry.fail("'" + *address + "': " + content.fault);
    return read(file, content.bytes, depth + 1);
  }

  const fs::path folder_;
  std::size_t count_ = 0, includes_ = 0, bytes_ = 0;
};

}  // namespace

const std::string* Element::attribute(std::string_view name) const {
  for (const auto& [key, value] : attributes)
    if (key == name) return &value;
  return nullptr;
}

std::string Element::name() const {
  const std::string* given = attribute("name");
  return given ? *given : std::string();
}

config::Place Element::place() const {
  const std::string given = name();
  return {*file, line, given.empty() ? "<" + tag + ">" : tag + " '" + given + "'"};
}

void Element::fail(const std::string& message) const {
  throw config::ConfigError(place(), message);
}

Element read_document(const fs::path& file, const std::string& text) {
  return Reader(file).read(file, text, 0);
}

}  // namespace visum::scene::mjcf
