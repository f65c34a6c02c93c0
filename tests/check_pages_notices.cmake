# Fails unless check_pages.py reports every fault of fixtures/pages, and nothing else.
#   cmake -DCHECK="python3;check_pages.py" -DFOLDER=fixtures/pages -P check_pages_notices.cmake
set(expected
"format/FORMAT.md:5: FORMAT.md has no 1.2
format/header.h:1: FORMAT.md has no 1.3
format/header.h:2: no GONE.md
format/header.h:2: no codec/gone.cpp
format/page.md:3: FORMAT.md has no heading #12-trailer
format/page.md:4: no GONE.md
format/page.md:4: no format/gone.h
format/page.md:6: 113 columns, prose has at most 110
tests/reference/decoder.cpp:1: FORMAT.md has no 1.4
")
execute_process(COMMAND ${CHECK} ${FOLDER} RESULT_VARIABLE code OUTPUT_VARIABLE reported)
if(NOT code EQUAL 1 OR NOT reported STREQUAL expected)
    message(FATAL_ERROR "ended with ${code} and reported\n${reported}instead of\n${expected}")
endif()
