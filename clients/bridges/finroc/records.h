// Element records: how a peer learns of one element of the board.
#pragma once

#include "clients/bridges/finroc/board.h"
#include "clients/bridges/finroc/bytes.h"
#include "clients/bridges/finroc/greeting.h"
#include "clients/bridges/finroc/type_tables.h"

namespace visum::finroc {

// True if a peer that wants this structure is told of the element.
bool is_shown(const Board& board, ElementId id, Structure wants);
void put_changed_port(Writer& out, const Board& board, ElementId id);
void put_record(Writer& out, const Board& board, ElementId id, Structure wants, TypesSent& types);

}  // namespace visum::finroc
