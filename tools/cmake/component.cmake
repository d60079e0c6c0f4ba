# asperity_component(NAME [HIDDEN] [SOURCES ...] HEADERS ... [PUBLIC ...] [PRIVATE ...] [AT_A_TIME FILES]):
# the library asperity_NAME, asperity::NAME for who links it, and a component of the package where install.cmake lists it.
#   HIDDEN     as a shared library it shows only what its headers mark with ASPERITY_API
#   SOURCES    none: a component of headers
#   HEADERS    its public ones, as they are included; they are in the room's folder include/
#   PUBLIC     what its headers need beyond the core
#   PRIVATE    what its sources need
#   AT_A_TIME  see asperity_unity()
# What a room has in a folder internal/, only asperity's own tests and rooms include.
function(asperity_component name)
  cmake_parse_arguments(arg "HIDDEN" "AT_A_TIME" "SOURCES;HEADERS;PUBLIC;PRIVATE" ${ARGN})
  list(TRANSFORM arg_HEADERS PREPEND ${CMAKE_CURRENT_SOURCE_DIR}/include/)

  set(target asperity_${name})
  if(NOT arg_SOURCES)
    add_library(${target} INTERFACE)
    target_link_libraries(${target} INTERFACE ${arg_PUBLIC} asperity::asperity)
    set(visible INTERFACE)
  else()
    add_library(${target} ${arg_SOURCES})
    target_link_libraries(${target} PUBLIC ${arg_PUBLIC} asperity::asperity
                          PRIVATE ${arg_PRIVATE} $<BUILD_INTERFACE:asperity_build_options>
                          $<BUILD_INTERFACE:asperity_hardening>)
    set(visible PUBLIC)
  endif()
  add_library(asperity::${name} ALIAS ${target})
  set_target_properties(${target} PROPERTIES EXPORT_NAME ${name} VERIFY_INTERFACE_HEADER_SETS ON)
  target_sources(${target} ${visible} FILE_SET HEADERS BASE_DIRS ${CMAKE_CURRENT_SOURCE_DIR}/include FILES ${arg_HEADERS})
  if(EXISTS ${CMAKE_CURRENT_SOURCE_DIR}/internal)
    target_include_directories(${target} PUBLIC $<BUILD_INTERFACE:${CMAKE_CURRENT_SOURCE_DIR}/internal>)
  endif()
  if(arg_HIDDEN)
    set_target_properties(${target} PROPERTIES CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON
                          VERSION ${PROJECT_VERSION} SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
  endif()
  if(arg_AT_A_TIME)
    asperity_unity(${target} ${arg_AT_A_TIME})
  endif()
endfunction()
