// A certificate authority and certificates that it signed, made anew by OpenSSL in a temporary folder. So no
// private key is kept in the repository.
#pragma once

#include <string>

#include "protocol/tls.h"
#include "tests/support/temp_files.h"

namespace visum::testing {

class Certificates {
 public:
  enum When { kValid, kExpired };

  Certificates();

  // A certificate for `name`, valid for servers at 127.0.0.1, ::1 and localhost.
  protocol::TlsFiles files(const std::string& name, When when = kValid) const;
  // As files(), but signed by itself and by no authority.
  protocol::TlsFiles self_signed(const std::string& name) const;

 private:
  test::TempFiles folder_;
  std::string authority_, authority_key_;
};

}  // namespace visum::testing
