#include "clients/bridges/finroc/administration.h"

namespace visum::finroc {
namespace {

enum Method : std::uint8_t {
  kGetAnnotation = 5,
  kGetCreateModuleActions = 6,
  kGetModuleLibraries = 7,
  kGetParameterInfo = 8,
  kIsExecuting = 9,
  kSetPortValue = 15,
  kNetworkConnect = 17,
};
constexpr std::uint8_t kExecutionNotControlled = 0;
constexpr std::int64_t kMostValueBytes = 1 << 20;

std::string a_text(const std::string& text) {
  return Writer().put_string(text).text();
}

std::string a_buffer(const std::string& bytes) {
  return Writer().put(static_cast<std::int64_t>(bytes.size())).put_bytes(bytes).text();
}

std::string set_port_value(Board& board, const std::string& peer, Reader& arguments) {
  const auto id = static_cast<ElementId>(arguments.take<std::uint32_t>() >> kStampBits);
  const auto size = arguments.take<std::int64_t>();
  if (arguments.failed() || size < 1 || size > kMostValueBytes) return "the value is broken";
  Reader in(arguments.take_bytes(static_cast<std::size_t>(size)));
  if (arguments.failed()) return "the value is broken";
  if (!board.is_living_port(id)) return "there is no such port any more";
  const Element element = board.elements()[id];  // a copy: writing may add elements
  if (element.access != Access::kWrite) return element.name + " is an output: nobody may write it";
  const auto encoding = static_cast<Encoding>(in.take<std::uint8_t>());
  const auto value = take_value(in, element.type, encoding);
  if (!value) return "the value is no " + element.type.name;
  return board.write(id, *value, peer);
}

}  // namespace

std::optional<std::string> call_administration(Board& board, const std::string& peer, std::uint8_t method,
                                               Reader& arguments) {
  switch (method) {
    case kGetAnnotation:
    case kGetCreateModuleActions:
    case kGetModuleLibraries:
      return a_buffer({});
    case kGetParameterInfo:
      return a_buffer(std::string(1, '\0'));
    case kIsExecuting:
      return Writer().put(kExecutionNotControlled).text();
    case kSetPortValue:
      return a_text(set_port_value(board, peer, arguments));
    case kNetworkConnect:
      return a_text("edges are made by the controllers, not here");
    default:
      return std::nullopt;
  }
}

}  // namespace visum::finroc
