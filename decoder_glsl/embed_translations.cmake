# Writes a C++ source that holds the translated shaders, as zstd packed them. Usage:
#   cmake -DARCHIVE=translations.zst -DOUTPUT=translations.cpp -P embed_translations.cmake
file(READ ${ARCHIVE} hex HEX)
string(REGEX REPLACE "(................................)" "\\1\n" hex "${hex}")
string(REGEX REPLACE "([0-9a-f][0-9a-f])" "0x\\1," hex "${hex}")
file(WRITE ${OUTPUT} "#include \"decoder_glsl/shaders/translated_shaders.h\"

namespace tessera {

std::span<const std::byte> packed_translations() {
    static const unsigned char bytes[] = {
${hex}};
    return std::as_bytes(std::span(bytes));
}

} // namespace tessera
")
