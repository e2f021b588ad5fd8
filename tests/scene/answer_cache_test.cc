// Answers that are kept: found again, and never where they may be another's.
#include "server/scene/answer_cache.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <ctime>
#include <thread>

#include "server/scene/build_id.h"
#include "tests/support/temp_files.h"

namespace visum::scene {
namespace {

namespace fs = std::filesystem;
using test::TempFiles;

const fs::path kBin = VISUM_BIN_DIR;

class Answers : public testing::Test {
 protected:
  // As if the code had been there for long.
  void keep(const AnswerCache& cache, const std::string& input, const std::string& answer) const {
    cache.keep("reader", input, answer, {code_}, std::time(nullptr) + 60);
  }
  fs::path only_entry() const {
    EXPECT_EQ(std::distance(fs::directory_iterator(folder_), fs::directory_iterator()), 1);
    return fs::directory_iterator(folder_)->path();
  }
  TempFiles files_;
  const fs::path folder_ = files_.folder() / "of/visum";
  const fs::path code_ = [this] {
    fs::copy_file(kBin / "visum-mesh", files_.folder() / "code");
    return files_.folder() / "code";
  }();
  const AnswerCache cache_{folder_};
};

TEST_F(Answers, AreFoundAgain) {
  EXPECT_EQ(cache_.find("reader", "input"), std::nullopt);
  const std::string answer("two\nlines\0and more\n\n", 20);
  keep(cache_, "input", answer);
  keep(cache_, "other input", "");
  EXPECT_EQ(cache_.find("reader", "input"), answer);
  EXPECT_EQ(AnswerCache(folder_).find("reader", "other input"), "") << "by another process, too";
  EXPECT_EQ(cache_.find("reader", "inpu"), std::nullopt);
  EXPECT_EQ(cache_.find("other reader", "input"), std::nullopt);
  keep(cache_, "input", "new");
  EXPECT_EQ(cache_.find("reader", "input"), "new");
}

TEST_F(Answers, AreForThisUserOnly) {
  keep(cache_, "input", "answer");
  struct stat status {};
  ASSERT_EQ(::stat(folder_.c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 0777, 0700u);
  ASSERT_EQ(::stat(only_entry().c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 0777, 0600u);
}

TEST_F(Answers, OfAnotherBuildAreNone) {
  keep(cache_, "input", "answer");
  fs::remove(code_);
  EXPECT_EQ(cache_.find("reader", "input"), std::nullopt);
  fs::copy_file(kBin / "visum", code_);
  EXPECT_EQ(cache_.find("reader", "input"), std::nullopt);
  keep(cache_, "input", "another answer");
  EXPECT_EQ(cache_.find("reader", "input"), "another answer");
}

TEST_F(Answers, OfCodeThatMayHaveChangedMeanwhileAreNotKept) {
  cache_.keep("reader", "input", "answer", {code_}, std::time(nullptr));
  EXPECT_EQ(cache_.find("reader", "input"), std::nullopt) << "the code was copied a moment ago";
  cache_.keep("reader", "input", "answer", {}, std::time(nullptr) + 60);
  EXPECT_EQ(cache_.find("reader", "input"), std::nullopt) << "of unknown code";
  cache_.keep("reader", "input", "answer", {code_, files_.write("script", "#!/bin/sh\n")},
              std::time(nullptr) + 60);
  EXPECT_EQ(cache_.find("reader", "input"), std::nullopt) << "a script has no build id";
  EXPECT_FALSE(fs::exists(folder_));
}

TEST_F(Answers, ThatAreNotWholeAreNone) {
  keep(cache_, "input", "answer");
  const fs::path entry = only_entry();
  const std::string good = files_.read(fs::relative(entry, files_.folder()));
  for (std::size_t at = 0; at < good.size(); ++at) {
    std::string bad = good;
    bad[at] ^= 1;
    files_.write(fs::relative(entry, files_.folder()), bad);
    EXPECT_EQ(cache_.find("reader", "input"), std::nullopt) << "byte " << at;
    files_.write(fs::relative(entry, files_.folder()), good.substr(0, at));
    EXPECT_EQ(cache_.find("reader", "input"), std::nullopt) << "the first " << at << " bytes";
  }
  keep(cache_, "input", "answer");
  EXPECT_EQ(cache_.find("reader", "input"), "answer");
}

TEST_F(Answers, AreKeptByManyAtOnce) {
  const std::string answer(100'000, 'x');
  {
    std::vector<std::jthread> threads;
    for (int i = 0; i < 4; ++i)
      threads.emplace_back([&, i] {
        for (int k = 0; k < 50; ++k) {
          keep(cache_, "all", answer);
          keep(cache_, std::to_string(k * 4 + i), answer);
          EXPECT_EQ(cache_.find("reader", "all"), answer);
        }
      });
  }
  for (int k = 0; k < 200; ++k) EXPECT_EQ(cache_.find("reader", std::to_string(k)), answer);
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_), fs::directory_iterator()), 201)
      << "no unfinished file is left";
}

TEST_F(Answers, ThatCannotBeKeptDoNoHarm) {
  files_.write("file", "");
  for (const fs::path& folder : {fs::path(), files_.folder() / "file/in", fs::path("/proc/none")}) {
    const AnswerCache cache(folder);
    keep(cache, "input", "answer");
    EXPECT_EQ(cache.find("reader", "input"), std::nullopt) << folder;
  }
}

TEST_F(Answers, MakeRoomForNewOnes) {
  const AnswerCache small(folder_, 100'000);
  const auto age = [&](const std::string& name, int hours) {
    fs::last_write_time(folder_ / name, fs::file_time_type::clock::now() - std::chrono::hours(hours));
  };
  for (int i = 0; i < 12; ++i) keep(cache_, std::to_string(i), std::string(10'000, 'x'));
  int hours = 100;
  std::vector<std::string> oldest_first;
  for (const auto& entry : fs::directory_iterator(folder_)) {
    oldest_first.push_back(entry.path().filename());
    age(oldest_first.back(), hours--);
  }
  fs::create_directory(folder_ / "a folder.answer");
  for (const char* name : {"x.answer.newABCDEF", "y.answer.newABCDEF", "notes.txt"})
    files_.write("of/visum/" + std::string(name), "x");
  age("x.answer.newABCDEF", 2);
  age("notes.txt", 1000);
  small.make_room();
  std::size_t left = 0;
  for (const std::string& name : oldest_first) left += fs::exists(folder_ / name);
  EXPECT_EQ(left, 7u) << "75,000 bytes, each entry a little above 10,000";
  for (std::size_t i = 0; i < oldest_first.size(); ++i)
    EXPECT_EQ(fs::exists(folder_ / oldest_first[i]), i >= 5) << "the oldest go";
  EXPECT_FALSE(fs::exists(folder_ / "x.answer.newABCDEF")) << "its writer is gone";
  EXPECT_TRUE(fs::exists(folder_ / "y.answer.newABCDEF")) << "it may still be written";
  EXPECT_TRUE(fs::exists(folder_ / "notes.txt")) << "not ours";
  EXPECT_TRUE(fs::exists(folder_ / "a folder.answer"));
}

TEST_F(Answers, ThatAreUsedStay) {
  keep(cache_, "input", "answer");
  const fs::path entry = only_entry();
  const auto long_ago = fs::file_time_type::clock::now() - std::chrono::hours(48);
  fs::last_write_time(entry, long_ago);
  EXPECT_EQ(cache_.find("reader", "input"), "answer");
  EXPECT_GT(fs::last_write_time(entry), long_ago + std::chrono::hours(47));
}

TEST(CacheFolder, IsTheFirstThatTheEnvironmentNames) {
  const auto with = [](const char* systemd, const char* xdg, const char* home) {
    for (const auto& [name, value] :
         {std::pair{"CACHE_DIRECTORY", systemd}, {"XDG_CACHE_HOME", xdg}, {"HOME", home}})
      value ? ::setenv(name, value, 1) : ::unsetenv(name);
    return usual_cache_folder().lexically_normal();
  };
  const char* home = std::getenv("HOME");
  const std::string before = home ? home : "";
  EXPECT_EQ(with("/var/cache/visum", "/x", "/h"), "/var/cache/visum/");
  EXPECT_EQ(with(nullptr, "/x", "/h"), "/x/visum");
  EXPECT_EQ(with("", "x", "/h"), "/h/.cache/visum") << "relative folders do not count";
  EXPECT_EQ(with(nullptr, nullptr, nullptr), "");
  ::setenv("HOME", before.c_str(), 1);
}

TEST(BuildId, OfAFileThatHasNoneIsEmpty) {
  const TempFiles files;
  EXPECT_EQ(build_id_of(kBin / "visum-mesh").size(), 40u) << "SHA-1";
  EXPECT_NE(build_id_of(kBin / "visum-mesh"), build_id_of(kBin / "visum"));
  EXPECT_EQ(build_id_of("/nowhere"), "");
  EXPECT_EQ(build_id_of(files.folder()), "");
  EXPECT_EQ(build_id_of(files.write("empty", "")), "");
  EXPECT_EQ(build_id_of(files.write("text", std::string(1000, 'x'))), "");
  std::ifstream program(kBin / "visum-mesh", std::ios::binary);
  std::string begin(4096, '\0');
  program.read(begin.data(), 4096);
  for (std::size_t bytes = 0; bytes < 4096; bytes += 7)
    build_id_of(files.write("cut", begin.substr(0, bytes)));  // ends
}

}  // namespace
}  // namespace visum::scene
