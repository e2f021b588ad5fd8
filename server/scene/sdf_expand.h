// Makes one model of an SDF file: what it includes is put in its place, and a <world> becomes a model that
// holds the world's models. Inner header, as xml_checks.h.
#pragma once

#include <deque>
#include <filesystem>
#include <map>
#include <memory>
#include <string>

#include "server/scene/packages.h"
#include "server/scene/xml_checks.h"

namespace visum::scene {

// Reads SDF files into one document. Owns the places of the elements that came from other files
// (see place_of()), so it must outlive the document's use. Throws ConfigError.
class SdfExpander {
 public:
  SdfExpander(tinyxml2::XMLDocument& document, const std::string& file, const Packages& packages,
              ModelXml& xml)
      : document_(document), file_(file), packages_(packages), xml_(xml) {}

  // Returns the model. It is null if the file holds a <world> without models.
  XMLElement* expand();

 private:
  struct Source {
    std::string file;
    double version = 0.0;
    std::unique_ptr<tinyxml2::XMLDocument> document;
  };

  XMLElement* world_as_model(XMLElement& world);
  void expand_model(XMLElement& model, const std::string& file, int depth);
  void include(XMLElement& include, XMLElement& parent, const std::string& file, int depth);
  void merge(XMLElement& model, XMLElement& into);
  void leave_out(XMLElement& include, XMLElement& parent, const std::string& why);
  std::filesystem::path find(const XMLElement& include, const std::string& uri, const std::string& file);
  const Source& open(const std::filesystem::path& file, const XMLElement& asked_by);
  XMLElement* copy(const XMLElement& from, const std::string& file);
  void make_names_unique(XMLElement& world);

  tinyxml2::XMLDocument& document_;
  const std::string file_;
  const Packages& packages_;
  ModelXml& xml_;
  bool in_world_ = false;
  std::map<std::string, Source> sources_;
  std::deque<XmlPlace> places_;
  std::size_t copied_ = 0;  // elements
};

// An SDF file that was checked and made one model; the document keeps it. sdf_xml.cc.
class SdfDocument {
 public:
  // Throws ConfigError. The document must outlive this object.
  SdfDocument(tinyxml2::XMLDocument& document, const std::string& file, const Packages& packages);
  const ModelXml& xml() const { return xml_; }
  const XMLElement* model() const { return model_; }  // null if the file holds a <world> without models

 private:
  ModelXml xml_;
  SdfExpander expander_;
  XMLElement* model_;
};

}  // namespace visum::scene
