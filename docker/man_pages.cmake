# Writes a manual page for each program, and for each verb of visum, to the folder OUT. Arguments: BIN, the
# folder of the programs; PROGRAMS, their names separated by commas; OUT; VERSION.
#
# `PROGRAM --help-man` prints the page, made from the same options and texts as --help
# (protocol/command_line). The example controllers know no --help-man: their page holds the text of --help as
# it is.
string(REPLACE "," ";" PROGRAMS "${PROGRAMS}")
file(REMOVE_RECURSE ${OUT})
file(MAKE_DIRECTORY ${OUT})

function(write_page name page)
  file(WRITE ${OUT}/${name}.1 "${page}")
  file(CHMOD ${OUT}/${name}.1 PERMISSIONS OWNER_READ OWNER_WRITE GROUP_READ WORLD_READ)
endfunction()

# The page of an example, whose first line of help says what it is for.
function(write_plain_page name help)
  string(REGEX REPLACE "=/[^ \n]*" "" help "${help}")  # a default that is a path of this machine
  string(REPLACE "\\" "\\e" help "${help}")
  string(REPLACE "-" "\\-" help "${help}")
  string(REGEX REPLACE "(^|\n)([.'])" "\\1\\\\&\\2" help "${help}")
  string(REGEX MATCH "^[^\n]*" purpose "${help}")
  string(REPLACE "-" "\\-" roff_name "${name}")
  string(TOUPPER "${roff_name}" title)
  write_page(${name} ".TH \"${title}\" 1 \"\" \"Visum ${VERSION}\" \"Visum\"
.SH NAME
${roff_name} \\- ${purpose}
.SH DESCRIPTION
.nf
${help}.fi
.SH SEE ALSO
\\fBvisum\\fR(1),
\\fBvisumd\\fR(1)
")
endfunction()

# `ARGN`: the verb, if any.
function(try_page name program)
  execute_process(COMMAND ${BIN}/${program} ${ARGN} --help-man OUTPUT_VARIABLE page ERROR_QUIET RESULT_VARIABLE code)
  set(page "${page}" PARENT_SCOPE)
  if(NOT code EQUAL 0)
    set(page "" PARENT_SCOPE)
  endif()
endfunction()

foreach(program ${PROGRAMS})
  try_page(${program} ${program})
  if(page)
    write_page(${program} "${page}")
  else()
    execute_process(COMMAND ${BIN}/${program} --help OUTPUT_VARIABLE help COMMAND_ERROR_IS_FATAL ANY)
    write_plain_page(${program} "${help}")
  endif()
endforeach()

execute_process(COMMAND ${BIN}/visum --help-man OUTPUT_VARIABLE of_visum COMMAND_ERROR_IS_FATAL ANY)
string(REGEX MATCHALL "\n.TP\n[\\]fBvisum[\\]-[a-z\\-]+[\\]fR[(]1" entries "${of_visum}")
foreach(entry ${entries})
  string(REGEX REPLACE "^.*fBvisum..([a-z\\-]+)[\\]fR.*$" "\\1" verb "${entry}")
  string(REPLACE "\\" "" verb "${verb}")
  try_page(visum-${verb} visum ${verb})
  if(NOT page)
    message(FATAL_ERROR "visum ${verb} --help-man printed no page")
  endif()
  write_page(visum-${verb} "${page}")
endforeach()
