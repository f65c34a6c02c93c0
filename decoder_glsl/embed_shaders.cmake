# Writes a C++ source that holds every shader file as text. Usage:
#   cmake -DFOLDER=shaders -DOUTPUT=shader_files.cpp -P embed_shaders.cmake
file(GLOB files ${FOLDER}/*.glsl)
string(CONCAT text "#include \"decoder_glsl/shaders/shader_files.h\"\n\nnamespace tessera {\n\n"
       "std::span<const ShaderFile> shader_files() {\n    static const ShaderFile files[] = {\n")
foreach(file IN LISTS files)
    file(READ ${file} content)
    get_filename_component(name ${file} NAME)
    string(APPEND text "{\"${name}\", R\"glsl(${content})glsl\"},\n")
endforeach()
string(APPEND text "    };\n    return files;\n}\n\n} // namespace tessera\n")
file(WRITE ${OUTPUT} "${text}")
