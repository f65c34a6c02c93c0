# What tests/mutate.py builds: libraries file by file, so that a mutant is one small compilation; the tests,
# which stay as they are, in groups.
set(CMAKE_UNITY_BUILD ON)
set(CMAKE_BUILD_TYPE Debug) # without the libraries' -O3
cmake_language(DEFER CALL set_target_properties tessera_format tessera_decoder tessera_codec
               PROPERTIES UNITY_BUILD OFF)
