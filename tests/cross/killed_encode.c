/* Encodes a texture with a journal to a file whose name is not ASCII, and may end in the middle of
 * it as if it were killed. Continues what an earlier run left. Prints how often texels were read.
 *   killed_encode READS   ends with exit code 9 at this read; 0: encodes to the end */
#include <tessera/codec/tessera.h>

#include <stdio.h>
#include <stdlib.h>

enum { kill_code = 9 };
static const char* const file = "gr\xC3\xB6\xC3\x9F"
                                "e \xE2\x82\xAC.tess";
static unsigned long reads, last_read;

static int read_texels(void* user, const uint32_t begin[4], const uint32_t end[4], void* out,
                       size_t out_bytes) {
    unsigned char* texel = out;
    uint32_t u, v, s, t;
    (void)user;
    (void)out_bytes;
    if (++reads == last_read)
        _Exit(kill_code); /* nothing is cleaned up */
    for (v = begin[1]; v < end[1]; ++v)
        for (u = begin[0]; u < end[0]; ++u)
            for (t = begin[3]; t < end[3]; ++t)
                for (s = begin[2]; s < end[2]; ++s)
                    *texel++ = (unsigned char)(3 * u + 5 * v + 7 * s * t + u * v % 11);
    return 0;
}

int main(int argc, char** argv) {
    tessera_texel_source source;
    tessera_encode_options options;
    tessera_encode_report report;
    last_read = argc > 1 ? strtoul(argv[1], NULL, 10) : 0;
    tessera_texel_source_init(&source);
    source.texture.size[0] = source.texture.size[1] = 96;
    source.texture.size[2] = source.texture.size[3] = 4;
    source.texture.type = TESSERA_UNORM8;
    source.texture.channels = 1;
    source.read = read_texels;
    tessera_encode_options_init(&options);
    options.effort = 1;
    options.threads = 1;
    options.tile[0] = options.tile[1] = 16;
    options.tile[2] = options.tile[3] = 4;
    options.journal = TESSERA_JOURNAL_RESUME;
    tessera_encode_report_init(&report);
    if (tessera_encode_to_path(&source, file, &options, &report) != TESSERA_OK) {
        fprintf(stderr, "%s\n", tessera_last_error());
        return 1;
    }
    printf("%lu reads, %lu bytes\n", reads, (unsigned long)report.file_bytes);
    return 0;
}
