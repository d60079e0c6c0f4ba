# Hardening of what a top-level build makes: libraries, commands and drivers. A bug in a reader of foreign bytes then ends
# the process instead of running somebody's code. Nothing of it reaches a consumer: asperity_hardening is linked PRIVATE
# and within the build only, and a project that builds asperity as a part of itself decides for itself.
#   ASPERITY_HARDEN=OFF leaves it all out.
option(ASPERITY_HARDEN "Harden asperity's own binaries: stack protector, fortified C library calls, RELRO, PIE"
       ${PROJECT_IS_TOP_LEVEL})
add_library(asperity_hardening INTERFACE)
if(ASPERITY_HARDEN)
  include(CheckPIESupported)
  check_pie_supported(LANGUAGES CXX)
  set(_type $<TARGET_PROPERTY:TYPE>)
  set(_is_program $<STREQUAL:${_type},EXECUTABLE>)
  set(_is_shared $<OR:$<IN_LIST:${_type},SHARED_LIBRARY;MODULE_LIBRARY>,$<BOOL:$<TARGET_PROPERTY:POSITION_INDEPENDENT_CODE>>>)
  target_compile_options(asperity_hardening INTERFACE
    -fstack-protector-strong -fstack-clash-protection
    # What goes into a program has to be movable with it; what is in a shared object is already.
    $<$<NOT:${_is_shared}>:-fPIE>)
  if(NOT ASPERITY_SANITIZE)  # the sanitizers look at the same calls, and better
    # The C library's checks need an optimising compiler, and say so as a warning.
    target_compile_options(asperity_hardening INTERFACE
      $<$<CONFIG:Release,RelWithDebInfo,MinSizeRel>:-U_FORTIFY_SOURCE>
      $<$<CONFIG:Release,RelWithDebInfo,MinSizeRel>:-D_FORTIFY_SOURCE=2>)
  endif()
  target_link_options(asperity_hardening INTERFACE
    $<${_is_program}:-pie> -Wl,-z,relro -Wl,-z,now -Wl,-z,noexecstack)
endif()
