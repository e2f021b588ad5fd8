# Says which files `cmake --install` and CPack install, and where. The top CMakeLists.txt includes this file
# after all programs are known.
#   bin/                       visumd, visum, the example controllers
#   share/visum/models/        robots, scenes, scenarios
#   share/visum/clients/       sources of the example controllers, with the headers that they include
#   share/visum/server/scene/  the schema of scenes, for editors
#   lib/, include/visum/       the C++ client library: find_package(visum), pkg-config visum
#   include/visum/mca/         the library for controllers in MCA2's manner (visum::mca), pkg-config visum-mca
#   include/visum/plugin.h     the header for plug-ins (visum::plugin)
#   lib/visum/plugins/         the plug-ins of our own examples
#   share/man/man1/            a manual page for each program and each verb of visum
#   share/doc/visum/           all pages, in the layout of the tree (install-pages)
# and the shells' completion. The Python package installs itself (clients/python).
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

# The target `programs` builds all that is needed to run, and no tests.
get_property(programs GLOBAL PROPERTY VISUM_PROGRAMS)
get_property(libraries GLOBAL PROPERTY VISUM_LIBRARIES)
add_custom_target(programs DEPENDS ${programs} ${libraries} visum_python visum-first-controller)
if(TARGET page)
  add_dependencies(programs page)
endif()
install(TARGETS ${programs} RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})

# visum_shared_library(NAME OF FILE LINK...) makes the static library OF one shared object, for outside
# projects: they need its headers and none of our libraries. They link visum::NAME.
function(visum_shared_library name of file)
  set(target visum_${name}_shared)
  add_library(${target} SHARED $<TARGET_OBJECTS:${of}>)
  set_target_properties(${target} PROPERTIES OUTPUT_NAME ${file} EXPORT_NAME ${name} LINKER_LANGUAGE CXX
                        VERSION ${PROJECT_VERSION} SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR}
                        INSTALL_RPATH $ORIGIN)  # they find each other, wherever they are installed
  target_link_libraries(${target} ${ARGN})
  # Symbols of our static libraries stay hidden in it. It must resolve all its symbols, except those of a
  # sanitizer.
  target_link_options(${target} PRIVATE -Wl,--exclude-libs,ALL)
  if(NOT VISUM_SANITIZE)
    target_link_options(${target} PRIVATE -Wl,--no-undefined)
  endif()
  target_compile_features(${target} INTERFACE cxx_std_20)
  target_include_directories(${target} INTERFACE $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
  add_dependencies(programs ${target})
  install(TARGETS ${target} EXPORT visum LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR})
  configure_file(docker/visum.pc.in ${PROJECT_BINARY_DIR}/${file}.pc @ONLY)
  install(FILES ${PROJECT_BINARY_DIR}/${file}.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
endfunction()
file(RELATIVE_PATH prefix_from_pkgconfig /prefix/${CMAKE_INSTALL_LIBDIR}/pkgconfig /prefix)

set(description "Client library of Visum, the co-simulation server for robot controllers")
visum_shared_library(client visum_client visum PRIVATE visum_protocol visum_config)
install(FILES clients/cpp/visum.h clients/cpp/kinematics.h clients/cpp/world.h DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/visum)

# The library for controllers in MCA2's manner. Outside, its headers are <visum/mca/part.h> and so on.
set(description "Controllers for Visum in MCA2's manner: modules, groups and parts")
set(requires visum)
visum_shared_library(mca visum_mca visum-mca PUBLIC visum_client_shared
                     PRIVATE visum_cli visum_command_line visum_protocol visum_config spdlog::spdlog)
set(mca_headers blackboard group lower module names options parameter part vector)
foreach(header ${mca_headers})
  set(source ${PROJECT_SOURCE_DIR}/clients/mca/${header}.h)
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${source})
  file(READ ${source} content)
  string(REPLACE "\"clients/mca/" "\"visum/mca/" content "${content}")
  string(REPLACE "\"clients/cpp/" "\"visum/" content "${content}")
  file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/include/visum/mca/${header}.h CONTENT "${content}" @ONLY)
  install(FILES ${PROJECT_BINARY_DIR}/include/visum/mca/${header}.h DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/visum/mca)
  install(FILES ${source} DESTINATION ${CMAKE_INSTALL_DATADIR}/visum/clients/mca)
endforeach()
install(DIRECTORY clients/mca/three_parts DESTINATION ${CMAKE_INSTALL_DATADIR}/visum/clients/mca PATTERN CMakeLists.txt EXCLUDE)

# Plug-ins need a header, and nothing to link.
add_library(visum_plugin_interface INTERFACE)
set_target_properties(visum_plugin_interface PROPERTIES EXPORT_NAME plugin)
target_compile_features(visum_plugin_interface INTERFACE cxx_std_20)
target_include_directories(visum_plugin_interface INTERFACE $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
install(TARGETS visum_plugin_interface EXPORT visum)
install(FILES protocol/plugin/plugin.h DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/visum)

set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/visum)
install(EXPORT visum NAMESPACE visum:: FILE visumConfig.cmake DESTINATION ${package_dir})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/visumConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/visumConfigVersion.cmake DESTINATION ${package_dir})

install(DIRECTORY models DESTINATION ${CMAKE_INSTALL_DATADIR}/visum PATTERN __pycache__ EXCLUDE
        PATTERN "*.py" PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
install(FILES server/scene/scene.schema.json DESTINATION ${CMAKE_INSTALL_DATADIR}/visum/server/scene)
install(DIRECTORY clients/examples DESTINATION ${CMAKE_INSTALL_DATADIR}/visum/clients PATTERN CMakeLists.txt EXCLUDE)
install(FILES clients/cpp/visum.h clients/cpp/kinematics.h clients/cpp/world.h DESTINATION ${CMAKE_INSTALL_DATADIR}/visum/clients/cpp)
install(FILES protocol/plugin/plugin.h DESTINATION ${CMAKE_INSTALL_DATADIR}/visum/protocol/plugin)
install(FILES protocol/config/trig.h protocol/config/trig.cc DESTINATION ${CMAKE_INSTALL_DATADIR}/visum/protocol/config)

# Installs the completion for each shell, as the program itself writes it.
function(visum_completion shell folder file)
  set(script ${PROJECT_BINARY_DIR}/completion/${file})
  add_custom_command(OUTPUT ${script}
    COMMAND ${CMAKE_COMMAND} -E make_directory ${PROJECT_BINARY_DIR}/completion
    COMMAND visum completion ${shell} > ${script}
    DEPENDS visum VERBATIM)
  add_custom_target(visum_completion_${shell} ALL DEPENDS ${script})
  add_dependencies(programs visum_completion_${shell})
  install(FILES ${script} DESTINATION ${CMAKE_INSTALL_DATADIR}/${folder})
endfunction()
visum_completion(bash bash-completion/completions visum)
visum_completion(zsh zsh/vendor-completions _visum)
visum_completion(fish fish/vendor_completions.d visum.fish)

# The manual pages, as the programs themselves write them.
set(VISUM_INSTALLED_PROGRAMS ${programs})
string(REPLACE ";" "," program_names "${programs}")
set(manual_stamp ${PROJECT_BINARY_DIR}/man1.stamp)
add_custom_command(OUTPUT ${manual_stamp}
  COMMAND ${CMAKE_COMMAND} -D BIN=${CMAKE_RUNTIME_OUTPUT_DIRECTORY} -D PROGRAMS=${program_names} -D VERSION=${PROJECT_VERSION}
          -D OUT=${PROJECT_BINARY_DIR}/man1 -P ${PROJECT_SOURCE_DIR}/docker/man_pages.cmake
  COMMAND ${CMAKE_COMMAND} -E touch ${manual_stamp}
  DEPENDS ${programs} docker/man_pages.cmake COMMENT "Writing the manual pages" VERBATIM)
add_custom_target(visum_manual ALL DEPENDS ${manual_stamp})
add_dependencies(programs visum_manual)
install(DIRECTORY ${PROJECT_BINARY_DIR}/man1 DESTINATION ${CMAKE_INSTALL_MANDIR})

# The pages come last: their links depend on the files that are installed by then.
install(CODE "set(pages ${PROJECT_SOURCE_DIR}/docker/install-pages ${PROJECT_SOURCE_DIR})
set(documents \"${CMAKE_INSTALL_DOCDIR}\")
set(data \"${CMAKE_INSTALL_DATADIR}/visum\")")
install(CODE [[
foreach(folder documents data)
  cmake_path(ABSOLUTE_PATH ${folder} BASE_DIRECTORY "${CMAKE_INSTALL_PREFIX}")
endforeach()
execute_process(COMMAND /usr/bin/python3 ${pages} "$ENV{DESTDIR}${documents}" "$ENV{DESTDIR}${data}"
                COMMAND_ERROR_IS_FATAL ANY)
]])

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME visum)
set(CPACK_PACKAGE_VENDOR Visum)
set(CPACK_PACKAGE_CONTACT "Visum maintainers <maintainers@visum.invalid>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY ${PROJECT_DESCRIPTION})
set(CPACK_PACKAGE_DESCRIPTION "The daemon visumd holds a physics world and publishes virtual hardware parts over TCP, with the ports
of the parts that drive the real hardware: servo arms, grippers. The same controller binary runs in real
time at a desk and in lockstep in CI, with the same bits every time. With the command visum, client
libraries for C++ and Python, models and example controllers.")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
# CPack makes the prefix before folders.cmake runs. This opens it to everybody, as folders.cmake does with the
# rest.
file(WRITE ${PROJECT_BINARY_DIR}/open_prefix.cmake [[
file(CHMOD "${CPACK_TEMPORARY_DIRECTORY}${CPACK_PACKAGING_INSTALL_PREFIX}" PERMISSIONS
     OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
]])
set(CPACK_PRE_BUILD_SCRIPTS ${PROJECT_BINARY_DIR}/open_prefix.cmake)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
# Loaded at run time: server/sensing/embree.h, server/dynamics/ode/ode_library.h and protocol/openssl.h.
set(CPACK_DEBIAN_PACKAGE_DEPENDS "libembree3-3 (>= 3.13), libode8 (>= 2:0.16), libssl3 (>= 3.0)")
set(CPACK_DEBIAN_PACKAGE_RECOMMENDS "python3, python3-protobuf, python3-numpy")
include(CPack)
