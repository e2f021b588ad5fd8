# Makes the folders that files are installed to, so that everybody can enter them. CMake would leave that to
# the umask of the person who installs or packs, even with CMAKE_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS. The
# top CMakeLists.txt includes this file before its folders, so that these rules run first.
include(GNUInstallDirs)
set(data ${CMAKE_INSTALL_DATADIR})
set(folders
  ${CMAKE_INSTALL_BINDIR} ${CMAKE_INSTALL_INCLUDEDIR}/visum/mca ${CMAKE_INSTALL_LIBDIR}/cmake/visum ${CMAKE_INSTALL_LIBDIR}/pkgconfig
  lib/python3/dist-packages lib/visum/plugins lib/visum-can lib/visum-shim lib/visum-tty
  ${data}/visum/clients/cpp ${data}/visum/clients/mca/three_parts ${data}/visum/clients/python/examples ${data}/visum/protocol/plugin ${data}/visum/protocol/config ${data}/visum/server/scene
  ${data}/bash-completion/completions ${data}/zsh/vendor-completions ${data}/fish/vendor_completions.d
  ${CMAKE_INSTALL_MANDIR}/man1
  ${CMAKE_INSTALL_DOCDIR})
install(CODE "set(folders \"${folders}\")")
install(CODE [[
function(make_folder folder)
  if(IS_DIRECTORY "${folder}")
    return()
  endif()
  cmake_path(GET folder PARENT_PATH parent)
  make_folder("${parent}")
  file(MAKE_DIRECTORY "${folder}")
  file(CHMOD "${folder}" PERMISSIONS
       OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
endfunction()
foreach(folder IN LISTS folders)
  cmake_path(ABSOLUTE_PATH folder BASE_DIRECTORY "${CMAKE_INSTALL_PREFIX}")
  make_folder("$ENV{DESTDIR}${folder}")
endforeach()
]])
unset(data)
unset(folders)
