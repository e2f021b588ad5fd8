#include "protocol/config/shared_library.h"

#include <gtest/gtest.h>

#include <stdexcept>
#include <string>

namespace visum::config::testing {
namespace {

std::string refusal_of(const std::string& file, const char* name) {
  try {
    const SharedLibrary library(file, "the cosine", "libc6");
    double (*function)(double) = nullptr;
    library.find(name, function);
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "";
}

TEST(SharedLibrary, FindsFunctionsThatStayWhenItGoes) {
  double (*cosine)(double) = nullptr;
  SharedLibrary("libm.so.6", "the cosine", "libc6").find("cos", cosine);
  ASSERT_NE(cosine, nullptr);
  EXPECT_EQ(cosine(0.0), 1.0);
}

TEST(SharedLibrary, TellsWhatIsMissingAndWhatHelps) {
  const std::string file = refusal_of("libnothing.so.1", "cos");
  EXPECT_TRUE(file.starts_with("the cosine cannot be loaded: libnothing.so.1: ")) << file;
  EXPECT_TRUE(file.ends_with("; install libc6")) << file;
  const std::string function = refusal_of("libm.so.6", "no_such_function");
  EXPECT_TRUE(function.starts_with("the cosine cannot be loaded: ")) << function;
  EXPECT_NE(function.find("no_such_function"), std::string::npos) << function;
}

}  // namespace
}  // namespace visum::config::testing
