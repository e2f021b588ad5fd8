// An authority and certificates that it signed, made anew by OpenSSL in a folder of their own: no private key
// stands in the tree.
#pragma once

#include <string>

#include "protocol/tls.h"
#include "tests/support/temp_files.h"

namespace visum::testing {

class Certificates {
 public:
  enum When { kValid, kExpired };

  Certificates();

  // For `name`, and for servers at 127.0.0.1, ::1 and localhost.
  protocol::TlsFiles files(const std::string& name, When when = kValid) const;
  // The same, signed by nobody else.
  protocol::TlsFiles self_signed(const std::string& name) const;

 private:
  test::TempFiles folder_;
  std::string authority_, authority_key_;
};

}  // namespace visum::testing
