# tessera_tests(MODULE [SLOW file...] [THREADS file...] [WITHOUT file...] USES library...)
#
# Builds MODULE/*_test.cpp as one program, MODULE_tests, and adds one ctest test per file,
# MODULE.file. A file's tests run in one process and create their fixtures once. Labels: the module;
# `slow` for files in SLOW, which tools/test.sh --fast skips; `threads` for files in THREADS, which
# --sanitize thread runs. Files in WITHOUT are not built, nor NAME_posix_test.cpp
# and NAME_windows_test.cpp on other systems.
set(test_timeout 600) # seconds
if(TESSERA_SANITIZE)
    set(test_timeout 3000)
endif()

function(tessera_tests module)
    cmake_parse_arguments(ARG "" "" "SLOW;THREADS;WITHOUT;USES" ${ARGN})
    file(GLOB files CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/${module}/*_test.cpp)
    tessera_without_other_systems(files "_test")
    foreach(name IN LISTS ARG_WITHOUT)
        list(REMOVE_ITEM files ${CMAKE_CURRENT_SOURCE_DIR}/${module}/${name}.cpp)
    endforeach()
    set(program ${module}_tests)
    add_executable(${program} ${files} support/main.cpp)
    # In unity builds 48 files are compiled together instead of 8, because headers are half of the
    # work.
    set_target_properties(${program} PROPERTIES UNITY_BUILD_BATCH_SIZE 48)
    target_link_libraries(${program} PRIVATE ${ARG_USES} GTest::gtest tessera_build)
    # -O1 compiles faster, and the code that must be fast is in the libraries.
    # -Wdangling-else warns about GTest's macros, which expand to if statements.
    target_compile_options(${program} PRIVATE $<$<NOT:$<CONFIG:Debug>>:-O1> -Wno-dangling-else)

    set(all_suites)
    foreach(file IN LISTS files)
        get_filename_component(name ${file} NAME_WE)
        tessera_suites_of(${file} suites)
        foreach(suite IN LISTS suites)
            if(suite IN_LIST all_suites)
                message(FATAL_ERROR "${file}: another file of ${module} has a suite ${suite}, too")
            endif()
        endforeach()
        list(APPEND all_suites ${suites})
        list(TRANSFORM suites APPEND ".*" OUTPUT_VARIABLE patterns)
        list(JOIN patterns ":" filter)
        add_test(NAME ${module}.${name} COMMAND ${program} --gtest_filter=${filter})
        set(labels ${module})
        if(name IN_LIST ARG_SLOW)
            list(APPEND labels slow)
            set_tests_properties(${module}.${name} PROPERTIES COST 100) # starts early
        endif()
        if(name IN_LIST ARG_THREADS)
            list(APPEND labels threads)
        endif()
        set_tests_properties(${module}.${name} PROPERTIES TIMEOUT ${test_timeout} LABELS "${labels}")
    endforeach()
    foreach(name IN LISTS ARG_SLOW ARG_THREADS)
        if(NOT TEST ${module}.${name} AND NOT name IN_LIST ARG_WITHOUT)
            message(FATAL_ERROR "${module}: no ${name}.cpp, which SLOW or THREADS names")
        endif()
    endforeach()
    add_test(NAME ${module}.all_suites_are_run
             COMMAND ${CMAKE_COMMAND} -DPROGRAM=$<TARGET_FILE:${program}> "-DSUITES=${all_suites}"
                     -P ${CMAKE_CURRENT_SOURCE_DIR}/check_suites.cmake)
endfunction()

# Finds the gtest suites in the text of a source file.
function(tessera_suites_of file variable)
    set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${file})
    file(STRINGS ${file} lines REGEX "^TEST(_F)?\\(")
    list(TRANSFORM lines REPLACE "^TEST(_F)?\\(([A-Za-z0-9]+),.*" "\\2")
    list(REMOVE_DUPLICATES lines)
    if(NOT lines)
        message(FATAL_ERROR "${file} has no tests")
    endif()
    set(${variable} ${lines} PARENT_SCOPE)
endfunction()
