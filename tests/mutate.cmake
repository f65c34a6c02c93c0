# What tests/mutate.py builds: libraries file by file, so that a mutant is one small compilation; the tests,
# which stay as they are, in groups.
set(CMAKE_UNITY_BUILD ON)
set(CMAKE_BUILD_TYPE Debug)
set(CMAKE_CXX_FLAGS_DEBUG "-O1") # without it the tests take five times as long; with the libraries' -O3 compiling does
find_program(MOLD mold)
if(MOLD)
    set(CMAKE_EXE_LINKER_FLAGS -fuse-ld=mold)
endif()
cmake_language(DEFER CALL set_target_properties tessera_format tessera_decoder tessera_codec
               PROPERTIES UNITY_BUILD OFF)
