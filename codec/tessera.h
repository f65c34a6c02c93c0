/* Tessera for C and for other languages: C API 2.
 *
 * Texels. A texture T(u,v,s,t) is a dense array in the order v, u, t, s (s fastest); the channels
 * of a texel are adjacent. A sample is one byte, or an IEEE 754 half in the machine's byte order
 * (little endian). A box is half-open: begin[i] <= coordinate < end[i] for i = u, v, s, t.
 *
 * Errors. Functions that return int return TESSERA_OK (0) or an error code, and in the latter case
 * set the message of tessera_last_error(). A null pointer where none is allowed gives
 * TESSERA_BAD_ARGUMENT. On an error, outputs are unchanged unless their comment says otherwise. No
 * function throws or ends the process.
 *
 * Threads. Functions may be called from any thread. Several threads may use a decoder at once,
 * except for tessera_close. Each thread has its own last error. A call needs less than 128 KiB of
 * the stack of its thread.
 *
 * Ownership. The caller keeps what it passes and must not free it before the function returns (the
 * bytes or source that a decoder reads: before tessera_close). Strings are UTF-8 and end with a
 * NUL.
 *
 * Later versions. A structure that begins with struct_size may grow at its end. Its init macro sets
 * struct_size to the size that the caller was compiled with, and all other members to their
 * defaults. A library that knows more members uses the defaults for those that the caller's
 * structure lacks. A library that knows fewer members accepts a larger structure only if the rest
 * is zero, and otherwise returns TESSERA_UNSUPPORTED. Bindings call the ..._init_sized functions
 * behind the macros. */
#ifndef TESSERA_H
#define TESSERA_H

#include <stddef.h>
#include <stdint.h>

/* TESSERA_SHARED: the library is a DLL. TESSERA_BUILD: this header is used to build the library.
 * Only Windows needs these macros; elsewhere a shared library exports just these functions. */
#if defined(_WIN32)
#if defined(TESSERA_BUILD) && defined(TESSERA_SHARED)
#define TESSERA_API __declspec(dllexport)
#elif defined(TESSERA_SHARED)
#define TESSERA_API __declspec(dllimport)
#else
#define TESSERA_API
#endif
#elif defined(__GNUC__)
#define TESSERA_API __attribute__((visibility("default")))
#else
#define TESSERA_API
#endif

#ifdef __cplusplus
extern "C" {
#endif

/* ---- Versions and errors --------------------------------------------------------------------- */

/* The version of this interface. It stays 2 as long as programs that were compiled for 2 work. */
#define TESSERA_API_VERSION 2

/* TESSERA_API_VERSION of the library that is running. */
TESSERA_API uint32_t tessera_api_version(void);
/* The version of the library, "major.minor.patch". The string is never freed. */
TESSERA_API const char* tessera_version(void);
/* The version of the file format (FORMAT.md) that the library implements. Headers of files state an
 * older minor version if that is enough to read them. Pointers may be null. */
TESSERA_API void tessera_format_version(uint32_t* major, uint32_t* minor);

typedef enum {
    TESSERA_OK = 0,
    TESSERA_BAD_ARGUMENT = 1, /* an argument is outside its range or contradicts another */
    TESSERA_IO = 2,           /* the operating system, or a callback, could not read or write */
    TESSERA_INVALID_FILE = 3, /* the bytes are not a valid .tess file */
    TESSERA_RUNTIME = 4,      /* out of memory, or a self-check failed */
    TESSERA_UNSUPPORTED = 5,  /* valid, but not supported by this version */
    TESSERA_CANCELLED = 6     /* the caller's progress or cancelled function asked to stop */
} tessera_error;

/* "ok", "bad_argument", "io", "invalid_file", "runtime", "unsupported", "cancelled", or "callback"
 * for any other number. The string is never freed. */
TESSERA_API const char* tessera_error_name(int error);

/* The message of the last error on this thread; "" if there was none. Valid until the next call
 * that fails on this thread. */
TESSERA_API const char* tessera_last_error(void);

/* Callbacks return 0 for success. After any other number, the function that called them fails and
 * returns that number. Use numbers of tessera_error where they fit, and numbers from 1000 on, or
 * negative ones, for your own errors. Before it fails, a callback may set the message of
 * tessera_last_error() with this function, which copies the text; null removes it. It has no effect
 * outside callbacks. */
TESSERA_API void tessera_set_callback_error(const char* sentence);

/* Called on the thread that called the function, at most once per tile and pass. `stage` names the
 * current work in a word or two ("encode", "decode") and is valid during the call. done and total
 * are in arbitrary units. Return 0 to continue; any other number makes the function end soon with
 * TESSERA_CANCELLED. */
typedef int (*tessera_progress_function)(void* user, const char* stage, double done, double total);
/* Called from several threads at once, before each tile. Return 0 to continue; any other number
 * makes the function end soon with TESSERA_CANCELLED. */
typedef int (*tessera_cancelled_function)(void* user);

/* Frees memory that a function of this library has allocated for the caller. Null is ignored. */
TESSERA_API void tessera_free(void* memory);

/* ---- Textures -------------------------------------------------------------------------------- */

typedef enum { TESSERA_UNORM8 = 0, TESSERA_HALF16 = 1 } tessera_sample_type;

typedef struct {
    uint32_t size[4];  /* texels along u, v, s, t; each 1 to 2^20, their product at most 2^48 */
    int32_t type;      /* tessera_sample_type */
    uint32_t channels; /* 1 grey, 2 grey + alpha, 3 RGB, 4 RGB + alpha */
} tessera_texture;

/* Computes how many bytes the texels of a box have, for this texture's type and channels. Does not
 * check that the box lies inside the texture, so that it can be used for coarse levels. Errors:
 * TESSERA_BAD_ARGUMENT (the box is empty or reversed, the type or channels do not exist);
 * TESSERA_UNSUPPORTED (the size exceeds 64 bits or size_t). */
TESSERA_API int tessera_box_bytes(const tessera_texture* texture, const uint32_t begin[4],
                                  const uint32_t end[4], uint64_t* bytes);

typedef enum {
    TESSERA_PROXY_NONE = 0,
    TESSERA_PROXY_SPHERE = 1,
    TESSERA_PROXY_MESH = 2,
    TESSERA_PROXY_SPHERE_INSIDE = 3 /* seen from inside */
} tessera_proxy;
typedef enum {
    TESSERA_SURFACE_NONE = 0,
    TESSERA_SURFACE_SPHERE_LONGITUDE_LATITUDE = 1,
    TESSERA_SURFACE_MESH_UV = 2
} tessera_surface_map;
typedef enum {
    TESSERA_ANGULAR_NONE = 0,
    TESSERA_ANGULAR_HEMISPHERE_ALPHA_BETA = 1,
    TESSERA_ANGULAR_PLANAR_VIEWS = 2,
    TESSERA_ANGULAR_OCTAHEDRAL_HEMISPHERE = 3,
    TESSERA_ANGULAR_OCTAHEDRAL_MIRRORED = 4
} tessera_angular_map;
typedef enum {
    TESSERA_TRANSFER_UNSPECIFIED = 0,
    TESSERA_TRANSFER_SRGB = 1,
    TESSERA_TRANSFER_LINEAR = 2
} tessera_transfer;
typedef enum { TESSERA_PRIMARIES_UNSPECIFIED = 0, TESSERA_PRIMARIES_BT709 = 1 } tessera_primaries;
typedef enum {
    TESSERA_ALPHA_NONE = 0, /* the only one for 1 and 3 channels */
    TESSERA_ALPHA_STRAIGHT = 1,
    TESSERA_ALPHA_PREMULTIPLIED = 2
} tessera_alpha;

/* The meaning of the coordinates and samples (format/FORMAT.md, 1.1). The codec ignores it. */
typedef struct {
    size_t struct_size;
    int32_t proxy;           /* tessera_proxy */
    int32_t surface_map;     /* tessera_surface_map */
    int32_t angular_map;     /* tessera_angular_map */
    int32_t transfer;        /* tessera_transfer */
    int32_t primaries;       /* tessera_primaries */
    int32_t alpha;           /* tessera_alpha */
    float sphere_centre[3];  /* world units */
    float sphere_radius;     /* world units; above 0 with a sphere, else 0 */
    float viewing_radius[2]; /* least and greatest distance of viewers from the centre; 0, 0: no
                                 limits */
} tessera_description;

TESSERA_API void tessera_description_init_sized(tessera_description* description,
                                                size_t struct_size);
#define tessera_description_init(d) tessera_description_init_sized((d), sizeof *(d))

typedef struct {
    const char* key;   /* UTF-8, 1 to 255 bytes */
    const char* value; /* UTF-8, up to 1 MiB */
} tessera_key_value;

/* An open file, see "Opening". */
typedef struct tessera_decoder tessera_decoder;

/* ---- Encoding (not in a library that only decodes) ------------------------------------------- */

/* Fills `out` with exactly the texels of the box, dense. Returns 0 or an error, see above. */
typedef int (*tessera_read_texels_function)(void* user, const uint32_t begin[4],
                                            const uint32_t end[4], void* out, size_t out_bytes);

/* A source of texels: either memory (`texels`) or a function (`read`). */
typedef struct {
    size_t struct_size;
    tessera_texture texture;
    const void* texels; /* the whole texture, or null */
    size_t texel_bytes; /* size of `texels`, exactly that of the texture; unused with `strides` */
    /* Null if `texels` is set. Called for boxes in any order, and several times for the same box;
     * from several threads at once unless one_at_a_time is 1. */
    tessera_read_texels_function read;
    void* user;            /* passed to `read` */
    int32_t one_at_a_time; /* 1: `read` is called once at a time, from any thread */
    int32_t slow; /* 1: reading a box again is expensive (rendering), so use fewer passes */
    /* Bytes from one element of `texels` to the next along u, v, s, t and the channels, for axes in
     * another order than the library's; may be negative. `texels` is the element 0, 0, 0, 0, 0. The
     * caller answers for the memory. All 0: dense, in the library's order. */
    int64_t strides[5];
} tessera_texel_source;

TESSERA_API void tessera_texel_source_init_sized(tessera_texel_source* source, size_t struct_size);
#define tessera_texel_source_init(s) tessera_texel_source_init_sized((s), sizeof *(s))

typedef enum {
    TESSERA_QUALITY = 0,  /* 1 to 100 */
    TESSERA_PSNR = 1,     /* PSNR over all samples in dB, up to 120; not below it */
    TESSERA_BPT = 2,      /* bits per texel, all channels together; not above it */
    TESSERA_BYTES = 3,    /* bytes of the file; not above it */
    TESSERA_MAX_ERROR = 4 /* largest error of a sample: 8-bit steps or half ulps; 0: lossless */
} tessera_rate;

typedef enum {
    TESSERA_JOURNAL_NONE = 0,  /* finished tiles stay in memory */
    TESSERA_JOURNAL_START = 1, /* they are kept in "<path>.journal" until the file is complete */
    TESSERA_JOURNAL_RESUME = 2 /* the same, continuing an interrupted run if there is one */
} tessera_journal;

typedef struct {
    size_t struct_size;
    double rate_value; /* in the unit of rate_kind; default 75 */
    int32_t rate_kind; /* tessera_rate; default TESSERA_QUALITY */
    int32_t effort;    /* 0 fastest .. 4 smallest; default 3 */
    uint32_t threads;  /* 0 (default): all cores. Does not change the bytes of the file. */
    /* Largest tile in texels along u, v, s, t: 1 to 256, 256, 32, 32, with a product of at most
     * 393,216 (65,536 with TESSERA_MAX_ERROR). All 0 (default): the encoder chooses by trial. */
    uint32_t tile[4];
    int32_t verify; /* 1 (default): decode and compare every tile before keeping it */
    int32_t strict; /* 1: NaN and infinity are errors; 0 (default): replace and count them */
    int32_t layers; /* 1: coarse levels first, so that any beginning of the file shows it all */
    /* Largest number of bytes of texels to hold at a time for sources that have to be read in
     * slabs; default 512 MiB. Sources of this API are read tile by tile and need no slabs. */
    uint64_t memory_bytes;
    /* Which texels matter: one channel of TESSERA_UNORM8, 0 where any value will do. Each side is
     * that of the texture, or 1 to repeat the mask along it. Null: all texels matter. */
    const tessera_texel_source* mask;
    const tessera_description* description; /* null: nothing is known */
    const tessera_key_value* metadata; /* entries to store; if "Software" is absent, it is added
                                             * unless the file is small */
    size_t metadata_count;
    tessera_progress_function progress;   /* may be null */
    tessera_cancelled_function cancelled; /* may be null */
    void* user;                           /* passed to both */
    int32_t journal;                      /* tessera_journal; used by tessera_encode_to_path only */
    /* If no quantiser step reaches a TESSERA_PSNR: 1 writes a lossless file; 0 (default) does so
     * only if that is smaller than with the finest step and the source is not slow, and otherwise
     * sets target_met to 0 in the report. */
    int32_t lossless_fallback;
    /* With a journal: names and values that identify the texels. A resume with others fails. */
    const tessera_key_value* source_facts;
    size_t source_fact_count;
    /* Required with TESSERA_PROXY_MESH and not allowed otherwise: a Draco mesh with texture
     * coordinates (format/FORMAT.md, 5.2), which is stored unchanged. */
    const void* mesh;
    size_t mesh_bytes;
    /* A file from which the texels were decoded and perhaps edited. It must have the same size,
     * sample type and channels, and all of it must be available. Unchanged tiles keep the bytes of
     * that file. The others are encoded with its quantiser, tables and tile shape: rate and tile
     * are ignored. Null: all tiles are encoded. */
    const tessera_decoder* reuse;
} tessera_encode_options;

TESSERA_API void tessera_encode_options_init_sized(tessera_encode_options* options,
                                                   size_t struct_size);
#define tessera_encode_options_init(o) tessera_encode_options_init_sized((o), sizeof *(o))

/* The result of encoding. The caller sets struct_size (tessera_encode_report_init); nothing beyond
 * it is written. */
typedef struct {
    size_t struct_size;
    uint64_t file_bytes;
    uint64_t raw_bytes;    /* uncompressed size of the texels */
    double bits_per_texel; /* 8 * file_bytes / texels */
    double psnr;      /* dB over all samples that matter (half: of 16-bit codes); 999: lossless */
    double max_error; /* largest error of a sample that matters: 8-bit steps or half ulps */
    double seconds;   /* elapsed time */
    uint64_t texels_that_matter;
    uint64_t nan_count;      /* replaced by 0 */
    uint64_t infinity_count; /* replaced by +-65504 */
    uint32_t passes;         /* number of passes over the whole texture */
    int32_t target_met;      /* 0: the requested rate cannot be reached, see note */
    char note[256];          /* why not, or why the file is lossless; "" otherwise */
    uint64_t kept_tiles;     /* with `reuse`: tiles that kept the bytes of that file; otherwise 0 */
} tessera_encode_report;

TESSERA_API void tessera_encode_report_init_sized(tessera_encode_report* report,
                                                  size_t struct_size);
#define tessera_encode_report_init(r) tessera_encode_report_init_sized((r), sizeof *(r))

/* The functions that encode. `options` may be null for the defaults, `report` may be null. Several
 * calls may run at the same time, each with its own threads. Errors: TESSERA_BAD_ARGUMENT (an
 * option outside its range, a target in bytes that cannot be met), TESSERA_IO, TESSERA_RUNTIME,
 * TESSERA_UNSUPPORTED, TESSERA_INVALID_FILE (with strict: a sample is not finite),
 * TESSERA_CANCELLED, and those of callbacks. */

/* Returns the error with which encoding would refuse these options before reading texels. Fast. */
TESSERA_API int tessera_check_options(const tessera_texture* texture,
                                      const tessera_encode_options* options);

/* Encodes to the file `path`, which is created or replaced once it is complete. */
TESSERA_API int tessera_encode_to_path(const tessera_texel_source* source, const char* path,
                                       const tessera_encode_options* options,
                                       tessera_encode_report* report);

/* Encodes to memory: *file receives *file_bytes bytes, to be freed with tessera_free. On an error
 * *file is null and *file_bytes is 0. */
TESSERA_API int tessera_encode_to_memory(const tessera_texel_source* source, void** file,
                                         size_t* file_bytes, const tessera_encode_options* options,
                                         tessera_encode_report* report);

/* Receives the next `count` bytes of the file. Returns 0 or an error, see above. */
typedef int (*tessera_write_function)(void* user, const void* bytes, size_t count);

/* Encodes and passes the file to `write`, from the first byte to the last, in pieces of about 1
 * MiB. `write` is called on the calling thread after everything has been encoded. After an error,
 * discard the pieces received so far. */
TESSERA_API int tessera_encode_to_function(const tessera_texel_source* source,
                                           tessera_write_function write, void* user,
                                           const tessera_encode_options* options,
                                           tessera_encode_report* report);

/* ---- Opening --------------------------------------------------------------------------------- */

typedef struct {
    size_t struct_size;
    /* 1: accept a truncated file, if it reaches at least the end of its index. Tiles that are
     * missing are shown from coarser levels or as background. */
    int32_t allow_partial;
    /* 1: show damaged tiles in the same way. */
    int32_t allow_damaged;
} tessera_open_options;

TESSERA_API void tessera_open_options_init_sized(tessera_open_options* options, size_t struct_size);
#define tessera_open_options_init(o) tessera_open_options_init_sized((o), sizeof *(o))

typedef struct {
    uint64_t offset; /* position of the first byte in the file */
    void* out;
    size_t bytes; /* number of bytes, all of which must be read */
} tessera_byte_range;

/* A source for the bytes of a file, such as an archive or a web server. */
typedef struct {
    size_t struct_size;
    uint64_t size; /* number of available bytes */
    void* user;    /* passed to the functions */
    /* Fills out[bytes] with the bytes from `offset` on. The range lies inside `size`. */
    int (*read)(void* user, uint64_t offset, void* out, size_t bytes);
    /* Fills all ranges, in any order. The ranges may be in any order and overlap, their buffers do
     * not. For sources that can process several requests at once. Null: `read` is called for each
     * range. */
    int (*read_many)(void* user, const tessera_byte_range* ranges, size_t count);
    /* Called once, when the decoder is closed or opening fails. May be null. */
    void (*close)(void* user);
    const char* name; /* copied, for error messages; null: "<callback>" */
    /* 1: read and read_many are called once at a time; 0: from several threads at once. */
    int32_t one_at_a_time;
    /* 1: each read is expensive (a round trip), so many tiles are read ahead at once. */
    int32_t slow;
} tessera_byte_source;

TESSERA_API void tessera_byte_source_init_sized(tessera_byte_source* source, size_t struct_size);
#define tessera_byte_source_init(s) tessera_byte_source_init_sized((s), sizeof *(s))

/* These functions open a file: they read its head, in one or two reads, and check it. `options` may
 * be null for the defaults. On success *decoder must be closed with tessera_close; on an error it
 * is null. Errors: TESSERA_IO, TESSERA_INVALID_FILE, TESSERA_UNSUPPORTED (another version of the
 * format), and those of callbacks. */
TESSERA_API int tessera_open_path(const char* path, const tessera_open_options* options,
                                  tessera_decoder** decoder);
/* file[file_bytes] must stay unchanged until tessera_close. */
TESSERA_API int tessera_open_memory(const void* file, size_t file_bytes,
                                    const tessera_open_options* options, tessera_decoder** decoder);
/* `source` is copied. What it refers to must stay valid until its close() is called. */
TESSERA_API int tessera_open_source(const tessera_byte_source* source,
                                    const tessera_open_options* options, tessera_decoder** decoder);

/* No other call may use the decoder at the same time. Null is ignored. */
TESSERA_API void tessera_close(tessera_decoder* decoder);

/* ---- The contents of a file (these functions are fast: they do not read) --------------------- */

TESSERA_API int tessera_get_texture(const tessera_decoder* decoder, tessera_texture* texture);

/* The caller sets description->struct_size (tessera_description_init). Members may have numbers
 * outside their enums, from a later version of the format. */
TESSERA_API int tessera_get_description(const tessera_decoder* decoder,
                                        tessera_description* description);
/* The Draco mesh of a file with TESSERA_PROXY_MESH, otherwise null and 0. Owned by the decoder. */
TESSERA_API int tessera_get_mesh(const tessera_decoder* decoder, const void** bytes, size_t* count);

/* The texture is level 0. Levels 1, 2, ... are coarser copies of it, if the file has any. A file
 * with aligned views (format/FORMAT.md, part 2) has no coarse levels; its level 0 has the size and
 * tiles of the grid in which the views are shifted, which is larger than the texture along u and v.
 * Boxes to decode are boxes of the texture (tessera_get_texture) in any case. */
typedef struct {
    size_t struct_size;
    uint32_t size[4];         /* texels along u, v, s, t; level 0: see above */
    uint32_t spatial_lod;     /* a texel covers 2^spatial_lod texels of level 0 along u and v */
    uint32_t angular_lod;     /* and 2^angular_lod along s and t */
    uint32_t largest_tile[4]; /* texels */
    uint32_t tile_count[4];   /* tiles along u, v, s, t: tile i of n covers texels
                                  floor(i * size / n) to floor((i + 1) * size / n) */
} tessera_level;

TESSERA_API void tessera_level_init_sized(tessera_level* level, size_t struct_size);
#define tessera_level_init(l) tessera_level_init_sized((l), sizeof *(l))

/* At least 1, or 0 for a null decoder. */
TESSERA_API uint32_t tessera_level_count(const tessera_decoder* decoder);
/* The caller sets level->struct_size. Errors: TESSERA_BAD_ARGUMENT (the level does not exist). */
TESSERA_API int tessera_get_level(const tessera_decoder* decoder, uint32_t number,
                                  tessera_level* level);

/* How much of the file is available, and how many tiles of level 0 have been requested and filled
 * so far. Each tile is counted once. */
typedef struct {
    size_t struct_size;
    uint64_t file_bytes;     /* size of the whole file according to its header */
    uint64_t received_bytes; /* available bytes */
    uint64_t tiles;          /* of all levels */
    uint64_t missing_tiles;  /* filled because they are missing */
    uint64_t damaged_tiles;  /* filled because they are damaged */
    uint64_t filled_texels;  /* in both kinds of tiles; of the texture, not of the grid */
    int32_t is_partial;      /* 1: received_bytes < file_bytes */
    int32_t reserved;
} tessera_file_state;

TESSERA_API void tessera_file_state_init_sized(tessera_file_state* state, size_t struct_size);
#define tessera_file_state_init(s) tessera_file_state_init_sized((s), sizeof *(s))

/* The caller sets state->struct_size. */
TESSERA_API int tessera_get_file_state(const tessera_decoder* decoder, tessera_file_state* state);

/* Entries are sorted by key. The decoder owns keys and values, which end with a NUL that
 * value_bytes does not count. value_bytes may be null. */
TESSERA_API size_t tessera_metadata_count(const tessera_decoder* decoder); /* 0 for null */
/* Errors: TESSERA_BAD_ARGUMENT (the entry does not exist). */
TESSERA_API int tessera_metadata_at(const tessera_decoder* decoder, size_t index, const char** key,
                                    const char** value, size_t* value_bytes);
/* The value of `key`, or null if the file lacks it or an argument is null. */
TESSERA_API const char* tessera_metadata_value(const tessera_decoder* decoder, const char* key);

/* ---- Texels ---------------------------------------------------------------------------------- */

typedef enum {
    TESSERA_CHECK_PAGES = 0, /* read the page around each tile and check its checksum (default) */
    TESSERA_CHECK_TILES = 1  /* read only the tile's bytes; some damage goes undetected */
} tessera_integrity;

typedef struct {
    size_t struct_size;
    uint32_t level;    /* of the box; default 0 */
    uint32_t threads;  /* 0 (default): all cores. Coarse levels use one. */
    int32_t integrity; /* tessera_integrity, for level 0; coarse levels use TESSERA_CHECK_PAGES */
    int32_t reserved;  /* must be 0 */
    tessera_progress_function progress;   /* may be null; coarse levels call it at the end */
    tessera_cancelled_function cancelled; /* may be null; coarse levels call it at the start */
    void* user;                           /* passed to both */
} tessera_decode_options;

TESSERA_API void tessera_decode_options_init_sized(tessera_decode_options* options,
                                                   size_t struct_size);
#define tessera_decode_options_init(o) tessera_decode_options_init_sized((o), sizeof *(o))

/* Decodes the texels of a box into out[out_bytes], which must have exactly the size of the box
 * (tessera_box_bytes). Reads only the tiles that the box touches. `options` may be null for the
 * defaults. On an error `out` is unspecified. Errors: TESSERA_BAD_ARGUMENT (the box is not inside
 * the level, or the buffer has another size), TESSERA_IO, TESSERA_INVALID_FILE, TESSERA_RUNTIME,
 * TESSERA_CANCELLED, and those of callbacks. */
TESSERA_API int tessera_decode_box(const tessera_decoder* decoder, const uint32_t begin[4],
                                   const uint32_t end[4], void* out, size_t out_bytes,
                                   const tessera_decode_options* options);

#ifdef __cplusplus
}
#endif
#endif
