#include "server/scene/convert/x3d_prototypes.h"

#include <algorithm>
#include <optional>
#include <set>

#include "protocol/config/config.h"
#include "protocol/config/read_file.h"
#include "protocol/config/unknown_name.h"
#include "server/scene/convert/x3d_text.h"
#include "server/scene/mesh_readers.h"

namespace visum::scene {
namespace {

namespace fs = std::filesystem;

// A tree that is copied for each use.
struct Template {
  X3dNode body;
  std::set<std::string> defs;             // in the body
  std::map<std::string, X3dNode> fields;  // its interface, by name
  std::map<std::string, int> uses;        // by field: how often the body refers to it
  std::string fault;                      // why it cannot be used; empty: it can
};
using Prototypes = std::map<std::string, std::shared_ptr<const Template>>;

// A file that was read and expanded.
struct Expanded {
  std::shared_ptr<const Template> nodes;  // a Group of all its nodes
  Prototypes prototypes;                  // those declared at its top
};

void note(const X3dNode& node, Template& made) {
  if (!node.def.empty()) made.defs.insert(node.def);
  for (const auto& [field, from] : node.is) ++made.uses[from];
  for (const auto& [field, from] : node.given_is) ++made.uses[from];
  for (const auto& [field, child] : node.children) note(child, made);
}

int height_of(const X3dNode& node) {
  int height = 0;
  for (const auto& [field, child] : node.children) height = std::max(height, height_of(child));
  return height + 1;
}

void set_file(X3dNode& node, const std::shared_ptr<const std::string>& file) {
  node.file = file;
  for (auto& [field, child] : node.children) set_file(child, file);
}

class Expander {
 public:
  explicit Expander(const fs::path& file) : main_(file) {}

  X3dNode read() {
    X3dNode scene = parse(main_);
    chain_.push_back(config::identity_of(main_));
    scopes_.emplace_back();
    is_xml_ = is_xml(main_);
    expand(scene);
    refuse_is(scene);
    return scene;
  }

 private:
  [[noreturn]] void fail(const X3dNode& node, const std::string& message) const {
    fail_at(node, main_.string(), message);
  }
  static bool is_x3d_name(const fs::path& file) {
    const std::string ending = lower_extension(file);
    return ending == ".x3d" || ending == ".x3dv" || ending == ".wrl" || ending == ".vrml";
  }
  static bool is_xml(const fs::path& file) { return lower_extension(file) == ".x3d"; }

  X3dNode parse(const fs::path& file) {
    const config::FileContent content = config::read_file(file, kMaxX3dBytes);
    if (!content.fault.empty()) throw config::ConfigError({file.string(), 0, ""}, content.fault);
    bytes_read_ += content.bytes.size();
    if (bytes_read_ > kMaxX3dAllBytes)
      throw config::ConfigError({file.string(), 0, ""}, "with this file, more than " +
                                                            std::to_string(kMaxX3dAllBytes >> 20) +
                                                            " MiB would be read for one scene");
    return is_xml(file) ? read_x3d_xml(content.bytes, file.string())
                        : read_x3d_classic(content.bytes, file.string());
  }

  // IS means something only in the body of a prototype.
  void refuse_is(const X3dNode& node) const {
    if (!node.is.empty() || !node.given_is.empty()) fail(node, "IS stands outside of a prototype");
    for (const auto& [field, child] : node.children) refuse_is(child);
  }

  // Expands everything below a node. Declarations hold from where they stand to the end of the body or file.
  void expand(X3dNode& node) {
    std::vector<X3dChild> children = std::move(node.children);
    node.children.clear();
    for (auto& [field, child] : children) {
      if (child.type == "ProtoDeclare" || child.type == "ExternProtoDeclare") {
        const std::string name = child.def;
        auto prototype =
            child.type == "ProtoDeclare" ? declared(std::move(child)) : declared_elsewhere(child);
        scopes_.back()[name] = std::move(prototype);
        continue;
      }
      expand(child);
      X3dNode made =
          child.type == "Inline" && !find(child.type) ? inlined(child) : instance(std::move(child));
      if (field.empty()) field = usual_x3d_field(made.type, node.type);
      node.add(field, std::move(made));
    }
  }

  std::shared_ptr<const Template> find(const std::string& name) const {
    for (auto scope = scopes_.rbegin(); scope != scopes_.rend(); ++scope)
      if (const auto found = scope->find(name); found != scope->end()) return found->second;
    return nullptr;
  }

  std::shared_ptr<const Template> declared(X3dNode declaration) {
    auto made = std::make_shared<Template>();
    std::vector<X3dChild> body;
    scopes_.emplace_back();
    X3dNode nodes;
    nodes.type = "Group";
    for (auto& [field, child] : declaration.children) {
      if (field == "body") {
        nodes.add("children", std::move(child));
        continue;
      }
      expand(child);
      const std::string name = child.def;
      made->fields[name] = std::move(child);
    }
    expand(nodes);
    scopes_.pop_back();
    // An empty body shows nothing.
    if (nodes.children.empty()) nodes.add("children", {.type = "Group", .line = declaration.line});
    made->body = std::move(nodes.children.front().node);  // the others are not shown, says the standard
    note(made->body, *made);
    for (const auto& [field, count] : made->uses)
      if (!made->fields.contains(field))
        fail(declaration, "its body names the field '" + field + "', which it does not have");
    return made;
  }

  // EXTERNPROTO. It fails only if an instance of it is made.
  std::shared_ptr<const Template> declared_elsewhere(const X3dNode& declaration) {
    const auto failed = [](const std::string& fault) {
      auto made = std::make_shared<Template>();
      made->fault = fault;
      return made;
    };
    std::string wanted, fault;
    const std::optional<fs::path> file = local_file(declaration, wanted, fault);
    if (!file) return failed(fault);
    const Prototypes& known = expanded(*file, declaration).prototypes;
    const auto found = known.find(wanted.empty() ? declaration.def : wanted);
    if (found != known.end()) return found->second;
    if (wanted.empty() && known.size() == 1) return known.begin()->second;
    return failed("'" + file->string() + "' has no prototype '" +
                  (wanted.empty() ? declaration.def : wanted) + "'");
  }

  // The first of the addresses that is a local file that exists. `part`: what follows '#'.
  std::optional<fs::path> local_file(const X3dNode& node, std::string& part, std::string& fault) const {
    const auto url = node.values.find("url");
    if (url == node.values.end() || url->second.empty()) {
      fault = "has no url";
      return {};
    }
    std::vector<std::string> addresses = texts_of(url->second);
    if (addresses.empty()) addresses.push_back(url->second);
    const fs::path folder = (node.file ? fs::path(*node.file) : main_).parent_path();
    for (std::string address : addresses) {
      const std::size_t hash = address.find('#');
      part = hash == std::string::npos ? "" : address.substr(hash + 1);
      address.resize(std::min(hash, address.size()));
      if (address.starts_with("file://")) address.erase(0, 7);
      if (address.find(':') != std::string::npos) {
        if (fault.empty()) fault = "'" + address.substr(0, 200) + "' is not the address of a local file";
        continue;
      }
      std::ranges::replace(address, '\\', '/');
      const fs::path file = (folder / address).lexically_normal();
      if (!is_x3d_name(file)) {
        fault = "'" + file.string() + "' is not a file of X3D or VRML97";
        continue;
      }
      if (config::is_file(file)) return file;
      fault = "there is no file '" + file.string() + "'";
    }
    return {};
  }

  // Reads a file once, however often it is inlined. `wanted_by` is blamed for circles and too many files.
  const Expanded& expanded(const fs::path& file, const X3dNode& wanted_by) {
    const fs::path name = config::identity_of(file);
    if (std::ranges::find(chain_, name) != chain_.end())
      fail(wanted_by, "'" + file.string() + "' inlines itself");
    if (const auto known = files_.find(name); known != files_.end()) return known->second;
    if (chain_.size() > kMaxX3dInlineDepth)
      fail(wanted_by, "files inline each other more than " + std::to_string(kMaxX3dInlineDepth) + " deep");
    if (files_.size() + 1 >= kMaxX3dFiles)
      fail(wanted_by, "more than " + std::to_string(kMaxX3dFiles) + " files would be read for one scene");
    X3dNode scene = parse(file);
    set_file(scene, std::make_shared<const std::string>(file.string()));
    chain_.push_back(name);
    std::vector<Prototypes> outer(1);
    outer.swap(scopes_);
    const bool was_xml = std::exchange(is_xml_, is_xml(file));
    expand(scene);
    refuse_is(scene);
    is_xml_ = was_xml;
    outer.swap(scopes_);
    chain_.pop_back();
    auto nodes = std::make_shared<Template>();
    nodes->body = std::move(scene);
    nodes->body.type = "Group";
    note(nodes->body, *nodes);
    return files_[name] = {nodes, std::move(outer.front())};
  }

  X3dNode inlined(const X3dNode& node) {
    if (!flag_of(node, "load", true, main_.string())) {
      X3dNode nothing;
      nothing.type = "Group";
      nothing.line = node.line;
      return nothing;
    }
    std::string part, fault;
    const std::optional<fs::path> file = local_file(node, part, fault);
    if (!file) fail(node, fault);
    X3dNode empty;
    empty.line = node.line;
    empty.file = node.file;
    X3dNode made = filled(*expanded(*file, node).nodes, empty);
    made.def = node.def;
    return made;
  }

  // Returns the node itself if it is no instance.
  X3dNode instance(X3dNode node) {
    if (!node.use.empty() || (is_xml_ && node.prototype.empty())) return node;
    const auto prototype = find(node.type);
    if (!prototype) {
      if (!node.prototype.empty()) fail(node, "there is no prototype of this name before it");
      return node;
    }
    if (!prototype->fault.empty()) fail(node, prototype->fault);
    node.prototype = node.type;
    for (const auto& [name, value] : node.values) check_field(node, *prototype, name);
    for (const auto& [name, from] : node.is) check_field(node, *prototype, name);
    for (const auto& [name, child] : node.children) check_field(node, *prototype, name);
    X3dNode made = filled(*prototype, node);
    made.line = node.line;
    made.file = node.file;
    made.def = node.def;
    made.prototype = node.prototype;
    made.given.clear();
    for (const auto& [name, field] : prototype->fields)
      if (const auto value = field.values.find("value"); value != field.values.end())
        made.given[name] = value->second;
    for (const auto& [name, value] : node.values) made.given[name] = value;
    made.given_is = node.is;
    if (height_of(made) > kMaxX3dTreeDepth)
      fail(node, "with prototypes, nodes are nested more than " + std::to_string(kMaxX3dTreeDepth) + " deep");
    return made;
  }

  void check_field(const X3dNode& node, const Template& prototype, const std::string& name) const {
    if (prototype.fields.contains(name)) return;
    std::vector<std::string> known;
    for (const auto& [field, entry] : prototype.fields) known.push_back(field);
    fail(node, "its prototype has no field '" + name + "'" + config::did_you_mean(name, known));
  }

  // A copy of the prototype's body in which the fields of `node` are set. Its names get a mark, so that no
  // two copies share one.
  X3dNode filled(const Template& prototype, X3dNode& node) {
    const std::string mark = kX3dMark + std::to_string(++copies_);
    std::map<std::string, std::vector<X3dNode>> nodes;
    for (auto& [field, child] : node.children) {
      if (child.use.empty() && child.def.empty() && prototype.uses.contains(field) &&
          prototype.uses.at(field) > 1)
        child.def = field + mark + "." + std::to_string(nodes[field].size());
      nodes[field].push_back(std::move(child));
    }
    node.children.clear();
    return copied(prototype.body, {prototype, node, nodes, mark});
  }

  struct Filling {
    const Template& prototype;
    const X3dNode& node;
    std::map<std::string, std::vector<X3dNode>>& nodes;  // the node's own, moved away where they are used
    const std::string& mark;
  };

  void count(const X3dNode& blamed, const X3dNode& made) {
    if (++copied_nodes_ > kMaxX3dNodes)
      fail(blamed, "prototypes and inlined files make more than " + std::to_string(kMaxX3dNodes) + " nodes");
    for (const auto& [field, value] : made.values) copied_bytes_ += field.size() + value.size();
    for (const auto& [field, value] : made.given) copied_bytes_ += field.size() + value.size();
    if (copied_bytes_ > kMaxX3dAllBytes)
      fail(blamed, "prototypes and inlined files make more than " + std::to_string(kMaxX3dAllBytes >> 20) +
                       " MiB of values");
  }

  X3dNode copied(const X3dNode& from, const Filling& filling) {
    X3dNode made;
    made.type = from.type;
    made.line = from.line;
    made.file = from.file;
    made.def = from.def.empty() ? "" : from.def + filling.mark;
    made.use = filling.prototype.defs.contains(from.use) ? from.use + filling.mark : from.use;
    if (!from.use.empty() && from.use == filling.prototype.body.def && !filling.node.def.empty())
      made.use = filling.node.def;
    made.prototype = from.prototype;
    made.values = from.values;
    made.given = from.given;
    count(filling.node, made);
    for (const auto& [field, child] : from.children) made.add(field, copied(child, filling));
    for (const auto& [field, of] : from.is) fill(made, field, of, filling);
    for (const auto& [field, of] : from.given_is) {
      if (const auto value = filling.node.values.find(of); value != filling.node.values.end())
        made.given[field] = value->second;
      else if (const auto is = filling.node.is.find(of); is != filling.node.is.end())
        made.given_is[field] = is->second;
      else if (const auto usual = filling.prototype.fields.at(of).values.find("value");
               usual != filling.prototype.fields.at(of).values.end())
        made.given[field] = usual->second;
    }
    return made;
  }

  // Sets `field` of `made` to what the instance gives for the prototype's field `of`, or to its default.
  void fill(X3dNode& made, const std::string& field, const std::string& of, const Filling& filling) {
    const X3dNode& node = filling.node;
    if (const auto is = node.is.find(of); is != node.is.end()) {
      made.is[field] = is->second;
    } else if (const auto given = filling.nodes.find(of); given != filling.nodes.end()) {
      for (X3dNode& child : given->second) {
        X3dNode again;
        again.use = child.use.empty() ? child.def : child.use;
        again.line = child.line;
        again.file = child.file;
        made.add(field, std::exchange(child, std::move(again)));
      }
    } else if (const auto value = node.values.find(of); value != node.values.end()) {
      made.values[field] = value->second;
    } else {
      const X3dNode& usual = filling.prototype.fields.at(of);
      if (const auto text = usual.values.find("value"); text != usual.values.end())
        made.values[field] = text->second;
      for (const auto& [name, child] : usual.children) made.add(field, copied(child, filling));
    }
  }

  const fs::path main_;
  bool is_xml_ = false;             // the file being expanded
  std::vector<fs::path> chain_;     // files, each inlined by the one before
  std::vector<Prototypes> scopes_;  // of the file being expanded, the innermost last
  std::map<fs::path, Expanded> files_;
  std::size_t bytes_read_ = 0, copies_ = 0, copied_nodes_ = 0, copied_bytes_ = 0;
};

}  // namespace

X3dNode read_x3d_file(const fs::path& file) {
  return Expander(file).read();
}

}  // namespace visum::scene
