/* The C example that README.md links to; tests/check_readme.cmake runs it.
 *   readme_c FILE.tess    reads a box of the file */
#include <tessera/codec/tessera.h>
int read_box(const char* path, void* texels, size_t bytes) {
    const uint32_t begin[4] = {0, 0, 0, 0}, end[4] = {16, 16, 8, 8}; /* u, v, s, t */
    tessera_decoder* decoder = NULL;
    int error = tessera_open_path(path, NULL, &decoder);
    if (error == TESSERA_OK)
        error = tessera_decode_box(decoder, begin, end, texels, bytes, NULL); /* NULL: defaults */
    tessera_close(decoder);
    return error; /* 0 or an error code; tessera_last_error() has the message */
}

#include <stdio.h>

int main(int argc, char** argv) {
    static unsigned char texels[16 * 16 * 8 * 8 * 3];
    const int error = read_box(argc > 1 ? argv[1] : "readme.tess", texels, sizeof texels);
    if (error != TESSERA_OK) {
        fprintf(stderr, "error: %s\n", tessera_last_error());
        return error;
    }
    printf("%u bytes\n", (unsigned)sizeof texels);
    return 0;
}
