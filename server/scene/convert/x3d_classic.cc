// X3D's classic encoding, which is VRML97's: DEF NAME Type { field value ... }, # comments, commas as blanks.
#include <algorithm>
#include <cctype>
#include <string_view>

#include "protocol/config/config.h"
#include "server/scene/convert/x3d_node.h"

namespace visum::scene {
namespace {

struct Token {
  enum class Kind { kEnd, kWord, kText, kOpen, kClose, kBegin, kFinish };  // { } [ ]
  Kind kind = Kind::kEnd;
  std::string text;
  int line = 0;
};

bool is_number_word(const Token& token) {
  if (token.kind != Token::Kind::kWord) return false;
  const char c = token.text.front();
  return std::isdigit(static_cast<unsigned char>(c)) != 0 || c == '-' || c == '+' || c == '.';
}

// Splits the text into tokens. Comments and commas count as blanks.
class Tokens {
 public:
  Tokens(std::string_view text, std::string file) : text_(text), file_(std::move(file)) {
    if (text_.starts_with("\xEF\xBB\xBF")) at_ = 3;  // a byte order mark
    next();
  }

  const Token& now() const { return now_; }
  Token take() {
    Token taken = now_;
    next();
    return taken;
  }
  [[noreturn]] void fail(int line, const std::string& message) const {
    throw config::ConfigError({file_, line, ""}, message);
  }

 private:
  using Kind = Token::Kind;

  static bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n' || c == ','; }
  static bool ends_word(char c) {
    return is_blank(c) || c == '{' || c == '}' || c == '[' || c == ']' || c == '"' || c == '#';
  }

  void skip() {
    while (at_ < text_.size()) {
      if (text_[at_] == '#')
        while (at_ < text_.size() && text_[at_] != '\n') ++at_;
      else if (is_blank(text_[at_]))
        line_ += text_[at_++] == '\n';
      else
        return;
    }
  }

  void next() {
    skip();
    now_ = {Kind::kEnd, "", line_};
    if (at_ == text_.size()) return;
    const char c = text_[at_];
    if (const auto bracket = std::string_view("{}[]").find(c); bracket != std::string_view::npos) {
      constexpr Kind kBrackets[] = {Kind::kOpen, Kind::kClose, Kind::kBegin, Kind::kFinish};
      now_ = {kBrackets[bracket], std::string(1, c), line_};
      ++at_;
    } else if (c == '"') {
      text();
    } else {
      const std::size_t begin = at_;
      while (at_ < text_.size() && !ends_word(text_[at_])) ++at_;
      now_ = {Kind::kWord, std::string(text_.substr(begin, at_ - begin)), line_};
    }
  }

  void text() {
    now_.kind = Kind::kText;
    for (++at_; at_ < text_.size() && text_[at_] != '"'; ++at_) {
      if (text_[at_] == '\\' && at_ + 1 < text_.size()) ++at_;
      line_ += text_[at_] == '\n';
      now_.text += text_[at_];
    }
    if (at_ == text_.size()) fail(now_.line, "a text has no end");
    ++at_;
  }

  std::string_view text_;
  const std::string file_;
  std::size_t at_ = 0;
  int line_ = 1;
  Token now_;
};

// Quotes a text, as XML attributes with several texts do.
std::string in_quotes(const std::string& text) {
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') quoted += '\\';
    quoted += c;
  }
  return quoted + "\"";
}

bool has_header(std::string_view text) {
  return text.starts_with("#X3D V3.") || text.starts_with("#X3D V4.") || text.starts_with("#VRML V2.0");
}

// Empty if one of the comments at the top, of which the first should be it, is a header; otherwise says what
// is wrong.
std::string fault_of_header(std::string_view text) {
  if (text.starts_with("\x1F\x8B")) return "is compressed; unpack it first: gunzip < FILE > FILE.wrl";
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
  while (text.starts_with('#') || text.starts_with('\r') || text.starts_with('\n')) {
    if (has_header(text)) return "";
    if (text.starts_with("#VRML V1.0")) return "is VRML 1.0, another language; save it as VRML97 or X3D";
    text.remove_prefix(std::min(text.size(), text.find('\n')));
    while (!text.empty() && (text[0] == '\n' || text[0] == '\r')) text.remove_prefix(1);
  }
  return "must begin with '#X3D V3.2 utf8' or '#VRML V2.0 utf8'";
}

// A recursive-descent parser. Which fields a node may have is not checked here.
class Reader {
 public:
  Reader(const std::string& text, const std::string& file) : tokens_(text, file) {
    if (const std::string fault = fault_of_header(text); !fault.empty()) tokens_.fail(1, fault);
  }

  X3dNode read() {
    X3dNode scene;
    scene.type = "Scene";
    while (tokens_.now().kind != Kind::kEnd)
      if (!statement(scene, 1)) scene.add("children", node(1));
    return scene;
  }

 private:
  using Kind = Token::Kind;

  // Takes statements that are not nodes: skips them, or adds a prototype to `node`. Returns false if
  // something else comes next.
  bool statement(X3dNode& node, int depth) {
    const Token& now = tokens_.now();
    if (now.kind != Kind::kWord) return false;
    if (now.text == "PROTO" || now.text == "EXTERNPROTO") {
      node.add("children", prototype(depth + 1));
      return true;
    }
    int words = 0;
    if (now.text == "PROFILE" || now.text == "COMPONENT") words = 2;
    if (now.text == "META") words = 3;
    if (now.text == "UNIT" || now.text == "ROUTE") words = 4;
    const bool may_rename = now.text == "EXPORT" || now.text == "IMPORT";
    if (may_rename) words = 2;
    for (int i = 0; i < words; ++i) tokens_.take();
    if (may_rename && is_word("AS"))
      for (int i = 0; i < 2; ++i) tokens_.take();
    return words > 0;
  }

  // PROTO Name [ interface ] { body }, or EXTERNPROTO Name [ interface ] "url".
  X3dNode prototype(int depth) {
    X3dNode made;
    const Token token = tokens_.take();
    check_limits(token.line, depth);
    const bool is_extern = token.text == "EXTERNPROTO";
    made.type = is_extern ? "ExternProtoDeclare" : "ProtoDeclare";
    made.line = token.line;
    made.def = word("a name after " + token.text).text;
    expect(Kind::kBegin, "the interface of " + made.def + " must begin with [");
    while (tokens_.now().kind != Kind::kFinish) interface_field(made, depth, !is_extern);
    tokens_.take();
    if (is_extern) {
      X3dNode url;
      value(url, "url", depth);
      made.values = std::move(url.values);
      return made;
    }
    expect(Kind::kOpen, "the body of " + made.def + " must begin with {");
    while (tokens_.now().kind != Kind::kClose) {
      if (tokens_.now().kind == Kind::kEnd) tokens_.fail(made.line, "PROTO " + made.def + " has no }");
      X3dNode inner;
      if (!statement(inner, depth)) inner.add("", node(depth + 1));
      for (X3dChild& child : inner.children) made.add("body", std::move(child.node));
    }
    tokens_.take();
    return made;
  }

  bool is_word(std::string_view text) const {
    return tokens_.now().kind == Kind::kWord && tokens_.now().text == text;
  }

  static bool holds_value(const std::string& access) {
    return access == "field" || access == "exposedField" || access == "initializeOnly" ||
           access == "inputOutput";
  }
  static bool is_event(const std::string& access) {
    return access == "eventIn" || access == "eventOut" || access == "inputOnly" || access == "outputOnly";
  }

  // exposedField SFVec3f center 0 0 0. Events, and all fields of EXTERNPROTO, have no default. In the body of
  // a prototype, IS and a name may follow.
  void interface_field(X3dNode& proto, int depth, bool has_defaults) {
    const Token access = word("a field of " + proto.def);
    X3dNode made;
    made.line = access.line;
    made.type = word("the type of a field of " + proto.def).text;
    made.def = word("the name of a field of " + proto.def).text;
    const bool holds = holds_value(access.text);
    if (!holds && !is_event(access.text))
      tokens_.fail(access.line, "'" + access.text + "' does not begin a field");
    if (is_word("IS"))
      for (int i = 0; i < 2; ++i) tokens_.take();
    else if (holds && has_defaults)
      value(made, "value", depth);
    proto.add("interface", std::move(made));
  }

  // A field that a node declares for itself, as scripts and shaders do. Only the nodes in it are kept: others
  // may USE them.
  void own_field(X3dNode& node, int depth) {
    const std::string access = tokens_.now().text;
    X3dNode declared;
    interface_field(declared, depth, true);
    for (X3dChild& field : declared.children)
      for (X3dChild& inner : field.node.children) node.add(access, std::move(inner.node));
  }

  void expect(Kind kind, const std::string& message) {
    if (tokens_.now().kind != kind) tokens_.fail(tokens_.now().line, message);
    tokens_.take();
  }

  void check_limits(int line, int depth) {
    if (depth > kMaxX3dDepth)
      tokens_.fail(line, "nodes are nested more than " + std::to_string(kMaxX3dDepth) + " deep");
    if (++count_ > kMaxX3dNodes)
      tokens_.fail(line, "has more than " + std::to_string(kMaxX3dNodes) + " nodes");
  }

  X3dNode node(int depth) {
    X3dNode made;
    Token token = word("a node");
    made.line = token.line;
    check_limits(token.line, depth);
    if (token.text == "USE") {
      made.use = word("a name after USE").text;
      return made;
    }
    if (token.text == "DEF") {
      token = word("a name after DEF");
      // Some programs write "DEF Transform {" for a node without a name.
      if (tokens_.now().kind != Kind::kOpen) {
        made.def = token.text;
        token = word("a node after DEF " + made.def);
      }
    }
    made.type = token.text;
    if (tokens_.now().kind != Kind::kOpen)
      tokens_.fail(tokens_.now().line, "'" + made.type + "' must be followed by {");
    tokens_.take();
    while (tokens_.now().kind != Kind::kClose) {
      if (tokens_.now().kind == Kind::kEnd) tokens_.fail(made.line, made.type + " has no }");
      if (!statement(made, depth)) field(made, depth);
    }
    tokens_.take();
    return made;
  }

  // Takes a word. If something else stands there, the error says that `what` is expected.
  Token word(const std::string& what) {
    if (tokens_.now().kind != Kind::kWord)
      tokens_.fail(
          tokens_.now().line,
          what + " is expected" + (tokens_.now().text.empty() ? "" : ", not '" + tokens_.now().text + "'"));
    return tokens_.take();
  }

  void field(X3dNode& node, int depth) {
    if (holds_value(tokens_.now().text) || is_event(tokens_.now().text)) return own_field(node, depth);
    const Token name = word("a field of " + node.type);
    if (tokens_.now().kind == Kind::kWord && tokens_.now().text == "IS") {
      tokens_.take();
      node.is[name.text] = word("a field of the prototype after IS").text;
      return;
    }
    value(node, name.text, depth);
  }

  void value(X3dNode& node, const std::string& name, int depth) {
    const Token& now = tokens_.now();
    if (now.kind == Kind::kText) {
      node.values[name] = tokens_.take().text;
    } else if (now.kind == Kind::kBegin) {
      list(node, name, depth);
    } else if (is_number_word(now)) {
      std::string& value = node.values[name];
      while (is_number_word(tokens_.now())) value += (value.empty() ? "" : " ") + tokens_.take().text;
    } else if (now.kind != Kind::kWord) {
      tokens_.fail(now.line,
                   "'" + name + "' of " + (node.def.empty() ? node.type : node.def) + " has no value");
    } else if (now.text == "TRUE" || now.text == "FALSE") {
      node.values[name] = tokens_.take().text == "TRUE" ? "true" : "false";
    } else if (now.text == "NULL") {
      tokens_.take();
    } else {
      node.add(name, this->node(depth + 1));
    }
  }

  // Reads [...]: numbers, texts or truth values into the field's value, nodes as children.
  void list(X3dNode& node, const std::string& name, int depth) {
    const int line = tokens_.take().line;
    std::string& value = node.values[name];
    bool has_nodes = false;
    while (tokens_.now().kind != Kind::kFinish) {
      const Token& now = tokens_.now();
      if (now.kind == Kind::kText) {
        value += (value.empty() ? "" : " ") + in_quotes(tokens_.take().text);
      } else if (is_number_word(now)) {
        value += (value.empty() ? "" : " ") + tokens_.take().text;
      } else if (now.kind == Kind::kWord && (now.text == "TRUE" || now.text == "FALSE")) {
        value += (value.empty() ? "" : " ") + std::string(tokens_.take().text == "TRUE" ? "true" : "false");
      } else if (now.kind == Kind::kWord) {
        node.add(name, this->node(depth + 1));
        has_nodes = true;
      } else {
        tokens_.fail(line, "the list '" + name + "' of " + node.type + " has no ]");
      }
    }
    tokens_.take();
    if (has_nodes) node.values.erase(name);
  }

  Tokens tokens_;
  std::size_t count_ = 0;
};

bool is_boolean(const std::string& value) {
  return value == "true" || value == "false";
}

std::string value_text(const std::string& field, const std::string& value) {
  if (is_text_field(field)) return in_quotes(value);
  if (is_texts_field(field) || is_many_field(field)) return "[ " + value + " ]";
  if (is_boolean(value)) return value == "true" ? "TRUE" : "FALSE";
  return value;
}

bool is_many_nodes(const std::string& field, const std::string& type) {
  return is_many_field(field) || (field == "geometry" && type == "RigidBody") ||
         (field == "value" && type == "MetadataSet");
}

void write_node(const X3dNode& node, const std::string& indent, std::string& text) {
  if (!node.use.empty()) {
    text += "USE " + node.use + "\n";
    return;
  }
  if (!node.def.empty()) text += "DEF " + node.def + " ";
  text += node.type + " {\n";
  const std::string inner = indent + "  ";
  for (const auto& [field, value] : node.values)
    text += inner + field + " " + value_text(field, value) + "\n";
  for (std::size_t i = 0; i < node.children.size(); ++i) {
    const auto& [field, child] = node.children[i];
    const bool many = is_many_nodes(field, node.type);
    const bool first = i == 0 || node.children[i - 1].field != field;
    const bool last = i + 1 == node.children.size() || node.children[i + 1].field != field;
    if (first) text += inner + field + (many ? " [\n" : " ");
    if (many) text += inner + "  ";
    write_node(child, many ? inner + "  " : inner, text);
    if (many && last) text += inner + "]\n";
  }
  text += indent + "}\n";
}

}  // namespace

X3dNode read_x3d_classic(const std::string& text, const std::string& file) {
  return Reader(text, file).read();
}

std::string write_x3d_classic(const X3dNode& scene, bool vrml97) {
  std::string text =
      vrml97 ? "#VRML V2.0 utf8\n" : "#X3D V3.2 utf8\nPROFILE Interchange\nCOMPONENT RigidBodyPhysics:2\n";
  for (const auto& [field, node] : scene.children) write_node(node, "", text);
  return text;
}

}  // namespace visum::scene
