# Fails when a file includes a header of a layer that its own does not see.
#   cmake -DROOT=folder -P check_layering.cmake
cmake_policy(SET CMP0057 NEW) # IN_LIST
set(sees_format format)
set(sees_codec codec format)
set(sees_decoder_glsl decoder_glsl format)
set(sees_corpus corpus format)
set(sees_tools tools codec corpus decoder_glsl format)
set(layers format codec decoder_glsl corpus tools)

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
            elseif(line MATCHES "[<\"](format|codec|decoder_glsl|corpus|tools|tests)/" AND
                   NOT CMAKE_MATCH_1 IN_LIST sees_${layer})
                message(SEND_ERROR "${name}: ${layer} must not see ${CMAKE_MATCH_1}: ${line}")
            elseif(line MATCHES "\"([^\"/]*)\"" AND NOT layer STREQUAL "decoder_glsl")
                message(SEND_ERROR "${name}: include without its folder: ${line}")
            endif()
        endforeach()
    endforeach()
endforeach()
if(seen EQUAL 0)
    message(FATAL_ERROR "no sources below '${ROOT}'")
endif()
message(STATUS "${seen} files checked")
