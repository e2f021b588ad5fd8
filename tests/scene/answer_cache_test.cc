// Answers that are kept: found again, and never where they may be another's.
#include "server/scene/answer_cache.h"

#include <elf.h>
#include <gtest/gtest.h>
#include <link.h>
#include <sys/stat.h>
#include <unistd.h>

#include <bit>
#include <cstring>
#include <map>
#include <thread>

#include "server/scene/build_id.h"
#include "tests/support/temp_files.h"

namespace visum::scene {
namespace {

namespace fs = std::filesystem;
using test::TempFiles;

const fs::path kBin = VISUM_BIN_DIR;
const fs::path kOther = kBin / "scene_test";  // a program of another build than visum-mesh

class Answers : public testing::Test {
 protected:
  std::vector<CodeFile> code() const {
    return {{build_id_of(reader_), reader_}, {build_id_of(library_), library_}};
  }
  void keep(const AnswerCache& cache, const std::string& input, const std::string& answer) const {
    cache.keep(cache.ask(reader_, input), answer, code());
  }
  std::optional<std::string> find(const std::string& input) const {
    return cache_.find(cache_.ask(reader_, input));
  }
  fs::path only_entry() const {
    EXPECT_EQ(std::distance(fs::directory_iterator(folder_), fs::directory_iterator()), 1);
    return fs::directory_iterator(folder_)->path();
  }
  TempFiles files_;
  const fs::path folder_ = files_.folder() / "of/visum";
  const fs::path library_ = [this] {
    fs::copy_file(kBin / "visum-mesh", files_.folder() / "library");
    return files_.folder() / "library";
  }();
  const fs::path reader_ = fs::canonical(kBin / "visum-mesh");
  const AnswerCache cache_{folder_};
};

TEST_F(Answers, AreFoundAgain) {
  EXPECT_EQ(find("input"), std::nullopt);
  const std::string answer("two\nlines\0and more\n\n", 20);
  keep(cache_, "input", answer);
  keep(cache_, "other input", "");
  EXPECT_EQ(find("input"), answer);
  const AnswerCache other_process(folder_);
  EXPECT_EQ(other_process.find(other_process.ask(reader_, "other input")), "");
  EXPECT_EQ(find("inpu"), std::nullopt);
  EXPECT_EQ(cache_.find(cache_.ask(kOther, "input")), std::nullopt);
  keep(cache_, "input", "new");
  EXPECT_EQ(find("input"), "new");
}

TEST_F(Answers, UnderAnotherNameAreNone) {
  keep(cache_, "input", "answer");
  const auto other = cache_.ask(reader_, "inpux"), longer = cache_.ask(reader_, "input ");
  for (const auto& question : {other, longer}) {
    fs::copy_file(cache_.ask(reader_, "input").entry, question.entry);
    EXPECT_EQ(cache_.find(question), std::nullopt) << "as if their hashes were equal";
  }
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
  const auto old = code();
  fs::remove(library_);
  EXPECT_EQ(find("input"), std::nullopt);
  fs::copy_file(kOther, library_);
  EXPECT_EQ(find("input"), std::nullopt);
  cache_.keep(cache_.ask(reader_, "second"), "of the old one", old);
  EXPECT_EQ(find("second"), std::nullopt) << "it was replaced while the reader ran";
  keep(cache_, "input", "another answer");
  EXPECT_EQ(find("input"), "another answer");
}

TEST_F(Answers, OfAReaderThatWasReplacedAreNone) {
  const fs::path link = files_.folder() / "reader";
  const auto keep_of = [&](const fs::path& program, const std::string& answer) {
    cache_.keep(cache_.ask(link, "input"), answer, {{build_id_of(program), program}});
  };
  const auto answer = [&] { return cache_.find(cache_.ask(link, "input")); };
  keep_of(reader_, "answer");
  EXPECT_EQ(answer(), std::nullopt) << "there is none";
  fs::create_symlink(reader_, link);
  keep_of(reader_, "answer");
  EXPECT_EQ(answer(), "answer");
  fs::remove(link);
  fs::create_symlink(kOther, link);
  EXPECT_EQ(answer(), std::nullopt) << "the old one is still there";
  fs::remove(link);
  fs::copy_file(kOther, link);
  keep_of(fs::canonical(link), "its answer");
  EXPECT_EQ(answer(), "its answer");
  fs::remove(link);
  files_.write("reader", "#!/bin/sh\n");
  keep_of(reader_, "a script's");
  EXPECT_EQ(answer(), std::nullopt) << "a script has no build id";
}

TEST_F(Answers, OfUnknownCodeAreNotKept) {
  const auto question = cache_.ask(reader_, "input");
  const CodeFile reader{build_id_of(reader_), reader_}, library{build_id_of(library_), library_};
  const auto is_kept = [&](const std::vector<CodeFile>& code) {
    cache_.keep(question, "answer", code);
    return cache_.find(question).has_value();
  };
  EXPECT_FALSE(is_kept({}));
  EXPECT_FALSE(is_kept({library})) << "it does not name the reader";
  EXPECT_FALSE(is_kept({reader, {"", library_}})) << "no build id";
  EXPECT_FALSE(is_kept({reader, {"00", library_}}));
  EXPECT_FALSE(is_kept(std::vector<CodeFile>(AnswerCache::kMaxCode + 1, reader)));
  EXPECT_TRUE(is_kept(std::vector<CodeFile>(AnswerCache::kMaxCode, reader)));
}

TEST_F(Answers, OfAnotherUserAreNone) {
  if (::geteuid() != 0) GTEST_SKIP() << "only root can give a file away";
  keep(cache_, "input", "answer");
  if (::chown(only_entry().c_str(), 65534, 65534) != 0) GTEST_SKIP() << "there is no other user here";
  EXPECT_EQ(find("input"), std::nullopt);
  fs::remove_all(folder_);
  ASSERT_EQ(::chown(folder_.parent_path().c_str(), 65534, 65534), 0);
  keep(cache_, "input", "answer");
  EXPECT_FALSE(fs::exists(folder_)) << "root makes no folder in another user's home";
}

TEST_F(Answers, WhoseEntryIsNoPlainFileAreNone) {
  keep(cache_, "input", "answer");
  const fs::path entry = only_entry();
  fs::remove(entry);
  ASSERT_EQ(::mkfifo(entry.c_str(), 0600), 0);
  EXPECT_EQ(find("input"), std::nullopt) << "and nobody waits";
  fs::remove(entry);
  fs::create_directory(entry);
  EXPECT_EQ(find("input"), std::nullopt);
}

TEST_F(Answers, ThatAreNotWholeAreNone) {
  keep(cache_, "input", "answer");
  const fs::path entry = only_entry();
  const std::string good = files_.read(fs::relative(entry, files_.folder()));
  for (std::size_t at = 0; at < good.size(); ++at) {
    std::string bad = good;
    bad[at] ^= 1;
    files_.write(fs::relative(entry, files_.folder()), bad);
    EXPECT_EQ(find("input"), std::nullopt) << "byte " << at;
    files_.write(fs::relative(entry, files_.folder()), good.substr(0, at));
    EXPECT_EQ(find("input"), std::nullopt) << "the first " << at << " bytes";
  }
  keep(cache_, "input", "answer");
  EXPECT_EQ(find("input"), "answer");
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
          EXPECT_EQ(find("all"), answer);
        }
      });
  }
  for (int k = 0; k < 200; ++k) EXPECT_EQ(find(std::to_string(k)), answer);
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_), fs::directory_iterator()), 201)
      << "no unfinished file is left";
}

TEST_F(Answers, ThatCannotBeKeptDoNoHarm) {
  files_.write("file", "");
  for (const fs::path& folder :
       {fs::path(), fs::path("relative"), files_.folder() / "file/in", fs::path("/proc/none")}) {
    const AnswerCache cache(folder);
    keep(cache, "input", "answer");
    EXPECT_EQ(cache.find(cache.ask(reader_, "input")), std::nullopt) << folder;
  }
}

TEST_F(Answers, MakeRoomForNewOnes) {
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
  struct stat status {};
  ASSERT_EQ(::stat((folder_ / oldest_first[0]).c_str(), &status), 0);
  const auto room = static_cast<std::uintmax_t>(status.st_blocks) * 512;
  AnswerCache(folder_, 12 * room).make_room();
  EXPECT_TRUE(fs::exists(folder_ / oldest_first[0])) << "there is room";
  AnswerCache(folder_, 8 * room).make_room();
  for (std::size_t i = 0; i < oldest_first.size(); ++i)
    EXPECT_EQ(fs::exists(folder_ / oldest_first[i]), i >= 6) << "six may stay, the newest";
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
  EXPECT_EQ(find("input"), "answer");
  EXPECT_GT(fs::last_write_time(entry), long_ago + std::chrono::hours(47));
}

TEST(CacheFolder, IsTheFirstThatTheEnvironmentNames) {
  std::map<std::string, std::optional<std::string>> before;
  for (const char* name : {"CACHE_DIRECTORY", "XDG_CACHE_HOME", "HOME"})
    before[name] = std::getenv(name) ? std::optional<std::string>(std::getenv(name)) : std::nullopt;
  const auto set = [](const std::string& name, const std::optional<std::string>& value) {
    value ? ::setenv(name.c_str(), value->c_str(), 1) : ::unsetenv(name.c_str());
  };
  using Value = std::optional<std::string>;
  const auto with = [&](const Value& systemd, const Value& xdg, const Value& home) {
    set("CACHE_DIRECTORY", systemd);
    set("XDG_CACHE_HOME", xdg);
    set("HOME", home);
    return usual_cache_folder();
  };
  EXPECT_EQ(with("/var/cache/a", "/x", "/h"), "/var/cache/a/visum");
  EXPECT_EQ(with("/var/cache/a:/var/cache/b", "/x", "/h"), "/var/cache/a/visum");
  EXPECT_EQ(with({}, "/x", "/h"), "/x/visum");
  EXPECT_EQ(with({}, "/x:y/", "/h"), "/x:y/visum") << "no list";
  EXPECT_EQ(with("", "x", "/h"), "/h/.cache/visum") << "relative folders do not count";
  EXPECT_EQ(with({}, {}, {}), "");
  for (const auto& [name, value] : before) set(name, value);
}

// An ELF file with one segment of notes.
std::string elf(const std::string& notes, std::uint64_t alignment) {
  ElfW(Ehdr) header{};
  std::memcpy(header.e_ident, ELFMAG, SELFMAG);
  header.e_ident[EI_CLASS] = sizeof(void*) == 8 ? ELFCLASS64 : ELFCLASS32;
  header.e_ident[EI_DATA] = std::endian::native == std::endian::little ? ELFDATA2LSB : ELFDATA2MSB;
  header.e_phoff = sizeof header;
  header.e_phentsize = sizeof(ElfW(Phdr));
  header.e_phnum = 1;
  ElfW(Phdr) segment{};
  segment.p_type = PT_NOTE;
  segment.p_offset = sizeof header + sizeof segment;
  segment.p_filesz = notes.size();
  segment.p_align = alignment;
  std::string file(reinterpret_cast<const char*>(&header), sizeof header);
  file.append(reinterpret_cast<const char*>(&segment), sizeof segment);
  return file + notes;
}

std::string note(const std::string& name, std::uint32_t type, const std::string& description,
                 std::size_t alignment) {
  const ElfW(Nhdr)
      header{static_cast<std::uint32_t>(name.size()), static_cast<std::uint32_t>(description.size()), type};
  std::string bytes(reinterpret_cast<const char*>(&header), sizeof header);
  for (const std::string& part : {name, description}) {
    bytes += part;
    bytes.resize((bytes.size() + alignment - 1) / alignment * alignment);
  }
  return bytes;
}

TEST(BuildId, IsFoundAmongOtherNotes) {
  const TempFiles files;
  const std::string gnu("GNU\0", 4), id = "\x01\xab";
  for (const std::size_t alignment : {4u, 8u}) {
    const std::string own = note(gnu, NT_GNU_BUILD_ID, id, alignment);
    const auto id_of = [&](const std::string& notes) {
      return build_id_of(files.write("a", elf(notes, alignment)));
    };
    EXPECT_EQ(id_of(own), "01ab");
    EXPECT_EQ(id_of(note(gnu, NT_GNU_ABI_TAG, "sixteen bytes...", alignment) + own + own), "01ab");
    EXPECT_EQ(id_of(note("odd name", NT_GNU_BUILD_ID, "12345", alignment) + own), "01ab");
    EXPECT_EQ(id_of(note("GNU", NT_GNU_BUILD_ID, id, alignment)), "") << "another owner";
    EXPECT_EQ(id_of(note(gnu, NT_GNU_BUILD_ID, "", alignment)), "");
    EXPECT_EQ(id_of(own.substr(0, own.size() - alignment)), "") << "the description is cut off";
    std::string endless = own;
    endless[4] = endless[5] = endless[6] = endless[7] = '\xff';
    EXPECT_EQ(id_of(endless), "");
  }
}

TEST(BuildId, OfAFileThatHasNoneIsEmpty) {
  const TempFiles files;
  EXPECT_FALSE(build_id_of(kBin / "visum-mesh").empty());
  EXPECT_NE(build_id_of(kBin / "visum-mesh"), build_id_of(kOther));
  EXPECT_EQ(build_id_of("/nowhere"), "");
  EXPECT_EQ(build_id_of("/dev/zero"), "");
  EXPECT_EQ(build_id_of(files.folder()), "");
  EXPECT_EQ(build_id_of(files.write("empty", "")), "");
  EXPECT_EQ(build_id_of(files.write("text", std::string(1000, 'x'))), "");
  const std::string good = elf(note(std::string("GNU\0", 4), NT_GNU_BUILD_ID, "1234", 4), 4);
  ASSERT_EQ(build_id_of(files.write("cut", good)), "31323334");
  for (std::size_t bytes = 0; bytes < good.size(); ++bytes)
    EXPECT_EQ(build_id_of(files.write("cut", good.substr(0, bytes))), "") << bytes;
}

}  // namespace
}  // namespace visum::scene
