/* The C interface from C: encodes, decodes a part, and sees the errors. Exits 0 when all holds. */
#include "codec/tessera.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define CHECK(condition)                                                                           \
    do {                                                                                           \
        if (!(condition)) {                                                                        \
            fprintf(stderr, "line %d: %s does not hold (%s)\n", __LINE__, #condition,              \
                    tessera_last_error());                                                         \
            return 1;                                                                              \
        }                                                                                          \
    } while (0)

int main(int argc, char** argv) {
    const tessera_texture texture = {{9, 7, 5, 3}, TESSERA_UNORM8, 3};
    const size_t bytes = 9 * 7 * 5 * 3 * 3;
    unsigned char texels[9 * 7 * 5 * 3 * 3], box[4 * 2 * 5 * 1 * 3];
    const uint32_t begin[4] = {5, 2, 0, 1}, end[4] = {9, 4, 5, 2};
    const char* path = argc > 1 ? argv[1] : "c_api_test.tess";
    tessera_texture found;
    tessera_decoder* decoder = NULL;
    size_t i, u, v, s, c;

    for (i = 0; i < bytes; ++i)
        texels[i] = (unsigned char)(i * 2654435761u >> 13);
    CHECK(tessera_encode_file(&texture, texels, bytes - 1, path, TESSERA_MAX_ERROR, 0, 5, 1) == 1);
    CHECK(strlen(tessera_last_error()) > 0);
    CHECK(tessera_encode_file(&texture, texels, bytes, path, TESSERA_QUALITY, 101, 5, 1) == 1);
    CHECK(tessera_encode_file(&texture, texels, bytes, path, TESSERA_MAX_ERROR, 0, 5, 1) == 0);

    CHECK(tessera_open("/nonexistent/x.tess", &decoder) == 2);
    CHECK(decoder == NULL);
    CHECK(tessera_open(path, &decoder) == 0);
    CHECK(tessera_describe(decoder, &found) == 0);
    CHECK(memcmp(&found, &texture, sizeof found) == 0);
    CHECK(tessera_decode_box(decoder, begin, end, box, sizeof box - 1, 1) == 1);
    CHECK(tessera_decode_box(decoder, begin, end, box, sizeof box, 1) == 0);
    i = 0;
    for (v = 2; v < 4; ++v)
        for (u = 5; u < 9; ++u)
            for (s = 0; s < 5; ++s)
                for (c = 0; c < 3; ++c, ++i)
                    CHECK(box[i] == texels[(((v * 9 + u) * 3 + 1) * 5 + s) * 3 + c]);
    tessera_close(decoder);
    tessera_close(NULL);
    return remove(path) == 0 ? 0 : 1;
}
