// Robot models written in xacro, ROS's macro language: the user's own program `xacro` makes a URDF of them.
#pragma once

#include <filesystem>
#include <string>

#include "server/scene/reader_process.h"

namespace visum::scene {

// True if the text of a model holds macros. The extension .xacro alone does not count: the file may hold
// plain URDF, as a recording's copy does after it was expanded.
bool needs_xacro(const std::filesystem::path& file, const std::string& text);

// The program `xacro` in the absolute folders of PATH; empty if there is none.
std::filesystem::path find_xacro();

// The command that a user would type.
std::string xacro_command(const std::filesystem::path& file);

// Runs `xacro FILE` with our environment, without a shell, and returns what it prints. Throws ConfigError if
// it fails, takes too long, or prints too much.
std::string expand_xacro(const std::filesystem::path& program, const std::filesystem::path& file,
                         const ReaderBounds& bounds);

}  // namespace visum::scene
