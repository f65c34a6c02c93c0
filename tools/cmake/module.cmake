# A module sees the modules it uses and nothing else: the link graph is the order of the layers
# (tests/check_layering.cmake checks the includes).

# tessera_module(NAME HEADERS folder SOURCES ... USES ...): the static library tessera_NAME, known as
# tessera::NAME. Position independent with hidden symbols, so that shared libraries can be made of it;
# the namespace of public headers is exported (TESSERA_PUBLIC in format/status.h).
#
# The headers that stand directly in a module's folder are public. Users include them as
# <tessera/codec/encoder.h>: copies below PROJECT_BINARY_DIR/include, in which the includes of our
# headers say so too. Our own code includes the sources, "codec/encoder.h" (tessera_build).
function(tessera_module name)
    cmake_parse_arguments(ARG "" "HEADERS" "SOURCES;USES" ${ARGN})
    add_library(tessera_${name} STATIC ${ARG_SOURCES})
    add_library(tessera::${name} ALIAS tessera_${name})
    set_target_properties(tessera_${name} PROPERTIES EXPORT_NAME ${name} CXX_EXTENSIONS OFF
        POSITION_INDEPENDENT_CODE ON CXX_VISIBILITY_PRESET hidden C_VISIBILITY_PRESET hidden
        VISIBILITY_INLINES_HIDDEN ON)
    target_include_directories(tessera_${name} INTERFACE
        $<BUILD_INTERFACE:${PROJECT_BINARY_DIR}/include>
        $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
    # Public headers want C++20; a project that has no C++ could not be told so.
    if(PROJECT_IS_TOP_LEVEL OR "CXX" IN_LIST tessera_parent_languages)
        target_compile_features(tessera_${name} INTERFACE $<BUILD_INTERFACE:cxx_std_20>)
    endif()
    # A program in C links our C++ with the C compiler.
    target_link_libraries(tessera_${name} PUBLIC ${ARG_USES}
                          INTERFACE $<$<LINK_LANGUAGE:C>:stdc++;m>
                          PRIVATE $<BUILD_INTERFACE:tessera_strict>)
    # Hosts run the library on threads with small stacks (codec/tessera.h). Without optimisation and
    # with sanitizers, frames are larger.
    if(PROJECT_IS_TOP_LEVEL AND NOT TESSERA_SANITIZE)
        target_compile_options(tessera_${name} PRIVATE
            $<$<AND:$<CXX_COMPILER_ID:GNU>,$<CONFIG:Release,RelWithDebInfo>>:-Werror=frame-larger-than=16384>)
    endif()
    tessera_public_headers(${ARG_HEADERS})
endfunction()

function(tessera_public_headers module)
    file(GLOB headers CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/${module}/*.h)
    set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${headers})
    foreach(header IN LISTS headers)
        get_filename_component(name ${header} NAME)
        file(READ ${header} text)
        string(REGEX REPLACE "#include \"(format|codec|decoder_glsl)/" "#include \"tessera/\\1/" text "${text}")
        file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/include/tessera/${module}/${name} CONTENT "${text}" @ONLY)
    endforeach()
endfunction()

# Links all of the static libraries that follow into the shared library `target`, used or not.
function(tessera_link_whole target)
    foreach(library IN LISTS ARGN)
        set(file $<TARGET_FILE:${library}>)
        if(MSVC)
            target_link_options(${target} PRIVATE /WHOLEARCHIVE:${file})
        elseif(APPLE)
            target_link_libraries(${target} PRIVATE -Wl,-force_load ${file})
        else()
            target_link_libraries(${target} PRIVATE -Wl,--whole-archive ${file} -Wl,--no-whole-archive)
        endif()
        add_dependencies(${target} ${library})
    endforeach()
endfunction()

# Removes the sources of other systems from the list `variable`: NAME_posix${suffix}.cpp or
# NAME_windows${suffix}.cpp.
function(tessera_without_other_systems variable suffix)
    set(files ${${variable}})
    set(other_systems windows)
    if(WIN32)
        set(other_systems posix)
    endif()
    list(FILTER files EXCLUDE REGEX "_${other_systems}${suffix}\\.cpp$")
    foreach(file IN LISTS files)
        if(file MATCHES "_windows${suffix}\\.cpp$") # <windows.h> defines macros such as `near`
            set_source_files_properties(${file} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
        endif()
    endforeach()
    set(${variable} ${files} PARENT_SCOPE)
endfunction()

# Sets `variable` to the sources of folders, and to single .cpp files, of the module whose CMakeLists.txt this is.
# NAME_posix.cpp and NAME_windows.cpp implement the same header, each for its systems.
function(tessera_sources variable)
    set(all)
    foreach(entry IN LISTS ARGN)
        if(entry MATCHES "\\.cpp$")
            list(APPEND all ${CMAKE_CURRENT_SOURCE_DIR}/${entry})
        else()
            file(GLOB files CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/${entry}/*.cpp)
            list(APPEND all ${files})
        endif()
    endforeach()
    tessera_without_other_systems(all "")
    set(${variable} ${all} PARENT_SCOPE)
endfunction()
