# cmake -D SOURCE=folder -D TO=file.cc -P commit.cmake
# Writes the commit of the source to the file, with a + if the source was changed since, or nothing if the
# commit is unknown. The file is only touched if its text changes.
set(commit "")
find_program(git git)
if(git)
  execute_process(COMMAND ${git} -C ${SOURCE} rev-parse --short=12 HEAD
    OUTPUT_VARIABLE commit OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
  if(commit)
    execute_process(COMMAND ${git} -C ${SOURCE} diff --quiet HEAD RESULT_VARIABLE changed ERROR_QUIET)
    if(changed)
      string(APPEND commit "+")
    endif()
  endif()
endif()
file(CONFIGURE OUTPUT ${TO} CONTENT "namespace visum::recording {
extern const char* const kCommit;
const char* const kCommit = \"${commit}\";
}  // namespace visum::recording
")
