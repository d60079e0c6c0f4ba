// The precompiled headers of the tests need a file to be compiled for: see asperity_test_headers.
