# Fails if a file includes a header that it must not see. The rules:
#   1. A module sees the modules below it (sees_*).
#   2. A header directly in format/, codec/ or decoder_glsl/ is public. A header in a folder below is
#      internal. tools and corpus must not include internal headers of these modules, and public
#      headers must not include any. codec and decoder_glsl may include format's internal headers.
#   3. The folders of a module see themselves and those before them in the order of folders_*. Files
#      directly in a module's folder see all of it. tools/lab, the laboratory, comes last, so that no
#      folder of the product sees it.
#   4. There are at most 20 public headers.
#   5. The README.md of a module in listed_in_readme lists its folders in that order: "| `a/`, `b/` |"
#      or "    a/ ...".
#   cmake -DROOT=folder -P check_layering.cmake
cmake_policy(SET CMP0057 NEW) # IN_LIST
set(layers format codec decoder_glsl corpus tools)
set(sees_format format)
set(sees_codec codec format)
set(sees_decoder_glsl decoder_glsl format)
set(sees_corpus corpus format)
set(sees_tools tools codec corpus decoder_glsl format)

set(folders_format tables io tile surface container)
set(folders_codec kernels search_kernels tile texels entropy reconstruct decode tile_encoder journal fit pass trials encode compare c_api)
set(folders_decoder_glsl shaders batch cache gl residency draw)
set(folders_corpus picture surface model photographs trace model_surface layers fit)
set(folders_tools support http picture texture_io scenes view gltf web server page verbs lab)
set(built_on_insides codec decoder_glsl) # may include internal headers of format
set(public_modules format codec decoder_glsl)
set(web_host "^tools/web/webgpu/") # the shaders' host for WebGPU, which uses decoder_glsl/batch like gl/ and residency/
set(listed_in_readme codec decoder_glsl tools)
if(NOT DEFINED most_public_headers)
    set(most_public_headers 20)
endif()

# The index of the folder of `file`, such as codec/encode/encoder.cpp, in its module's order of
# folders; -1 for a file directly in the module.
function(rank_of file variable)
    string(REPLACE "/" ";" parts ${file})
    list(LENGTH parts depth)
    list(GET parts 0 module)
    list(GET parts 1 folder)
    set(rank -1)
    if(depth GREATER 2)
        list(FIND folders_${module} ${folder} rank)
        if(rank LESS 0)
            message(SEND_ERROR "${file}: ${module} has no folder ${folder} in the order of its folders")
        endif()
    endif()
    set(${variable} ${rank} PARENT_SCOPE)
endfunction()

# Whether `file` is a header that users see.
function(is_public file variable)
    set(answer FALSE)
    if(file MATCHES "^(format|codec|decoder_glsl)/[^/]*\\.h$")
        set(answer TRUE)
    endif()
    set(${variable} ${answer} PARENT_SCOPE)
endfunction()

function(check_include layer name target)
    string(REGEX MATCH "^[^/]*" module "${target}")
    if(NOT module IN_LIST sees_${layer})
        message(SEND_ERROR "${name}: ${layer} must not see ${module}: ${target}")
        return()
    endif()
    is_public(${target} target_is_public)
    is_public(${name} name_is_public)
    if(name_is_public AND NOT target_is_public)
        message(SEND_ERROR "${name}: a public header must not include the internal ${target}")
    elseif(NOT module STREQUAL layer)
        if(module IN_LIST public_modules AND NOT target_is_public AND NOT layer IN_LIST built_on_insides AND
           NOT (name MATCHES "${web_host}" AND target MATCHES "^decoder_glsl/batch/"))
            message(SEND_ERROR "${name}: ${target} is internal to ${module}")
        endif()
    else()
        rank_of(${name} own)
        rank_of(${target} other)
        if(own GREATER -1 AND other GREATER own)
            message(SEND_ERROR "${name}: its folder comes before that of ${target}")
        endif()
    endif()
endfunction()

set(seen 0)
foreach(layer IN LISTS layers)
    file(GLOB_RECURSE files ${ROOT}/${layer}/*.h ${ROOT}/${layer}/*.cpp ${ROOT}/${layer}/*.inl
         ${ROOT}/${layer}/*.glsl ${ROOT}/${layer}/*.comp ${ROOT}/${layer}/*.frag)
    foreach(file IN LISTS files)
        math(EXPR seen "${seen} + 1")
        file(STRINGS ${file} includes REGEX "^[ \t]*#[ \t]*include[ \t]*[<\"]")
        file(RELATIVE_PATH name ${ROOT} ${file})
        foreach(line IN LISTS includes)
            if(line MATCHES "\"\\.\\.?/|\"[^\"]*/\\.\\./")
                message(SEND_ERROR "${name}: relative include: ${line}")
            elseif(line MATCHES "[<\"]((format|codec|decoder_glsl|corpus|tools|tests)/[^\">]*)")
                check_include(${layer} ${name} ${CMAKE_MATCH_1})
            elseif(line MATCHES "[<\"](curl/|httplib)" AND NOT layer STREQUAL "tools")
                message(SEND_ERROR "${name}: only tools may see the network: ${line}")
            elseif(line MATCHES "\"([^\"/]*)\"" AND NOT layer STREQUAL "decoder_glsl")
                message(SEND_ERROR "${name}: include without its folder: ${line}")
            endif()
        endforeach()
    endforeach()
endforeach()
if(seen EQUAL 0)
    message(FATAL_ERROR "no sources below '${ROOT}'")
endif()

foreach(module IN LISTS listed_in_readme)
    set(page ${ROOT}/${module}/README.md)
    if(EXISTS ${page})
        file(STRINGS ${page} rows REGEX "^([|] `|    )[a-z_]+/(`| |$)")
        list(TRANSFORM rows REPLACE "^([|][^|]*|    [a-z_]+/).*" "\\1")
        string(REGEX MATCHALL "[a-z_]+/" rows "${rows}")
        list(TRANSFORM rows REPLACE "/" "")
        list(JOIN rows " " rows)
        list(JOIN folders_${module} " " order)
        if(NOT rows STREQUAL order)
            message(SEND_ERROR "${module}/README.md lists the folders ${rows}, but their order is ${order}")
        endif()
    endif()
endforeach()

file(GLOB public ${ROOT}/format/*.h ${ROOT}/codec/*.h ${ROOT}/decoder_glsl/*.h)
list(LENGTH public public_count)
if(public_count GREATER most_public_headers)
    message(SEND_ERROR "${public_count} public headers, at most ${most_public_headers} are wanted")
endif()
message(STATUS "${seen} files checked, ${public_count} public headers")
