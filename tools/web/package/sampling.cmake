# Writes the GLSL of decoder_glsl that samples textures as a JavaScript module.
#   cmake "-DFILES=surface.glsl;octahedral.glsl" -DOUTPUT=sampling.js -P sampling.cmake
set(text)
foreach(file IN LISTS FILES)
    file(READ ${file} content)
    string(REGEX REPLACE "#include [^\n]*\n" "" content "${content}")
    string(REGEX REPLACE " *//[^\n]*" "" content "${content}")
    string(REGEX REPLACE "\n\n+" "\n" content "${content}")
    string(APPEND text "${content}")
endforeach()
file(WRITE ${OUTPUT} "// Generated from Tessera's decoder_glsl/shaders: GLSL that samples textures.\n"
                     "export const sampling = `${text}`;\n")
