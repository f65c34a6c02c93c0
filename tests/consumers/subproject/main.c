/* A C program of a project that builds Tessera's decoder as a part of itself. Decodes the file
 * that the macro DECODED names. */
#include <tessera/codec/tessera.h>

#include <stdio.h>
#include <stdlib.h>

int main(void) {
    const uint32_t origin[4] = {0, 0, 0, 0};
    tessera_decoder* decoder = NULL;
    tessera_texture texture;
    uint64_t bytes = 0;
    void* texels = NULL;
    int error = tessera_open_path(DECODED, NULL, &decoder);
    if (error == 0)
        error = tessera_get_texture(decoder, &texture);
    if (error == 0)
        error = tessera_box_bytes(&texture, origin, texture.size, &bytes);
    if (error == 0 && (texels = malloc((size_t)bytes)) != NULL)
        error = tessera_decode_box(decoder, origin, texture.size, texels, (size_t)bytes, NULL);
    if (error != 0)
        fprintf(stderr, "%s: %s\n", tessera_error_name(error), tessera_last_error());
    free(texels);
    tessera_close(decoder);
    return error != 0 || texels == NULL;
}
