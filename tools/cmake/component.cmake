# asperity_component(NAME SOURCES ... HEADERS ... [HEADERS_IN FOLDER] [PUBLIC ...] [PRIVATE ...] [AT_A_TIME FILES]):
# the library asperity_NAME, asperity::NAME for who links it, and a component of the package where install.cmake lists it.
#   HEADERS    its public ones, as they are included; in the room's folder include/ unless HEADERS_IN says another
#   PUBLIC     what its headers need beyond the core
#   PRIVATE    what its sources need
#   AT_A_TIME  see asperity_unity()
# What a room has in a folder internal/, only asperity's own tests and rooms include.
function(asperity_component name)
  cmake_parse_arguments(arg "" "HEADERS_IN;AT_A_TIME" "SOURCES;HEADERS;PUBLIC;PRIVATE" ${ARGN})
  if(NOT arg_HEADERS_IN)
    set(arg_HEADERS_IN ${CMAKE_CURRENT_SOURCE_DIR}/include)
  endif()
  list(TRANSFORM arg_HEADERS PREPEND ${arg_HEADERS_IN}/)

  set(target asperity_${name})
  add_library(${target} ${arg_SOURCES})
  add_library(asperity::${name} ALIAS ${target})
  set_target_properties(${target} PROPERTIES EXPORT_NAME ${name} VERIFY_INTERFACE_HEADER_SETS ON)
  target_sources(${target} PUBLIC FILE_SET HEADERS BASE_DIRS ${arg_HEADERS_IN} FILES ${arg_HEADERS})
  target_link_libraries(${target} PUBLIC ${arg_PUBLIC} asperity::asperity
                        PRIVATE ${arg_PRIVATE} $<BUILD_INTERFACE:asperity_build_options>
                        $<BUILD_INTERFACE:asperity_hardening>)
  if(EXISTS ${CMAKE_CURRENT_SOURCE_DIR}/internal)
    target_include_directories(${target} PUBLIC $<BUILD_INTERFACE:${CMAKE_CURRENT_SOURCE_DIR}/internal>)
  endif()
  if(arg_AT_A_TIME)
    asperity_unity(${target} ${arg_AT_A_TIME})
  endif()
endfunction()
