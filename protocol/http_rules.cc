#include "protocol/http_rules.h"

#include <algorithm>
#include <utility>

namespace visum::protocol {
namespace {

bool contains(const std::vector<std::string>& list, std::string_view value) {
  return std::find(list.begin(), list.end(), value) != list.end();
}

std::string in_lower_case(std::string text) {
  for (char& c : text)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return text;
}

// The position of the port in "lab:8080". Colons within the brackets of an IPv6 address begin no port.
std::size_t port_of(const std::string& host) {
  const auto bracket = host.rfind(']');
  return host.find(':', bracket == std::string::npos ? 0 : bracket);
}

// An address as a Host field has it: IPv6 in brackets.
std::string in_host_form(const std::string& address) {
  return address.find(':') == std::string::npos ? address : "[" + address + "]";
}

HttpVerdict judge_session(const HttpHead& head) {
  if (head.method != "GET" || !head.is_websocket)
    return {426, "a session needs a complete WebSocket handshake, version 13"};
  if (head.origins.empty()) return {403, "a session needs an Origin"};
  if (!contains(head.subprotocols, kWebSocketProtocol))
    return {400, "a session needs the subprotocol " + std::string(kWebSocketProtocol)};
  return {101, {}};
}

}  // namespace

HttpRules::HttpRules(std::uint16_t port, std::vector<std::string> hosts, bool https)
    : scheme_(https ? "https://" : "http://"),
      port_suffix_(":" + std::to_string(port)),
      default_suffix_(https ? ":443" : ":80"),
      hosts_(std::move(hosts)) {
  for (std::string& host : hosts_) {
    if (port_of(host) == std::string::npos) host += port_suffix_;  // a name without a port means ours
    host = in_one_form(host);
  }
}

std::string HttpRules::in_one_form(const std::string& host) const {
  auto form = in_lower_case(host);
  if (const auto port = port_of(form); port != std::string::npos && form.substr(port) == default_suffix_)
    form.resize(port);
  return form;
}

bool HttpRules::knows_host(const std::string& host, const std::string& local_address) const {
  const auto form = in_one_form(host);
  for (const std::string& name : {std::string("localhost"), std::string("127.0.0.1"), std::string("[::1]"),
                                  in_host_form(local_address)})
    if (form == in_one_form(name + port_suffix_)) return true;
  return contains(hosts_, form);
}

bool HttpRules::is_origin_of(const std::string& origin, const std::string& host) const {
  return origin.starts_with(scheme_) && in_one_form(origin.substr(scheme_.size())) == in_one_form(host);
}

HttpVerdict HttpRules::judge(const HttpHead& head) const {
  if (head.hosts.size() != 1 || !knows_host(head.hosts[0], head.local_address))
    return {421, "this host is not served here"};
  if (head.origins.size() > 1 || (head.origins.size() == 1 && !is_origin_of(head.origins[0], head.hosts[0])))
    return {403, "requests from other origins are not served"};
  if (head.has_body) return {413, "requests with a body are not served"};
  const std::string path = path_of(head.target);
  if (path.empty()) return {400, "this is not a path"};
  if (path == kWebSocketPath) return judge_session(head);
  if (head.wants_upgrade) return {400, "only " + std::string(kWebSocketPath) + " is upgraded"};
  if (head.method != "GET" && head.method != "HEAD") return {405, "only GET and HEAD are served"};
  return {200, {}};
}

std::string path_of(std::string_view target) {
  const std::string path(target.substr(0, target.find('?')));
  const auto is_bad = [](unsigned char c) { return c <= 0x20 || c >= 0x7f || c == '\\' || c == '#'; };
  if (path.empty() || path[0] != '/' || path.find("//") != std::string::npos ||
      path.find("..") != std::string::npos || std::any_of(path.begin(), path.end(), is_bad))
    return {};
  return path;
}

}  // namespace visum::protocol
