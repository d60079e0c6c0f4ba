# A folder of baked models for the experiments in tests: links to the benchmark's, and what experiments bake themselves.
#   cmake -DCOMMAND=path/to/asperity -DBENCHMARK=folder -DDIR=folder -P experiment_models.cmake
# What is older than the command is baked again.
cmake_minimum_required(VERSION 3.25)
file(MAKE_DIRECTORY ${DIR})
file(GLOB _kept ${DIR}/*.glb)
foreach(_model IN LISTS _kept)
  if(NOT IS_SYMLINK ${_model} AND NOT ${_model} IS_NEWER_THAN ${COMMAND})
    file(REMOVE ${_model})
  endif()
endforeach()
foreach(_name block gear hammer cad_part file torus)
  file(CREATE_LINK ${BENCHMARK}/${_name}.glb ${DIR}/${_name}.glb SYMBOLIC)
endforeach()
