# Build options for tests/mutate.py. Libraries are compiled file by file, so that a mutant needs one
# small compilation. Tests do not change, so they are compiled in groups.
set(CMAKE_UNITY_BUILD ON)
set(CMAKE_BUILD_TYPE Debug)
set(CMAKE_CXX_FLAGS_DEBUG "-O1") # -O0 makes tests five times slower, -O3 compiling
find_program(MOLD mold)
if(MOLD)
    set(CMAKE_EXE_LINKER_FLAGS -fuse-ld=mold)
endif()
cmake_language(DEFER CALL set_target_properties tessera_format tessera_decoder tessera_codec
               PROPERTIES UNITY_BUILD OFF)
