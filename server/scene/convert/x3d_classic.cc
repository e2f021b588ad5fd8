// X3D's classic encoding, which is VRML97's: DEF NAME Type { field value ... }, # comments, commas as blanks.
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
  Tokens(std::string_view text, std::string file) : text_(text), file_(std::move(file)) { next(); }

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

// A recursive-descent parser. Which fields a node may have is not checked here.
class Reader {
 public:
  Reader(const std::string& text, const std::string& file) : tokens_(text, file) {
    if (!text.starts_with("#X3D V3.") && !text.starts_with("#VRML V2.0"))
      tokens_.fail(1, "must begin with '#X3D V3.2 utf8' or '#VRML V2.0 utf8'");
  }

  X3dNode read() {
    X3dNode scene;
    scene.type = "Scene";
    while (tokens_.now().kind != Kind::kEnd)
      if (!skip_statement()) scene.add("children", node(1));
    return scene;
  }

 private:
  using Kind = Token::Kind;

  // Skips statements that are not nodes. Returns false if the next thing is none of them.
  bool skip_statement() {
    const Token& now = tokens_.now();
    if (now.kind != Kind::kWord) return false;
    int words = 0;
    if (now.text == "PROFILE" || now.text == "COMPONENT" || now.text == "EXPORT") words = 2;
    if (now.text == "META") words = 3;
    if (now.text == "UNIT" || now.text == "ROUTE" || now.text == "IMPORT") words = 4;
    for (int i = 0; i < words; ++i) tokens_.take();
    return words > 0;
  }

  X3dNode node(int depth) {
    X3dNode made;
    Token token = word("a node");
    made.line = token.line;
    if (depth > kMaxX3dDepth)
      tokens_.fail(token.line, "nodes are nested more than " + std::to_string(kMaxX3dDepth) + " deep");
    if (++count_ > kMaxX3dNodes)
      tokens_.fail(token.line, "has more than " + std::to_string(kMaxX3dNodes) + " nodes");
    if (token.text == "USE") {
      made.use = word("a name after USE").text;
      return made;
    }
    if (token.text == "DEF") {
      made.def = word("a name after DEF").text;
      token = word("a node after DEF " + made.def);
    }
    made.type = token.text;
    for (const char* code : {"Script", "PROTO", "EXTERNPROTO", "Inline"})
      if (made.type == code) tokens_.fail(token.line, made.type + " is not read: write what it stands for");
    if (tokens_.now().kind != Kind::kOpen)
      tokens_.fail(tokens_.now().line, "'" + made.type + "' must be followed by {");
    tokens_.take();
    while (tokens_.now().kind != Kind::kClose) {
      if (tokens_.now().kind == Kind::kEnd) tokens_.fail(made.line, made.type + " has no }");
      if (!skip_statement()) field(made, depth);
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
    const Token name = word("a field of " + node.type);
    const Token& now = tokens_.now();
    if (now.kind == Kind::kText) {
      node.values[name.text] = tokens_.take().text;
    } else if (now.kind == Kind::kBegin) {
      list(node, name.text, depth);
    } else if (is_number_word(now)) {
      std::string& value = node.values[name.text];
      while (is_number_word(tokens_.now())) value += (value.empty() ? "" : " ") + tokens_.take().text;
    } else if (now.kind != Kind::kWord || now.text == "IS") {
      tokens_.fail(now.line, "'" + name.text + "' of " + node.type + " has no value");
    } else if (now.text == "TRUE" || now.text == "FALSE") {
      node.values[name.text] = tokens_.take().text == "TRUE" ? "true" : "false";
    } else if (now.text == "NULL") {
      tokens_.take();
    } else {
      node.add(name.text, this->node(depth + 1));
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
