asperity_add_test_library(oracle_originals SOURCES against_originals.cpp brute_force.cpp LIBS built_renderers)
asperity_optimise(oracle_originals)
asperity_add_test(oracle_brute_force_self SOURCES brute_force_self_test.cpp LIBS oracle_originals)

if(TARGET asperity_command)
  asperity_add_test(oracle_brute_force_models WARM
    SOURCES brute_force_models_test.cpp texel_holes_models_test.cpp APART undersampling_models_test.cpp
    LIBS oracle_originals asperity::io)
  target_compile_definitions(oracle_brute_force_models PRIVATE ASPERITY_TEST_MODELS_DIR="${ASPERITY_TEST_MODELS_DIR}")
  set_tests_properties(oracle_brute_force_models PROPERTIES FIXTURES_REQUIRED benchmark_models)
  asperity_long_test(oracle_brute_force_models oracle_brute_force_models)

  # Skips where ASPERITY_MODELS names no folder of real meshes.
  asperity_add_test(oracle_real_models
    SOURCES real_models_test.cpp ../fault/command_process.cpp
    LIBS oracle_originals asperity::io nlohmann_json::nlohmann_json)
  target_compile_definitions(oracle_real_models PRIVATE ASPERITY_COMMAND="$<TARGET_FILE:asperity_command>")
  add_dependencies(oracle_real_models asperity_command)
  asperity_long_test(oracle_real_models oracle_real_models)
endif()
