asperity_add_test_library(oracle_originals
  SOURCES against_originals.cpp approach.cpp brute_force.cpp fresh_poses.cpp originals_agree.cpp placed_mesh.cpp
  LIBS asperity_test_parts)
asperity_add_test(oracle_brute_force_self
  SOURCES brute_force_self_test.cpp APART placed_mesh_test.cpp LIBS oracle_originals)

if(TARGET asperity_command)
  asperity_add_test(oracle_brute_force_models
    SOURCES brute_force_models_test.cpp texel_holes_models_test.cpp
    APART fresh_poses_test.cpp undersampling_models_test.cpp
    LIBS oracle_originals asperity::io)
  target_compile_definitions(oracle_brute_force_models PRIVATE ASPERITY_TEST_MODELS_DIR="${ASPERITY_TEST_MODELS_DIR}")
  set_tests_properties(oracle_brute_force_models PROPERTIES FIXTURES_REQUIRED benchmark_models)
  asperity_nightly(oracle_brute_force_models law oracle_brute_force_models)

  # Real meshes and their bakes, for the tests of presses and of truth too.
  asperity_add_test_library(real_bodies QUICK SOURCES real_bodies.cpp
    LIBS oracle_originals asperity::io asperity::bake nlohmann_json::nlohmann_json)
  target_compile_definitions(real_bodies PRIVATE
    ASPERITY_MODELS_BESIDE="${ASPERITY_MODELS_BESIDE}" ASPERITY_TEST_MODELS_DIR="${ASPERITY_TEST_MODELS_DIR}")

  # Skips where there are no real meshes.
  asperity_add_test(oracle_real_models
    SOURCES real_models_test.cpp ../../system/fault/command_process.cpp
    LIBS real_bodies)
  target_compile_definitions(oracle_real_models PRIVATE
    ASPERITY_COMMAND="$<TARGET_FILE:asperity_command>" ASPERITY_MODELS_BESIDE="${ASPERITY_MODELS_BESIDE}"
    ASPERITY_TEST_MODELS_DIR="${ASPERITY_TEST_MODELS_DIR}")
  add_dependencies(oracle_real_models asperity_command)
  set_tests_properties(oracle_real_models PROPERTIES FIXTURES_REQUIRED real_models)
  asperity_nightly(oracle_real_models law oracle_real_models)
endif()
