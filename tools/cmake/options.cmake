# Compile options of asperity's own targets. Nothing here reaches a consumer: link it PRIVATE.
add_library(asperity_build_options INTERFACE)
target_compile_options(asperity_build_options INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wsign-conversion -Wold-style-cast -Wnon-virtual-dtor -Wcast-qual
  $<$<BOOL:${ASPERITY_WERROR}>:-Werror>)
if(ASPERITY_SANITIZE)
  list(JOIN ASPERITY_SANITIZE "," _sanitizers)
  target_compile_options(asperity_build_options INTERFACE
    -fsanitize=${_sanitizers} -fno-omit-frame-pointer -fno-sanitize-recover=all
    # GCC 12 takes the empty std::optional for uninitialised once the sanitizers have rewritten the code.
    $<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized>)
  target_link_options(asperity_build_options INTERFACE -fsanitize=${_sanitizers})
endif()

# Same inputs, same bits between build types and compilers: no fused multiply-add that the source does not ask for.
# The core is compiled with it; a consumer whose own templates shall give the same bits too links asperity::reproducible.
add_library(asperity_reproducible INTERFACE)
add_library(asperity::reproducible ALIAS asperity_reproducible)
set_target_properties(asperity_reproducible PROPERTIES EXPORT_NAME reproducible)
target_compile_options(asperity_reproducible INTERFACE -ffp-contract=off)
target_link_libraries(asperity_build_options INTERFACE asperity_reproducible)

# asperity_unity(TARGET FILES): compiles FILES sources of a target at a time, 0: all, where the build asks for it (presets do):
# what they all include is then parsed, and what they all instantiate compiled, once and not once per file.
option(ASPERITY_UNITY "Compile several sources at a time, for quicker whole builds" OFF)
if(ASPERITY_UNITY AND CMAKE_CXX_COMPILER_ID STREQUAL GNU)
  # GCC spends a sixteenth of such a build looking for memory that it could use again; this many KB it need not.
  target_compile_options(asperity_build_options INTERFACE --param=ggc-min-heapsize=1000000)
endif()
function(asperity_unity target files)
  set_target_properties(${target} PROPERTIES UNITY_BUILD ${ASPERITY_UNITY} UNITY_BUILD_BATCH_SIZE ${files})
endfunction()
