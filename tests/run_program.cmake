# run(COMMAND...) stops with all that the program printed if it fails. Otherwise `said` has that text.
function(run)
    execute_process(COMMAND ${ARGN} OUTPUT_VARIABLE said ERROR_VARIABLE said RESULT_VARIABLE code)
    if(NOT code EQUAL 0)
        message(FATAL_ERROR "${ARGN}: ${code}\n${said}")
    endif()
    set(said "${said}" PARENT_SCOPE)
endfunction()
