# Writes a C++ source that holds files as bytes, by their names (tools/web/web_files.h).
#   cmake "-DFILES=a.js;b.wasm.gz" -DOUTPUT=web_files.cpp -P embed_files.cmake
set(bytes)
set(table)
set(number 0)
foreach(file IN LISTS FILES)
    file(READ ${file} hex HEX)
    string(REGEX REPLACE "(................................)" "\\1\n" hex "${hex}")
    string(REGEX REPLACE "([0-9a-f][0-9a-f])" "0x\\1," hex "${hex}")
    get_filename_component(name ${file} NAME)
    string(APPEND bytes "const unsigned char file_${number}[] = {\n${hex}};\n")
    string(APPEND table "        {\"${name}\", std::as_bytes(std::span(file_${number}))},\n")
    math(EXPR number "${number} + 1")
endforeach()
file(WRITE ${OUTPUT} "#include \"tools/web/web_files.h\"

namespace tessera {
namespace {
${bytes}} // namespace

std::span<const WebFile> web_files() {
    static const WebFile files[] = {
${table}    };
    return files;
}

} // namespace tessera
")
