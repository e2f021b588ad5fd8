// Models with macros, by a program of our own that is called xacro.
#include "server/scene/xacro.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <cstdlib>

#include "protocol/config/config.h"
#include "protocol/config/read_file.h"
#include "server/scene/scene.h"
#include "tests/support/temp_files.h"

namespace visum::scene {
namespace {

using testing::Contains;
using testing::HasSubstr;

const std::string kMacros =
    "<robot name='r' xmlns:xacro='http://ros.org/wiki/xacro'><link name='base'/><xacro:arm/></robot>";

class Xacro : public testing::Test {
 protected:
  Xacro() : before_(std::getenv("PATH")) { set_path("/nowhere"); }
  ~Xacro() override { ::setenv("PATH", before_.c_str(), 1); }

  static void set_path(const std::string& path) { ::setenv("PATH", path.c_str(), 1); }
  // Puts a program named xacro into PATH.
  void install(const std::string& script) {
    const auto program = files.write("bin/xacro", "#!/bin/sh\n" + script + "\n");
    ::chmod(program.c_str(), 0755);
    set_path("relative:" + program.parent_path().string() + ":/usr/bin:/bin");
  }
  // Prints the file with a link in place of the macro.
  void install_working() { install("exec sed \"s/<xacro:arm\\/>/<link name='arm'\\/>/\" \"$1\""); }

  std::string error_of(const std::filesystem::path& file) {
    return files.error_of([&] { load_scene(file); });
  }

  test::TempFiles files;

 private:
  const std::string before_;
};

const std::string kFixedArm =
    "<robot name='r' xmlns:xacro='x'><link name='base'/><xacro:arm/><joint name='j' type='fixed'>"
    "<parent link='base'/><child link='arm'/></joint></robot>";

TEST_F(Xacro, ABareFileIsExpanded) {
  install_working();
  const Scene scene = load_scene(files.write("my arm; x.urdf.xacro", kFixedArm));
  EXPECT_EQ(scene.world.bodies.at(0).name, "my_arm__x/base");
  EXPECT_THAT(scene.losses, Contains(HasSubstr("xacro has expanded it")));
}

TEST_F(Xacro, AModelOfASceneIsExpanded) {
  install_working();
  files.write("r.xacro", kFixedArm);
  const Scene scene = load_scene(files.write("s.yaml", "visum: 1\nmodels: [{name: r, file: r.xacro}]\n"));
  EXPECT_EQ(scene.world.bodies.size(), 1u);
}

TEST_F(Xacro, ARecordingKeepsWhatItMade) {
  install_working();
  const auto file = files.write("r.xacro", kFixedArm);
  config::Files noted;
  {
    config::FilesNoted notes;
    load_scene(file);
    noted = notes.files;
  }
  set_path("/nowhere");
  const config::FilesGiven given(noted);
  EXPECT_EQ(load_scene(file).world.bodies.at(0).name, "r/base");
}

TEST_F(Xacro, WithoutTheProgramTheCommandIsTold) {
  EXPECT_EQ(
      error_of(files.write("r.urdf.xacro", kMacros)),
      "r.urdf.xacro: holds macros of xacro, and there is no program 'xacro' in PATH; where there is one, "
      "run: xacro r.urdf.xacro -o r.urdf");
  const Scene plain = load_scene(files.write("r.urdf", kMacros));
  EXPECT_THAT(plain.losses, Contains(HasSubstr("its macros of xacro are not read")));
  EXPECT_THAT(plain.losses, Contains(HasSubstr("r.urdf -o ")));
  EXPECT_THAT(plain.losses, Contains(HasSubstr("r.plain.urdf")));
}

TEST_F(Xacro, WithoutMacrosTheProgramIsNotNeeded) {
  EXPECT_EQ(
      load_scene(files.write("r.xacro", "<robot name='r'><link name='a'/></robot>")).world.bodies.size(), 2u);
}

TEST_F(Xacro, ItsFailureIsTheError) {
  install("echo 'warning: no rosgraph' >&2; echo 'error: Undefined substitution argument ip' >&2; exit 2");
  EXPECT_EQ(error_of(files.write("r.xacro", kMacros)),
            "r.xacro: 'xacro' failed: error: Undefined substitution argument ip");
}

TEST_F(Xacro, IsBoundedInTimeAndOutput) {
  using std::chrono::milliseconds;
  const auto file = files.write("r.xacro", kMacros);
  install("exec sleep 600");
  EXPECT_THROW(expand_xacro(find_xacro(), file, {milliseconds(50), 1u << 20}), config::ConfigError);
  install("exec yes");
  const std::string fault = files.error_of([&] {
    expand_xacro(find_xacro(), file, {milliseconds(600'000), 1u << 20, "URDF"});
  });
  EXPECT_THAT(fault, HasSubstr("more than 1 MiB of URDF"));
}

}  // namespace
}  // namespace visum::scene
