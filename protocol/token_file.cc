#include "protocol/token_file.h"

#include <fstream>
#include <sstream>
#include <stdexcept>

namespace visum::protocol {
namespace {

Role role_named(const std::string& word) {
  for (const Role role : {Role::kObserver, Role::kController, Role::kAdmin})
    if (word == to_string(role)) return role;
  return Role::kUnspecified;
}

// True if a token for `offered` suits a client that wants `wanted` better than a token for `best` does.
bool is_better(Role offered, Role best, Role wanted) {
  if (best < wanted) return offered > best;
  return offered >= wanted && offered < best;
}

}  // namespace

std::string read_token_file(const std::string& file, Role role) {
  if (file.empty()) return {};
  std::ifstream in(file);
  if (!in) throw std::runtime_error(file + ": the token file cannot be read");
  std::string best;
  Role best_role = Role::kUnspecified;
  for (std::string line; std::getline(in, line);) {
    std::istringstream words(line.substr(0, line.find('#')));
    std::string first, second;
    if (!(words >> first)) continue;
    if (!(words >> second)) return first;
    if (second.starts_with("CN=")) continue;  // grants a role to a certificate, holds no token
    if (is_better(role_named(first), best_role, role)) {
      best = second;
      best_role = role_named(first);
    }
  }
  if (best.empty()) throw std::runtime_error(file + ": the token file holds no token");
  return best;
}

}  // namespace visum::protocol
