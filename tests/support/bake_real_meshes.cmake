# Bakes the real meshes of a folder with the command, for the tests that need input that nobody made for them.
#   cmake -DCOMMAND=path/to/asperity -DDIR=folder -DBESIDE=folder -P bake_real_meshes.cmake
# The folder is the one that ASPERITY_MODELS names, or BESIDE. What is newer than the command and its mesh is kept.
# Each bake leaves NAME.glb and the command's report, NAME.json. 512 texels a side: a quarter of the default's time.
cmake_minimum_required(VERSION 3.25)
set(_folder ${BESIDE})
if(DEFINED ENV{ASPERITY_MODELS})
  set(_folder $ENV{ASPERITY_MODELS})
endif()
file(MAKE_DIRECTORY ${DIR})

# The meshes have no unit: these scales make each of them 16 cm from corner to corner.
foreach(_mesh "igea.ply 1.0230267" "rocker-arm.obj 0.13733901" "stanford-bunny.obj 0.63936925")
  separate_arguments(_mesh)
  list(POP_FRONT _mesh _file _scale)
  cmake_path(GET _file STEM _name)
  set(_out ${DIR}/${_name}.glb)
  if(NOT EXISTS ${_folder}/${_file})
    # A bake of another day must not stand for a mesh that is not there.
    file(REMOVE ${_out} ${DIR}/${_name}.json)
    execute_process(COMMAND ${CMAKE_COMMAND} -E echo "SKIPPED: there is no ${_folder}/${_file}; ASPERITY_MODELS names another folder")
    continue()
  endif()
  if(EXISTS ${_out} AND EXISTS ${DIR}/${_name}.json AND ${_out} IS_NEWER_THAN ${COMMAND} AND ${_out} IS_NEWER_THAN
                                                                                       ${_folder}/${_file})
    message(STATUS "${_name}: up to date")
    continue()
  endif()
  execute_process(COMMAND ${COMMAND} --quiet bake ${_folder}/${_file} -o ${_out} --texture 512 --scale ${_scale} ${_mesh} --json
                  RESULT_VARIABLE _status OUTPUT_FILE ${DIR}/${_name}.json)
  if(NOT _status EQUAL 0)
    message(FATAL_ERROR "exit status ${_status}: asperity bake ${_folder}/${_file}")
  endif()
  message(STATUS "${_name}: baked")
endforeach()
