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

TEST(Completion, EveryShellOffersFilesAndParts) {
  EXPECT_THAT(shell().bash(), HasSubstr("complete -o default -F _visum visum"));
  EXPECT_THAT(shell().bash(), HasSubstr("|--tls-ca|--tls-cert|--tls-key)"));
  EXPECT_THAT(shell().zsh(), HasSubstr("|replay|rewind|export|mirror|exec) _files"));
  EXPECT_THAT(shell().fish(), HasSubstr("replay rewind export mirror exec' -F"));
  EXPECT_THAT(shell().fish(), HasSubstr("param-set fault faults' -a '(visum parts"));
}

TEST(Completion, QuotesWhatAShellWouldRead) {
  EXPECT_THAT(shell().zsh(), HasSubstr(R"('run:it'\''s a run')"));
}

}  // namespace
}  // namespace visum::cli
