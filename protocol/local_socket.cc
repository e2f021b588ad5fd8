#include "protocol/local_socket.h"

#include <sys/random.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdlib>

namespace visum::protocol {
namespace {

constexpr std::size_t kMostWord = 64;  // characters; more would not fit into a name

}  // namespace

std::string local_socket_name(std::uint16_t port) {
  const char* word = std::getenv(kLocalVariable);
  if (word == nullptr || *word == '\0') return {};
  const std::string text = word;
  return text.size() > kMostWord ? std::string() : "visum-" + text + "-" + std::to_string(port);
}

// An abstract name begins with a zero byte and has no end but its size.
LocalAddress local_address(const std::string& name) {
  LocalAddress local;
  local.address.sun_family = AF_UNIX;
  const std::size_t length = std::min(name.size(), sizeof local.address.sun_path - 1);
  std::copy_n(name.data(), length, local.address.sun_path + 1);
  local.size = static_cast<unsigned>(offsetof(sockaddr_un, sun_path) + 1 + length);
  return local;
}

void share_local_sockets() {
  if (!local_socket_name(0).empty()) return;
  std::array<std::uint64_t, 2> random{};
  if (::getrandom(random.data(), sizeof random, 0) != sizeof random) return;  // then all use TCP
  const std::string word = std::to_string(random[0]) + std::to_string(random[1]);
  ::setenv(kLocalVariable, word.c_str(), 1);
}

}  // namespace visum::protocol
