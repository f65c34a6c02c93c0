# Fails unless check_layering.cmake reports every fault of fixtures/layering and nothing else.
#   cmake -DFOLDER=tests -P check_layering_notices.cmake
set(expected
    "format/sees_codec.h: format must not see codec: codec/encoder.h"
    "format/relative.cpp: relative include: #include \"../codec/encoder.h\""
    "codec/sees_tile.h: a public header must not include the internal codec/tile/tile_coding.h"
    "codec/tile/sees_encode.cpp: its folder comes before that of codec/encode/rate_control.h"
    "codec/cellar/unknown.cpp: codec has no folder cellar in the order of its folders"
    "codec/decode/no_folder.cpp: include without its folder: #include \"coarse_fill.h\""
    "codec/decode/sees_network.cpp: only tools may see the network: #include <curl/curl.h>"
    "corpus/sees_io.cpp: format/io/crc32c.h is internal to format"
    "tools/verbs/sees_tile.cpp: codec/tile/tile_coding.h is internal to codec"
    "tools/support/sees_verbs.cpp: its folder comes before that of tools/verbs/command.h"
    "tools/verbs/sees_lab.cpp: its folder comes before that of tools/lab/rd/plot.h"
    "decoder_glsl/README.md lists the folders batch shaders, but their order is shaders batch cache gl residency draw"
    "3 public headers, at most 2 are wanted")
execute_process(COMMAND ${CMAKE_COMMAND} -DROOT=${FOLDER}/fixtures/layering -Dmost_public_headers=2
                        -P ${FOLDER}/check_layering.cmake
                RESULT_VARIABLE code OUTPUT_VARIABLE said ERROR_VARIABLE said)
if(code EQUAL 0)
    message(SEND_ERROR "the faults pass")
endif()
string(REGEX REPLACE "[ \n]+" " " said "${said}") # CMake wraps lines
foreach(text IN LISTS expected)
    string(FIND "${said}" "${text}" at)
    if(at LESS 0)
        message(SEND_ERROR "not reported: ${text}")
    endif()
endforeach()
list(LENGTH expected wanted)
string(REGEX MATCHALL "CMake Error" errors "${said}")
list(LENGTH errors found)
if(NOT found EQUAL wanted)
    message(SEND_ERROR "${found} faults are reported instead of ${wanted}: ${said}")
endif()
