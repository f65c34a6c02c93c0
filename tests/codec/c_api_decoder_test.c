/* The C interface of the decode-only library: decodes a file whole and in two halves.
 *   c_api_decoder_test FILE.tess */
#include "codec/tessera.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static int failed(int error) {
    fprintf(stderr, "%s: %s\n", tessera_error_name(error), tessera_last_error());
    return 1;
}

int main(int argc, char** argv) {
    const uint32_t origin[4] = {0, 0, 0, 0};
    uint32_t middle[4], half_end[4];
    tessera_decoder* decoder = NULL;
    tessera_texture texture;
    uint64_t bytes = 0, first = 0;
    unsigned char *whole, *halves;
    int error = tessera_open_path(argc > 1 ? argv[1] : "", NULL, &decoder);
    if (error == 0)
        error = tessera_get_texture(decoder, &texture);
    if (error == 0)
        error = tessera_box_bytes(&texture, origin, texture.size, &bytes);
    if (error != 0)
        return failed(error);
    whole = malloc((size_t)bytes);
    halves = calloc(1, (size_t)bytes);
    if (whole == NULL || halves == NULL)
        return 1;
    /* v varies slowest, so the halves along v follow each other in memory. */
    memcpy(half_end, texture.size, sizeof half_end);
    memcpy(middle, origin, sizeof middle);
    half_end[1] = middle[1] = texture.size[1] / 2;
    error = tessera_decode_box(decoder, origin, texture.size, whole, (size_t)bytes, NULL);
    if (error == 0)
        error = tessera_box_bytes(&texture, origin, half_end, &first);
    if (error == 0)
        error = tessera_decode_box(decoder, origin, half_end, halves, (size_t)first, NULL);
    if (error == 0)
        error = tessera_decode_box(decoder, middle, texture.size, halves + first,
                                   (size_t)(bytes - first), NULL);
    if (error != 0)
        return failed(error);
    error = memcmp(whole, halves, (size_t)bytes);
    free(whole);
    free(halves);
    tessera_close(decoder);
    return error == 0 ? 0 : 1;
}
