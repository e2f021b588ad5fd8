#include "server/scene/model_xml.h"

#include "protocol/config/config.h"
#include "server/scene/xml_checks.h"

namespace visum::scene {
namespace {

// Document types can define entities, which can grow without bound or name other files.
void refuse_document_types(const tinyxml2::XMLDocument& document, const std::string& file) {
  for (const tinyxml2::XMLNode* node = document.FirstChild(); node; node = node->NextSibling())
    if (node->ToUnknown())
      throw config::ConfigError({file, node->GetLineNum(), ""},
                                "document types and entities (<!...>) are not supported");
}

std::string in_words(tinyxml2::XMLError error) {
  switch (error) {
    case tinyxml2::XML_ERROR_EMPTY_DOCUMENT:
      return "the file is empty";
    case tinyxml2::XML_ERROR_MISMATCHED_ELEMENT:
      return "an element is not closed, or by another one's name";
    case tinyxml2::XML_ERROR_PARSING_ELEMENT:
      return "an element is cut off or not well written";
    case tinyxml2::XML_ERROR_PARSING_ATTRIBUTE:
      return "an attribute is not well written";
    case tinyxml2::XML_ERROR_PARSING_TEXT:
      return "text stands outside of all elements";
    default:
      return tinyxml2::XMLDocument::ErrorIDToName(error);
  }
}

void parse(tinyxml2::XMLDocument& document, const std::string& text, const std::string& file) {
  if (text.find('\0') != std::string::npos)
    throw config::ConfigError({file, 0, ""}, "not valid XML: holds a zero byte");
  if (document.Parse(text.data(), text.size()) == tinyxml2::XML_SUCCESS) return;
  if (document.ErrorID() == tinyxml2::XML_ELEMENT_DEPTH_EXCEEDED)
    throw config::ConfigError({file, document.ErrorLineNum(), ""}, "XML elements are nested too deeply");
  throw config::ConfigError({file, document.ErrorLineNum(), ""},
                            "not valid XML: " + in_words(document.ErrorID()));
}

}  // namespace

void parse_xml(tinyxml2::XMLDocument& document, const std::string& text, const std::string& file) {
  parse(document, text, file);
  refuse_document_types(document, file);
}

}  // namespace visum::scene
