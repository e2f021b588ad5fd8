// Keeps what readers (reader_process.h) made of files, in the user's cache folder, from one run to the next.
// An answer counts for the bytes that the reader read, for the builds of the reader and of the shared
// libraries that it ran with, for the lists by which the dynamic linker finds libraries, and for the
// instruction sets between which the C library's mathematics chooses. Whoever asks has read the file before,
// so that a scene is noted with the same files either way.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "server/scene/build_id.h"

namespace visum::scene {

// $CACHE_DIRECTORY/visum (systemd sets it; of a list the first), $XDG_CACHE_HOME/visum or $HOME/.cache/visum:
// the first of these whose variable is set and absolute. Empty: none is.
std::filesystem::path usual_cache_folder();

// A folder of entries, one file each. Any number of processes and threads may use it at once. Nothing throws
// or fails: an entry that is not whole, of another user, or not of these builds counts as missing and is
// written anew, and where nothing can be written nothing is kept, with a line for -v 3.
class AnswerCache {
 public:
  static constexpr std::uintmax_t kUsualBytes = std::uintmax_t{1} << 30;
  static constexpr std::size_t kMaxCode = 64;  // files; visum-mesh has some ten

  // A folder that is empty or relative: nothing is found or kept. Others are made where they are missing,
  // open to this user only.
  explicit AnswerCache(std::filesystem::path folder = {}, std::uintmax_t most_bytes = kUsualBytes);

  // A reader and its input, which must outlive the question. Ask before the reader runs.
  struct Question {
    std::filesystem::path reader;  // without links
    std::string_view input;
    std::filesystem::path entry;  // empty: nothing can be kept
  };
  Question ask(const std::filesystem::path& reader, std::string_view input) const;

  std::optional<std::string> find(const Question& question) const;

  // Keeps the answer of a reader that ran with these files of code: its own, and its shared libraries. If one
  // of them is another build now, or has no build id, nothing is kept.
  void keep(const Question& question, std::string_view answer, const std::vector<CodeFile>& code) const;

  // If the entries take more room than most_bytes, removes what was not used for the longest time, down to
  // three quarters of it. keep() calls it once in sixteen times, and for large answers.
  void make_room() const;

 private:
  void make_folder() const;
  void write(const std::filesystem::path& entry, std::string_view body) const;

  std::filesystem::path folder_;
  std::uintmax_t most_bytes_;
};

// The cache of this process. It keeps nothing until keep_answers_in() is called: before the first scene is
// read, on the only thread.
const AnswerCache& answer_cache();
void keep_answers_in(std::filesystem::path folder);

}  // namespace visum::scene
