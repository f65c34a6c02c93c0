# Builds and runs projects outside of Tessera's tree.
#   cmake -DKIND=installed -DBUILD=Tessera's build -DOUT=folder -P check.cmake
#   cmake -DKIND=subproject -DSOURCE=Tessera's sources -DOUT=folder -P check.cmake
file(REMOVE_RECURSE ${OUT})
file(MAKE_DIRECTORY ${OUT})
set(here ${CMAKE_CURRENT_LIST_DIR})

function(run)
    execute_process(COMMAND ${ARGN} RESULT_VARIABLE code OUTPUT_VARIABLE text ERROR_VARIABLE text)
    if(NOT code EQUAL 0)
        string(REPLACE ";" " " command "${ARGN}")
        message(FATAL_ERROR "${command}\n${text}exit code ${code}")
    endif()
endfunction()

# Configures and builds the project in `folder`, and runs its programs.
function(build_and_run folder programs)
    get_filename_component(name ${folder} NAME)
    run(${CMAKE_COMMAND} -S ${folder} -B ${OUT}/${name} -G Ninja ${ARGN})
    list(TRANSFORM programs REPLACE ".*/" "" OUTPUT_VARIABLE targets)
    run(${CMAKE_COMMAND} --build ${OUT}/${name} --target ${targets})
    foreach(program IN LISTS programs)
        run(${OUT}/${name}/${program})
        message(STATUS "${KIND}: ${program} runs")
    endforeach()
endfunction()

if(KIND STREQUAL "subproject")
    # Unoptimised and in a few large sources, to save time.
    build_and_run(${here}/subproject "consumer_c;cpp/consumer_cpp" -DTESSERA_SOURCE=${SOURCE}
                  -DCMAKE_UNITY_BUILD=ON -DCMAKE_BUILD_TYPE=Debug -DCMAKE_CXX_FLAGS_DEBUG=
                  -DCMAKE_C_FLAGS_DEBUG=)
    return()
endif()

set(prefix ${OUT}/prefix)
run(${CMAKE_COMMAND} --install ${BUILD} --prefix ${prefix})
build_and_run(${here}/c consumer_c -DCMAKE_PREFIX_PATH=${prefix})
build_and_run(${here}/cpp consumer_cpp -DCMAKE_PREFIX_PATH=${prefix})
file(GLOB_RECURSE with_glsl ${prefix}/*/tesseraGlslTargets.cmake)
if(with_glsl)
    build_and_run(${here}/glsl consumer_glsl -DCMAKE_PREFIX_PATH=${prefix})
endif()

# If the tool is installed, it must run.
find_program(tool tessera PATHS ${prefix}/bin NO_DEFAULT_PATH)
if(tool)
    run(${tool} version)
    run(${tool} help bake)
    message(STATUS "installed: the tool runs")
endif()

# Builds without CMake: pkg-config gives the flags for the shared library.
file(GLOB_RECURSE pc ${prefix}/*/tessera.pc)
get_filename_component(pc_folder ${pc} DIRECTORY)
set(ENV{PKG_CONFIG_PATH} ${pc_folder})
find_program(PKG_CONFIG pkg-config REQUIRED)
execute_process(COMMAND ${PKG_CONFIG} --define-prefix --cflags --libs tessera
                OUTPUT_VARIABLE flags OUTPUT_STRIP_TRAILING_WHITESPACE COMMAND_ERROR_IS_FATAL ANY)
separate_arguments(flags UNIX_COMMAND "${flags}")
get_filename_component(libraries ${pc_folder} DIRECTORY)
run(cc ${here}/c/main.c -o ${OUT}/by_pkg_config ${flags} -Wl,-rpath,${libraries})
run(${OUT}/by_pkg_config)
message(STATUS "installed: a program built with pkg-config's flags runs")
