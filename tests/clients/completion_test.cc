#include "clients/visum/common/completion.h"

#include <gmock/gmock.h>

namespace visum::cli {
namespace {

using ::testing::HasSubstr;

Shell shell() {
  return {
      {{"get", "read ports", {{"--json", "print JSON"}}}, {"run", "it's a run", {{"--junit", "a file"}}}}};
}

TEST(Completion, EveryShellKnowsVerbsAndOptions) {
  EXPECT_THAT(shell().bash(), HasSubstr("'get run'"));
  EXPECT_THAT(shell().bash(), HasSubstr("get) COMPREPLY=($(compgen -W '--json'"));
  EXPECT_THAT(shell().zsh(), HasSubstr("'get:read ports'"));
  EXPECT_THAT(shell().fish(), HasSubstr("-a get -d 'read ports'"));
  EXPECT_THAT(shell().fish(), HasSubstr("-l junit -d 'a file'"));
}

TEST(Completion, QuotesWhatAShellWouldRead) {
  EXPECT_THAT(shell().zsh(), HasSubstr(R"('run:it'\''s a run')"));
}

}  // namespace
}  // namespace visum::cli
