/* A C program that uses Tessera: encodes a gradient, opens the file, reads a box and compares.
 *   consumer_c [FILE.tess]   also writes the encoded gradient to FILE.tess, if given */
#include <tessera/codec/tessera.h>

#include <stdio.h>
#include <stdlib.h>

enum { u_size = 32, v_size = 16, s_size = 4, t_size = 4 };

static unsigned char gradient(unsigned u, unsigned v, unsigned s, unsigned t) {
    return (unsigned char)(4 * u + 4 * v + 2 * s + 2 * t);
}

static int failed(const char* what, int error) {
    fprintf(stderr, "%s: %s: %s\n", what, tessera_error_name(error), tessera_last_error());
    return 1;
}

static int encode(const char* path, void** file, size_t* file_bytes) {
    static unsigned char texels[v_size * u_size * t_size * s_size];
    unsigned char* texel = texels;
    tessera_texel_source source;
    tessera_encode_options options;
    tessera_encode_report report;
    unsigned u, v, s, t;
    int error;

    for (v = 0; v < v_size; ++v)
        for (u = 0; u < u_size; ++u)
            for (t = 0; t < t_size; ++t)
                for (s = 0; s < s_size; ++s)
                    *texel++ = gradient(u, v, s, t);
    tessera_texel_source_init(&source);
    source.texture.size[0] = u_size;
    source.texture.size[1] = v_size;
    source.texture.size[2] = s_size;
    source.texture.size[3] = t_size;
    source.texture.type = TESSERA_UNORM8;
    source.texture.channels = 1;
    source.texels = texels;
    source.texel_bytes = sizeof texels;
    tessera_encode_options_init(&options);
    options.rate_kind = TESSERA_MAX_ERROR;
    options.rate_value = 1;
    tessera_encode_report_init(&report);
    error = tessera_encode_to_memory(&source, file, file_bytes, &options, &report);
    if (error == 0)
        printf("tessera %s: %u texels in %u bytes, largest error %g\n", tessera_version(),
               (unsigned)sizeof texels, (unsigned)report.file_bytes, report.max_error);
    if (error == 0 && path != NULL)
        error = tessera_encode_to_path(&source, path, &options, NULL);
    return error;
}

static int compare(tessera_decoder* decoder) {
    const uint32_t begin[4] = {7, 3, 1, 0}, end[4] = {29, 11, 3, 4};
    tessera_texture texture;
    uint64_t bytes = 0;
    unsigned char *texels, *texel;
    unsigned u, v, s, t, wrong = 0;
    int error = tessera_get_texture(decoder, &texture);
    if (error == 0)
        error = tessera_box_bytes(&texture, begin, end, &bytes);
    if (error != 0)
        return failed("box", error);
    texel = texels = malloc((size_t)bytes);
    if (texels == NULL)
        return 1;
    error = tessera_decode_box(decoder, begin, end, texels, (size_t)bytes, NULL);
    if (error == 0)
        for (v = begin[1]; v < end[1]; ++v)
            for (u = begin[0]; u < end[0]; ++u)
                for (t = begin[3]; t < end[3]; ++t)
                    for (s = begin[2]; s < end[2]; ++s)
                        wrong += abs(*texel++ - gradient(u, v, s, t)) > 1;
    free(texels);
    if (error != 0)
        return failed("decode", error);
    if (wrong > 0)
        fprintf(stderr, "%u texels of the box are wrong\n", wrong);
    return wrong > 0;
}

int main(int argc, char** argv) {
    tessera_decoder* decoder = NULL;
    void* file = NULL;
    size_t file_bytes = 0;
    int wrong, error = encode(argc > 1 ? argv[1] : NULL, &file, &file_bytes);
    if (error != 0)
        return failed("encode", error);
    error = tessera_open_memory(file, file_bytes, NULL, &decoder);
    wrong = error != 0 ? failed("open", error) : compare(decoder);
    tessera_close(decoder);
    tessera_free(file);
    return wrong;
}
