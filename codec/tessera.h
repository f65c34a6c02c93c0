/* Tessera for C and other languages.
 *
 * Texels are dense arrays in the order v, u, t, s (s fastest) with the channels of a texel adjacent;
 * a sample is one byte, or an IEEE 754 half. Functions return 0 or an error code (the tool's exit
 * codes: 1 bad argument, 2 input/output, 3 invalid file, 4 runtime, 5 not supported) and then leave
 * a sentence in tessera_last_error(), which belongs to the calling thread. A handle may be used by
 * many threads at once. The interface is not frozen before version 1.0.
 */
#ifndef TESSERA_H
#define TESSERA_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct tessera_decoder tessera_decoder;

typedef enum { TESSERA_UNORM8 = 0, TESSERA_HALF16 = 1 } tessera_sample_type;

typedef struct {
    uint32_t size[4]; /* texels along u, v, s, t */
    tessera_sample_type type;
    uint32_t channels; /* 1 to 4 */
} tessera_texture;

typedef enum {
    TESSERA_QUALITY = 0,  /* 1 to 100 */
    TESSERA_PSNR = 1,     /* dB */
    TESSERA_BPT = 2,      /* bits per texel, not exceeded */
    TESSERA_BYTES = 3,    /* bytes of the file, not exceeded */
    TESSERA_MAX_ERROR = 4 /* largest error of any sample, 0: lossless */
} tessera_rate;

/* The sentence that goes with the last error of this thread; "" before the first. */
const char* tessera_last_error(void);

/* Encodes texels[texel_bytes] into the file `path`. effort 0..9, threads 0: all cores. */
int tessera_encode_file(const tessera_texture* texture, const void* texels, size_t texel_bytes,
                        const char* path, tessera_rate rate, double rate_value, int effort,
                        unsigned threads);

/* Opens a file; on success *decoder must be given to tessera_close. */
int tessera_open(const char* path, tessera_decoder** decoder);
void tessera_close(tessera_decoder* decoder);

int tessera_describe(const tessera_decoder* decoder, tessera_texture* texture);

/* Decodes the half-open box begin[i] <= coordinate < end[i] (u, v, s, t) into out[out_bytes], which
 * must have exactly the size of the box. */
int tessera_decode_box(const tessera_decoder* decoder, const uint32_t begin[4],
                       const uint32_t end[4], void* out, size_t out_bytes, unsigned threads);

#ifdef __cplusplus
}
#endif
#endif
