# Writes the shaders of tessera_webgpu.js: FOLDER/MACROS/NAME.wgsl.
#   cmake -DTOOL=build/bin/tessera -DFOLDER=package/wgsl -P wgsl.cmake
set(plain tree levels corrections order items groups texels border filter)
set(half texels border filter)
set(plain_predicted texels)
set(half_predicted texels)
set(of_half -D TSR_OUTPUT_HALF)
set(of_plain_predicted -D TSR_PREDICTED_TILES)
set(of_half_predicted -D TSR_OUTPUT_HALF -D TSR_PREDICTED_TILES)
file(REMOVE_RECURSE ${FOLDER})
foreach(macros plain half plain_predicted half_predicted)
    execute_process(COMMAND ${TOOL} shaders -o ${FOLDER}.all --dialect wgsl ${of_${macros}}
                    OUTPUT_QUIET COMMAND_ERROR_IS_FATAL ANY)
    foreach(name ${${macros}})
        file(COPY ${FOLDER}.all/${name}.comp.wgsl DESTINATION ${FOLDER}/${macros})
    endforeach()
    file(REMOVE_RECURSE ${FOLDER}.all)
endforeach()
