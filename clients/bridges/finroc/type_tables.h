// A type is a number on the wire. Each side of a connection numbers the types that it names, and describes a
// type before it uses its number for the first time.
#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "clients/bridges/finroc/bytes.h"
#include "clients/bridges/finroc/values.h"

namespace visum::finroc {

// The types that we name to one peer.
class TypesSent {
 public:
  void put(Writer& out, const Type& type);

 private:
  std::map<std::string, std::int16_t> numbers_;  // by name
};

// The types that a peer names to us.
class TypesHeard {
 public:
  // Reads one reference, with the descriptions before it. Returns the type's name; empty if it was never
  // described. Leaves `in` failed if the bytes are no reference, or the peer describes too many types.
  std::string take(Reader& in);

 private:
  void take_descriptions(Reader& in);

  std::map<std::int16_t, std::string> names_;
  bool interval_seen_ = false;
};

}  // namespace visum::finroc
