// A part as others see it: its modules, groups and edges, and their values. Pure functions of the part.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "clients/mca/lower.h"
#include "protocol/module_messages.h"

namespace visum::mca {

class Part;

// The part's own group comes first, with an empty path.
protocol::AnnounceModules describe(Part& part, const std::vector<std::unique_ptr<Lower>>& lower,
                                   const std::string& address);
// In the order of describe().
protocol::ReportModules values_of(Part& part);
// The same with texts and blackboards as long as they may become.
protocol::ReportModules largest_values_of(Part& part);

// Finds a module by its path; null: there is none.
Module* find_module(Part& part, const std::string& path);

}  // namespace visum::mca
