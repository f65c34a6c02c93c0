# Compiles for wasm32-wasi with Debian's clang-19, in custom commands, because CMake's own targets are built for this
# machine.
set(tessera_wasm_packages clang-19 lld-19 libc++-19-dev-wasm32 libc++abi-19-dev-wasm32
    libclang-rt-19-dev-wasm32 wasi-libc zopfli)

# Sets `variable` to TRUE if compiler, linker, libc++ and the C library for wasm32-wasi are installed. Success is
# cached until the compiler changes.
function(tessera_find_wasm_compiler variable)
    find_program(TESSERA_WASM_CXX clang++-19)
    if(TESSERA_WASM_CXX AND NOT TESSERA_WASM_TRIED STREQUAL TESSERA_WASM_CXX)
        set(probe ${CMAKE_CURRENT_BINARY_DIR}/probe)
        file(WRITE ${probe}.cpp "#include <vector>\nint main() { return int(std::vector<int>(3).size()); }\n")
        execute_process(COMMAND ${TESSERA_WASM_CXX} --target=wasm32-wasi -fno-exceptions ${probe}.cpp -o ${probe}.wasm
                        RESULT_VARIABLE failed OUTPUT_QUIET ERROR_QUIET)
        if(failed EQUAL 0)
            set(TESSERA_WASM_TRIED ${TESSERA_WASM_CXX} CACHE INTERNAL "The compiler that passed the test")
        endif()
    endif()
    if(TESSERA_WASM_CXX AND TESSERA_WASM_TRIED STREQUAL TESSERA_WASM_CXX)
        set(${variable} TRUE PARENT_SCOPE)
    else()
        set(${variable} FALSE PARENT_SCOPE)
    endif()
endfunction()

# Sets `variable` to the sources of the decoder. They are those of the native targets without the parts that browsers
# do not need: writing files, meshes (Debian has no Draco for wasm), the C interface and other processors' kernels.
function(tessera_wasm_sources variable)
    set(all)
    foreach(target tessera_format tessera_decoder)
        get_target_property(files ${target} SOURCES)
        list(APPEND all ${files})
    endforeach()
    list(FILTER all INCLUDE REGEX "^/.*\\.cpp$")
    list(FILTER all EXCLUDE REGEX
         "/format/(surface/|io/(output_|system_calls_|unfinished)|container/container_(writer|validate)|geometry|sampler)")
    list(FILTER all EXCLUDE REGEX "/(c_api/c_api_decode|kernels/kernels_(avx2|scalar))\\.cpp$")
    file(GLOB own CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/decoder/*.cpp)
    set(${variable} ${all} ${own} ${PROJECT_SOURCE_DIR}/tools/view/layer_files.cpp PARENT_SCOPE)
endfunction()

# Sets `variable` to the further sources of the decoder that uses WebGPU.
function(tessera_webgpu_sources variable)
    set(batch ${PROJECT_SOURCE_DIR}/decoder_glsl/batch)
    set(${variable} ${CMAKE_CURRENT_SOURCE_DIR}/webgpu/batches.cpp ${batch}/decode_batch.cpp
        ${batch}/decode_tables.cpp ${batch}/plain_pixels.cpp ${batch}/tree_size.cpp PARENT_SCOPE)
endfunction()

# tessera_wasm(OUTPUT source...) builds a module. Sources with equal options are compiled as one source, like with
# CMAKE_UNITY_BUILD. Optimisation at link time makes the packed module 3 % smaller.
function(tessera_wasm output)
    # A throw stops the instance (runtime.cpp). -fignore-exceptions accepts the handlers in our code, but libc++ must
    # be told separately that there are no exceptions.
    set(flags --target=wasm32-wasi -std=c++20 -msimd128 -flto -DNDEBUG -DTESSERA_WITHOUT_ZSTD
        -fignore-exceptions -D_LIBCPP_HAS_NO_EXCEPTIONS -fno-rtti -ffp-contract=off -ffunction-sections -fdata-sections
        -fvisibility=hidden -I${PROJECT_SOURCE_DIR}
        -include ${PROJECT_SOURCE_DIR}/tools/web/decoder/threads.h)
    # Code that runs once per file or once per tile is optimised for size.
    set(small format format/io format/container codec/texels codec/decode tools/view tools/web/webgpu decoder_glsl/batch)
    set(small_files code_tables coding_parameters dct_basis default_parameters payload prediction scan_order sine_basis
        tile_coding exports facts ranged_bytes)
    set(text_Oz)
    set(text_O2)
    foreach(source IN LISTS ARGN)
        get_filename_component(folder ${source} DIRECTORY)
        get_filename_component(name ${source} NAME_WE)
        file(RELATIVE_PATH folder ${PROJECT_SOURCE_DIR} ${folder})
        set(level O2)
        if(folder IN_LIST small OR name IN_LIST small_files)
            set(level Oz)
        endif()
        string(APPEND text_${level} "#include \"${source}\"\n")
    endforeach()
    set(objects)
    get_filename_component(work ${output} NAME_WE)
    set(work ${CMAKE_CURRENT_BINARY_DIR}/wasm/${work})
    foreach(level Oz O2)
        file(CONFIGURE OUTPUT ${work}/${level}.cpp CONTENT "${text_${level}}" @ONLY)
        add_custom_command(OUTPUT ${work}/${level}.o
            COMMAND ${CMAKE_CXX_COMPILER_LAUNCHER} ${TESSERA_WASM_CXX} ${flags} -${level}
                    -MD -MF ${work}/${level}.d -c ${work}/${level}.cpp -o ${work}/${level}.o
            DEPENDS ${work}/${level}.cpp DEPFILE ${work}/${level}.d
            COMMENT "wasm: -${level}" VERBATIM)
        list(APPEND objects ${work}/${level}.o)
    endforeach()
    add_custom_command(OUTPUT ${output}
        COMMAND ${TESSERA_WASM_CXX} --target=wasm32-wasi -mexec-model=reactor -O2 -flto ${objects} -o ${output}
                -Wl,--gc-sections -Wl,--strip-all -Wl,--export=malloc
        DEPENDS ${objects} COMMENT "wasm: linking" VERBATIM)
endfunction()
