// The calls of Finroc's administration interface, by which finstruct looks around and writes values.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "clients/bridges/finroc/board.h"
#include "clients/bridges/finroc/bytes.h"

namespace visum::finroc {

// Carries out a call of a peer. Returns the bytes of its result; nothing for a call that the bridge does not
// serve.
std::optional<std::string> call_administration(Board& board, const std::string& peer, std::uint8_t method,
                                               Reader& arguments);

}  // namespace visum::finroc
