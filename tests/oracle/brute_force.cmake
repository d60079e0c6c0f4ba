asperity_add_test(oracle_brute_force_self SOURCES brute_force.cpp brute_force_self_test.cpp)

if(TARGET asperity_command)
  asperity_add_test(oracle_brute_force_models
    SOURCES brute_force.cpp brute_force_models_test.cpp undersampling_models_test.cpp
    LIBS asperity::io)
  target_compile_definitions(oracle_brute_force_models PRIVATE ASPERITY_TEST_MODELS_DIR="${ASPERITY_TEST_MODELS_DIR}")
  set_tests_properties(oracle_brute_force_models PROPERTIES FIXTURES_REQUIRED benchmark_models)
  asperity_long_test(oracle_brute_force_models oracle_brute_force_models)
endif()
