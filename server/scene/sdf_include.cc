#include "server/scene/sdf_include.h"

#include <cmath>
#include <cstring>

#include "protocol/config/read_file.h"
#include "server/scene/text_cursor.h"

namespace visum::scene {
namespace {

namespace fs = std::filesystem;
using config::is_file;

constexpr std::size_t kMaxManifestBytes = 1u << 20;
constexpr double kNewest = 9;  // 1.9: the newest version whose rules are known here

// The file that model.config names for the newest version that can be read.
fs::path sdf_of_manifest(const fs::path& folder) {
  const auto content = config::read_file(folder / "model.config", kMaxManifestBytes);
  tinyxml2::XMLDocument manifest;
  if (!content.fault.empty() || manifest.Parse(content.bytes.data(), content.bytes.size()) != 0) return {};
  const XMLElement* model = manifest.FirstChildElement("model");
  std::string best;
  double newest = -1.0;
  for (auto sdf = model ? model->FirstChildElement("sdf") : nullptr; sdf;
       sdf = sdf->NextSiblingElement("sdf")) {
    const double version = sdf_version(sdf->Attribute("version") ? sdf->Attribute("version") : "");
    if (version <= newest || version > kNewest) continue;
    newest = version;
    best = text_of(sdf);
  }
  return best.empty() || !is_file(folder / best) ? fs::path() : folder / best;
}

fs::path sdf_at(const fs::path& path) {
  if (is_file(path)) return path;
  if (is_file(path / "model.config"))
    if (const fs::path named = sdf_of_manifest(path); !named.empty()) return named;
  return is_file(path / "model.sdf") ? path / "model.sdf" : fs::path();
}

std::string after(const std::string& uri, const std::string& prefix) {
  return uri.compare(0, prefix.size(), prefix) == 0 ? uri.substr(prefix.size()) : "";
}

}  // namespace

fs::path find_included(const std::string& uri, const std::string& file, const Packages& packages) {
  for (const char* scheme : {"model://", "package://"})
    if (const std::string rest = after(uri, scheme); !rest.empty())
      return find_in_package(rest, file, packages, sdf_at);
  std::string path = after(uri, "file://");
  if (path.empty()) path = uri;
  if (path.find("://") != std::string::npos) return {};
  const fs::path beside = sdf_at((fs::path(file).parent_path() / path).lexically_normal());
  return beside.empty() && fs::path(path).is_relative() ? find_in_package(path, file, packages, sdf_at)
                                                        : beside;
}

std::string name_of_builtin(const std::string& uri) {
  std::string name = uri;
  while (!name.empty() && name.back() == '/') name.pop_back();
  const std::size_t slash = name.rfind('/');
  name = slash == std::string::npos ? name : name.substr(slash + 1);
  for (char& c : name) c = c == ' ' ? '_' : static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return name;
}

XMLElement* make_ground_plane(tinyxml2::XMLDocument& document) {
  XMLElement* model = document.NewElement("model");
  model->SetAttribute("name", "ground_plane");
  model->InsertNewChildElement("static")->SetText("true");
  XMLElement* link = model->InsertNewChildElement("link");
  link->SetAttribute("name", "link");
  XMLElement* collision = link->InsertNewChildElement("collision");
  collision->SetAttribute("name", "collision");
  XMLElement* plane = collision->InsertNewChildElement("geometry")->InsertNewChildElement("plane");
  plane->InsertNewChildElement("normal")->SetText("0 0 1");
  plane->InsertNewChildElement("size")->SetText("100 100");
  return model;
}

double sdf_version(const std::string& text) {
  if (text.compare(0, 2, "1.") != 0) return 0.0;
  double minor = 0.0;
  return parse_number(std::string_view(text).substr(2), minor) && std::isfinite(minor) ? minor : 0.0;
}

bool has_include(const XMLElement& element) {
  for (auto child = element.FirstChildElement(); child; child = child->NextSiblingElement()) {
    if (!std::strcmp(child->Name(), "include")) return true;
    if (!std::strcmp(child->Name(), "model") && has_include(*child)) return true;
  }
  return false;
}

bool is_true(const XMLElement* element) {
  const std::string text = text_of(element);
  return text == "true" || text == "1";
}

std::string text_of(const XMLElement* element) {
  const char* text = element ? element->GetText() : nullptr;
  if (text == nullptr) return "";
  const std::string all = text;
  const std::size_t begin = all.find_first_not_of(" \t\r\n");
  return begin == std::string::npos ? "" : all.substr(begin, all.find_last_not_of(" \t\r\n") - begin + 1);
}

std::optional<std::vector<double>> text_numbers(const XMLElement& element) {
  std::vector<double> all;
  TextCursor cursor(element.GetText() ? element.GetText() : "");
  for (std::string_view word = cursor.word(); !word.empty(); word = cursor.word()) {
    double number = 0.0;
    if (!parse_number(word, number) || !std::isfinite(number)) return std::nullopt;
    all.push_back(number);
  }
  return all;
}

}  // namespace visum::scene
