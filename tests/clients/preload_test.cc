// Libraries whose paths the dynamic loader cannot read.
#include "clients/visum/exec/preload.h"

#include <gtest/gtest.h>

#include "clients/visum/common/exit_code.h"
#include "clients/visum/common/temp_folder.h"

namespace visum::exec {
namespace {

namespace fs = std::filesystem;

TEST(Preload, ByALinkWhereThePathHoldsASpaceOrAColon) {
  const cli::TempFolder links;
  EXPECT_EQ(preloadable("/opt/lib/plain.so", links.path()), "/opt/lib/plain.so");
  for (const char* library : {"/my files/spaced.so", "/of:colons/parted.so"}) {
    const auto link = preloadable(library, links.path());
    EXPECT_EQ(link.parent_path(), links.path());
    EXPECT_EQ(fs::read_symlink(link), library);
  }
}

TEST(Preload, IsRefusedWhereALinkWouldNotHelp) {
  try {
    preloadable("/my files/library.so", "/tmp/my links");
    FAIL() << "taken";
  } catch (const cli::ExitError& error) {
    EXPECT_EQ(error.code(), cli::kFailed);
    EXPECT_NE(std::string(error.what()).find("/my files/library.so"), std::string::npos) << error.what();
    EXPECT_NE(std::string(error.what()).find("TMPDIR"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace visum::exec
