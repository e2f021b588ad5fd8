// Where plug-ins may come from, and the texts of refusals.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "protocol/plugin/library.h"
#include "tests/plugin/plugged_scene.h"

namespace visum {
namespace {

namespace fs = std::filesystem;
using test::error_of_scene;

std::string refusal_of(const std::string& name, const std::vector<fs::path>& folders) {
  try {
    plugin::open_library(name, folders);
  } catch (const plugin::Error& error) {
    return error.what();
  }
  return "none";
}

const std::string kFolder = fs::canonical(VISUM_TEST_PLUGINS).string();

TEST(PluginLibrary, IsFoundByItsNameAlone) {
  EXPECT_EQ(plugin::open_library("kinds", {kFolder}).file.string(), kFolder + "/kinds.so");
  EXPECT_EQ(refusal_of("kinds", {}),
            "there is no plug-in 'kinds'; no folder of plug-ins is known: name one by --plugins");
  EXPECT_EQ(refusal_of("kind", {kFolder}), "there is no plug-in 'kind'; looked for kind.so in " + kFolder);
  for (const char* way : {"../kinds", "/tmp/kinds", "kinds.so", "", ".", "a b", "a;b"})
    EXPECT_EQ(refusal_of(way, {kFolder}),
              "a plug-in's name has 1 to 64 letters, digits, _ and -, and no folder or ending")
        << way;
}

TEST(PluginLibrary, MustNotLeadOutOfItsFolder) {
  const test::TempFiles files;
  fs::create_symlink(kFolder + "/kinds.so", files.folder() / "kinds.so");
  EXPECT_EQ(refusal_of("kinds", {files.folder()}),
            "'" + (files.folder() / "kinds.so").string() + "' leads out of its folder");
}

TEST(PluginLibrary, MustNotBeWritableByAnybody) {
  const test::TempFiles files;
  const auto file = files.folder() / "kinds.so";
  fs::copy_file(kFolder + "/kinds.so", file);
  fs::permissions(file, fs::perms::others_write, fs::perm_options::add);
  EXPECT_EQ(refusal_of("kinds", {files.folder()}),
            "anybody may write to '" + file.string() + "', so nothing is loaded from there");
  // A folder is refused if anybody may put files into it, even if they may not remove the files of others
  // (/tmp).
  fs::permissions(file, fs::perms::others_write, fs::perm_options::remove);
  fs::permissions(files.folder(), fs::perms::others_write | fs::perms::sticky_bit, fs::perm_options::add);
  EXPECT_EQ(refusal_of("kinds", {files.folder()}),
            "anybody may write to '" + files.folder().string() + "', so nothing is loaded from there");
}

TEST(PluginLibrary, SaysWhatIsWrongWithAFile) {
  EXPECT_EQ(refusal_of("stray", {kFolder}),
            "'" + kFolder + "/stray.so' is no plug-in: it has no visum_plugin()");
  EXPECT_EQ(refusal_of("old", {kFolder}),
            "'" + kFolder + "/old.so' was built for version 0 of plugin.h, this program has version " +
                std::to_string(plugin::kAbi));
  EXPECT_EQ(refusal_of("foreign", {kFolder}),
            "'" + kFolder + "/foreign.so' was built with libc++, this program with libstdc++");
  const test::TempFiles files;
  files.write("text.so", "I am no library");
  EXPECT_NE(refusal_of("text", {files.folder()}).find("cannot be loaded: "), std::string::npos);
  fs::create_directory(files.folder() / "folder.so");
  EXPECT_NE(refusal_of("folder", {files.folder()}).find("is not a regular file"), std::string::npos);
}

TEST(PluginScene, NamesThePlaceOfWhatIsWrong) {
  EXPECT_EQ(error_of_scene("plugins: [thief]"),
            "s.yaml:2: plugins[0]: brings a kind 'imu', but a built-in kind has that name");
  EXPECT_EQ(error_of_scene("agents: [{name: a, kind: stepper}]"),
            "s.yaml:2: agents[0].kind: no plug-in of this scene has agents; name one under 'plugins'");
  const std::string with = "plugins: [kinds]\n";
  EXPECT_EQ(error_of_scene(with + "agents: [{name: a, kind: steper}]"),
            "s.yaml:3: agents[0].kind: must be one of stepper, culprit, watcher, onlooker, is 'steper'; did "
            "you mean "
            "'stepper'?");
  EXPECT_EQ(error_of_scene(with + "agents: [{name: a, kind: stepper, step: 0.1}]"),
            "s.yaml:3: agents[0]: stepper: needs a part as 'arm' under 'parts'");
  EXPECT_EQ(error_of_scene(with + "agents: [{name: a, kind: stepper, parts: {arm: arn}}]"),
            "s.yaml:3: agents[0].parts.arm: must be one of , is 'arn'");
  EXPECT_EQ(error_of_scene(with + "agents: [{name: a, kind: stepper, step: 2}]"),
            "s.yaml:3: agents[0].step: must be between -1 and 1, is 2");
  EXPECT_EQ(error_of_scene(with + "agents: [{name: a, kind: stepper, period_ms: 0.5, step: 0}]"),
            "s.yaml:3: agents[0].period_ms: must be at least a tick");
  EXPECT_EQ(
      error_of_scene(with + "agents: [{name: a, kind: stepper, step: 0}, {name: a, kind: stepper, step: 0}]"),
      "s.yaml:3: agents[1]: there is already a part 'a' (s.yaml:3)");
  EXPECT_EQ(
      error_of_scene(with +
                     "bodies: [{name: b, fixed: true}]\nsensors: [{name: s, kind: tilt, body: b, tilt: 1}]"),
      "s.yaml:4: sensors[0]: unknown key 'tilt'");
}

TEST(PluginScene, APartHasOneAgentThatCommandsItAtMost) {
  const auto both = [] {
    cycle::Simulation(test::scene_with_arm(
        "plugins: [kinds]\nagents:\n- {name: a, kind: stepper, step: 0, parts: {arm: arm}}\n"
        "- {name: b, kind: stepper, step: 0, parts: {arm: arm}}\n"));
  };
  EXPECT_THAT(both, testing::ThrowsMessage<config::ConfigError>(testing::HasSubstr(
                        "agents[1]: stepper: part 'arm' is commanded by agent 'a' already")));
}

TEST(PluginScene, WhatAnAgentThrowsWhenItIsMadeIsWrongWithTheScene) {
  const auto make = [] {
    cycle::Simulation(test::scene_with_arm(
        "plugins: [kinds]\nagents:\n- {name: a, kind: culprit, does: throws at once, parts: {arm: arm}}\n"));
  };
  EXPECT_THAT(make, testing::ThrowsMessage<config::ConfigError>(
                        testing::HasSubstr("s.yaml:5: agents[0]: culprit: no mood today")));
}

}  // namespace
}  // namespace visum
