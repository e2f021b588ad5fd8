# The other engines that this machine has (peers.txt), each from one file. Their headers are not ours: no
# warnings from them.

add_library(bench_stepper STATIC peers/stepper.cc)
target_link_libraries(bench_stepper PUBLIC visum_world)
target_link_libraries(visum-bench PRIVATE bench_stepper)

# visum_peer(NAME FOUND SOURCES... LINK targets or flags...)
function(visum_peer name found)
  cmake_parse_arguments(ARG "" "" "SOURCES;LINK;INCLUDES;OPTIONS" ${ARGN})
  if(NOT found)
    message(STATUS "visum-bench: without ${name}, which is not installed")
    return()
  endif()
  string(TOUPPER ${name} upper)
  add_library(bench_${name} STATIC ${ARG_SOURCES})
  target_include_directories(bench_${name} PRIVATE ${PROJECT_SOURCE_DIR})
  target_include_directories(bench_${name} SYSTEM PRIVATE ${ARG_INCLUDES})
  target_compile_options(bench_${name} PRIVATE -Wall -Wextra -Werror -Wno-missing-field-initializers ${ARG_OPTIONS})
  target_link_libraries(bench_${name} PUBLIC bench_stepper PRIVATE ${ARG_LINK})
  target_link_libraries(visum-bench PRIVATE bench_${name})
  target_compile_definitions(visum-bench PRIVATE VISUM_PEER_${upper})
endfunction()

visum_peer(ode TRUE SOURCES peers/ode_bare.cc LINK PkgConfig::ODE)

# Not by find_package: Debian's mujocoConfig.cmake names an include directory that does not exist.
find_library(MUJOCO_LIBRARY mujoco)
visum_peer(mujoco "${MUJOCO_LIBRARY}" SOURCES peers/mujoco.cc peers/mjcf.cc LINK "${MUJOCO_LIBRARY}")

pkg_check_modules(BULLET QUIET IMPORTED_TARGET bullet-float64)
visum_peer(bullet "${BULLET_FOUND}" SOURCES peers/bullet.cc peers/bullet_bodies.cc LINK PkgConfig::BULLET)

find_package(DART QUIET)
visum_peer(dart "${DART_FOUND}" SOURCES peers/dart.cc LINK dart)

# Debian's Simbody is built with its assertions; with NDEBUG its headers describe other classes, and it
# crashes.
find_package(Simbody QUIET)
visum_peer(simbody "${Simbody_FOUND}" SOURCES peers/simbody.cc peers/simbody_chain.cc LINK ${Simbody_LIBRARIES} INCLUDES ${Simbody_INCLUDE_DIR}
           OPTIONS -UNDEBUG)
set_source_files_properties(peers/simbody_chain.cc PROPERTIES COMPILE_OPTIONS -std=c++17)

pkg_check_modules(KDL QUIET IMPORTED_TARGET orocos-kdl)
visum_peer(kdl "${KDL_FOUND}" SOURCES peers/kdl.cc LINK PkgConfig::KDL)
