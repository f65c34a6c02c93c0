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
        UNITY_BUILD_MODE GROUP POSITION_INDEPENDENT_CODE ON CXX_VISIBILITY_PRESET hidden C_VISIBILITY_PRESET hidden
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

# Sources of some folders of the module whose CMakeLists.txt this is. Where CMAKE_UNITY_BUILD is set, as
# tools/common.sh does, the folders of an argument (io+container), and single files, are compiled as one
# source: most of what a file costs is reading its headers.
function(tessera_sources variable)
    set(all)
    foreach(group IN LISTS ARGN)
        string(REPLACE "+" ";" folders ${group})
        string(MAKE_C_IDENTIFIER ${group} name)
        foreach(folder IN LISTS folders)
            if(folder MATCHES "cpp$") # one file of a folder
                set(files ${CMAKE_CURRENT_SOURCE_DIR}/${folder})
            else()
                file(GLOB files CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/${folder}/*.cpp)
            endif()
            set_source_files_properties(${files} PROPERTIES UNITY_GROUP ${name})
            list(APPEND all ${files})
        endforeach()
    endforeach()
    set(${variable} ${all} PARENT_SCOPE)
endfunction()
