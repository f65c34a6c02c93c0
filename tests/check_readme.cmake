# Checks the examples of README.md: the C++ and CMake examples must be those of tests/consumers/readme/, and all
# programs there, also those that README.md links to, must do what they promise, even for a missing file.
#   cmake -DROOT=folder [-DREADME_CPP=program -DREADME_C=program] [-DTESSERA=tool -DGLSLANG=validator]
#         [-DFOLDER=to write to] -P check_readme.cmake
# Programs that are not given are not run.
cmake_policy(SET CMP0054 NEW) # quoted strings in if() are no variables

# Returns the text between `begin` and `end`. `begin` must occur exactly once.
function(text_between name text begin end variable)
    string(FIND "${text}" "${begin}" first)
    string(FIND "${text}" "${begin}" last REVERSE)
    if(first LESS 0 OR NOT first EQUAL last)
        message(FATAL_ERROR "${name}: '${begin}' should be there once")
    endif()
    string(LENGTH "${begin}" length)
    math(EXPR first "${first} + ${length}")
    string(SUBSTRING "${text}" ${first} -1 rest)
    string(FIND "${rest}" "${end}" length)
    if(length LESS 0)
        message(FATAL_ERROR "${name}: '${begin}' has no end")
    endif()
    string(SUBSTRING "${rest}" 0 ${length} rest)
    set(${variable} "${rest}" PARENT_SCOPE)
endfunction()

file(READ ${ROOT}/README.md readme)
set(programs ${ROOT}/tests/consumers/readme)

function(check_example language file begin end)
    text_between(README.md "${readme}" "\n```${language}\n" "```" shown)
    file(READ ${programs}/${file} text)
    text_between(${file} "${text}" "${begin}\n" "${end}" meant)
    if(NOT "${shown}" STREQUAL "${meant}")
        message(SEND_ERROR "README.md: the ${language} example is not that of ${file}, which is:\n${meant}")
    endif()
endfunction()

check_example(cpp readme.cpp "// [readme]" "// [/readme]")

# The project beside the programs has the lines of the CMake example, without their comments.
text_between(README.md "${readme}" "\n```cmake\n" "```" shown)
file(READ ${programs}/CMakeLists.txt project)
string(REGEX REPLACE " *#[^\n]*" "" shown "${shown}")
string(REGEX MATCHALL "[^\n]+" lines "${shown}")
foreach(line IN LISTS lines)
    string(FIND "${project}" "${line}\n" place)
    if(place LESS 0)
        message(SEND_ERROR "README.md: ${programs}/CMakeLists.txt has no line '${line}'")
    endif()
endforeach()

# Runs a program. It must exit with `code` and print `part` on either stream.
function(check_run code part)
    execute_process(COMMAND ${ARGN} RESULT_VARIABLE result OUTPUT_VARIABLE out ERROR_VARIABLE err)
    string(FIND "${out}${err}" "${part}" place)
    if(NOT "${result}" STREQUAL "${code}" OR place LESS 0)
        message(SEND_ERROR "${ARGN}: ended with ${result}, not ${code}, or did not say '${part}':\n${out}${err}")
    endif()
endfunction()

set(tess ${FOLDER}/readme.tess)
set(none ${FOLDER}/readme_none.tess)
file(REMOVE ${none})
if(README_CPP)
    check_run(0 "49152 bytes" ${README_CPP} ${tess} write)
    check_run(0 "49152 bytes" ${README_CPP} ${tess})
    check_run(2 "${none}" ${README_CPP} ${none})
endif()
if(README_C AND README_CPP)
    check_run(0 "49152 bytes" ${README_C} ${tess})
    check_run(2 "${none}" ${README_C} ${none})
endif()
if(TESSERA AND GLSLANG)
    check_run(0 "" ${TESSERA} shaders -o ${FOLDER}/readme_shaders)
    file(READ ${FOLDER}/readme_shaders/sample.glsl head)
    file(READ ${programs}/readme.frag.glsl body)
    file(WRITE ${FOLDER}/readme.frag "#version 450 core\n${head}${body}")
    check_run(0 "" ${GLSLANG} -S frag ${FOLDER}/readme.frag)
endif()
