/* Tessera for C and for other languages: C API 1.
 *
 * Texels. A texture T(u,v,s,t) is a dense array in the order v, u, t, s (s fastest) with the
 * channels of a texel adjacent; a sample is one byte, or an IEEE 754 half in the machine's byte
 * order (little endian). A box is half-open: begin[i] <= coordinate < end[i] for i = u, v, s, t.
 *
 * Errors. Functions that return int return TESSERA_OK (0) or an error code, and then leave a
 * sentence in tessera_last_error(). A null pointer where none is allowed is
 * TESSERA_BAD_ARGUMENT. On an error results are untouched, or as their comment says. No function
 * throws or ends the process.
 *
 * Threads. Functions may be called from any thread. A decoder may be used by many threads at
 * once, except for tessera_close. The last error belongs to the calling thread.
 *
 * Ownership. What the caller passes stays the caller's, and must live until the function returns
 * (what a decoder reads from: until tessera_close). Strings are UTF-8 and end with a NUL.
 *
 * Later versions. A structure that begins with struct_size may grow at its end. Its init macro
 * sets struct_size to the size that the caller was compiled with, and all else to the defaults.
 * A library that knows more fields uses their defaults for a smaller structure; one that knows
 * fewer accepts a larger structure if the rest is zero, and otherwise refuses it
 * (TESSERA_UNSUPPORTED) rather than ignoring what was asked for. Bindings call the
 * ..._init_sized functions behind the macros. */
#ifndef TESSERA_H
#define TESSERA_H

#include <stddef.h>
#include <stdint.h>

/* TESSERA_SHARED: the library is a DLL; TESSERA_BUILD: this is the library itself. Only Windows
 * needs to be told; elsewhere these functions are what a shared library shows. */
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

/* Of this interface: 1 as long as programs that were compiled for 1 work. */
#define TESSERA_API_VERSION 1

/* TESSERA_API_VERSION of the library that runs. */
TESSERA_API uint32_t tessera_api_version(void);
/* Version of the library, "major.minor.patch". Lives as long as the library. */
TESSERA_API const char* tessera_version(void);
/* Version of the file format that is written, and the only one that is read. Pointers may be
 * null. */
TESSERA_API void tessera_format_version(uint32_t* major, uint32_t* minor);

typedef enum {
    TESSERA_OK = 0,
    TESSERA_BAD_ARGUMENT = 1, /* what was asked for makes no sense */
    TESSERA_IO = 2,           /* the operating system, or a callback, refused a read or a write */
    TESSERA_INVALID_FILE = 3, /* the bytes are not a sound .tess file */
    TESSERA_RUNTIME = 4,      /* out of memory, a failed self-check */
    TESSERA_UNSUPPORTED = 5,  /* valid, but this version cannot do it */
    TESSERA_CANCELLED = 6     /* the caller's progress or cancelled function said so */
} tessera_error;

/* "ok", "bad_argument", "io", "invalid_file", "runtime", "unsupported", "cancelled"; "callback" for
 * any other number. Lives as long as the library. */
TESSERA_API const char* tessera_error_name(int error);

/* The sentence that goes with the last error of this thread; "" before the first. Valid until the
 * next function of the library fails on this thread. */
TESSERA_API const char* tessera_last_error(void);

/* Callbacks return 0 for success. Any other number ends the function that called them, which
 * then returns that number. Use those of tessera_error where they fit, and numbers from 1000 on,
 * or negative ones, for what only the caller understands. Before it fails, a callback may set
 * the sentence for tessera_last_error(); the text is copied, null for none. Has an effect within
 * callbacks only. */
TESSERA_API void tessera_set_callback_error(const char* sentence);

/* Called from the thread that called the function, at most once a tile and pass. `stage` says in
 * a word or two what goes on ("encode", "decode") and lives for the call; done and total are in
 * no unit in particular. Not 0: stop; the function ends soon with TESSERA_CANCELLED. */
typedef int (*tessera_progress_function)(void* user, const char* stage, double done, double total);
/* Called from several threads at once, before each tile. Not 0: stop; the function ends soon with
 * TESSERA_CANCELLED. */
typedef int (*tessera_cancelled_function)(void* user);

/* Frees what a function says is to be freed with it. Null: nothing happens. */
TESSERA_API void tessera_free(void* memory);

/* ---- Textures -------------------------------------------------------------------------------- */

typedef enum { TESSERA_UNORM8 = 0, TESSERA_HALF16 = 1 } tessera_sample_type;

typedef struct {
    uint32_t size[4];  /* texels along u, v, s, t; each 1 to 2^20, their product at most 2^48 */
    int32_t type;      /* tessera_sample_type */
    uint32_t channels; /* 1 grey, 2 grey + alpha, 3 RGB, 4 RGB + alpha */
} tessera_texture;

/* Bytes of the texels of a box of this texture's type and channels. Does not ask whether the box
 * lies inside it, so it serves coarse levels, too. TESSERA_BAD_ARGUMENT: an empty or reversed
 * box, a type or channels that do not exist; TESSERA_UNSUPPORTED: more bytes than 64 bits, or
 * this machine's size_t, can count. */
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

/* What the coordinates and the samples mean (format/FORMAT.md, 1.1). The codec does not look at
 * it. */
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
    float viewing_radius[2]; /* nearest and farthest distance of observers from the centre; 0, 0:
                                 anywhere that sees the surface */
} tessera_description;

TESSERA_API void tessera_description_init_sized(tessera_description* description,
                                                size_t struct_size);
#define tessera_description_init(d) tessera_description_init_sized((d), sizeof *(d))

typedef struct {
    const char* key;   /* UTF-8, 1 to 255 bytes */
    const char* value; /* UTF-8, up to 1 MiB */
} tessera_key_value;

/* An open file, see Opening. */
typedef struct tessera_decoder tessera_decoder;

/* ---- Encoding (not in a library that only decodes) ------------------------------------------- */

/* Fills `out`, exactly the texels of the box, in its dense order. */
typedef int (*tessera_read_texels_function)(void* user, const uint32_t begin[4],
                                            const uint32_t end[4], void* out, size_t out_bytes);

/* Where texels come from: memory (`texels`), or a function (`read`). */
typedef struct {
    size_t struct_size;
    tessera_texture texture;
    const void* texels; /* all of them, or null */
    size_t texel_bytes; /* of `texels`; must be exactly those of the texture */
    /* Null with `texels`. Called for boxes in any order, and several times for the same box; from
     * several threads at once unless one_at_a_time is 1. */
    tessera_read_texels_function read;
    void* user;            /* for `read` */
    int32_t one_at_a_time; /* 1: one call of `read` at a time, from whichever thread */
    int32_t slow;          /* 1: reading a box again is dear (rendered), so fewer passes are made */
} tessera_texel_source;

TESSERA_API void tessera_texel_source_init_sized(tessera_texel_source* source, size_t struct_size);
#define tessera_texel_source_init(s) tessera_texel_source_init_sized((s), sizeof *(s))

typedef enum {
    TESSERA_QUALITY = 0,  /* 1 to 100 */
    TESSERA_PSNR = 1,     /* dB over all samples, reached from above; up to 120 */
    TESSERA_BPT = 2,      /* bits per texel, all channels together, not exceeded */
    TESSERA_BYTES = 3,    /* bytes of the file, not exceeded */
    TESSERA_MAX_ERROR = 4 /* of any sample: 8-bit steps, or ulps of half; 0: lossless */
} tessera_rate;

typedef enum {
    TESSERA_JOURNAL_NONE = 0,  /* finished tiles stay in memory */
    TESSERA_JOURNAL_START = 1, /* they go to the folder "<path>.journal" until the file is there */
    TESSERA_JOURNAL_RESUME = 2 /* the same, going on with what a run that ended early left there */
} tessera_journal;

typedef struct {
    size_t struct_size;
    double rate_value; /* in the unit of rate_kind; 75 */
    int32_t rate_kind; /* tessera_rate; TESSERA_QUALITY */
    int32_t effort;    /* 0 fastest .. 4 smallest; the default, 3, is the one to use */
    uint32_t threads;  /* 0 (the default): all cores. Never changes the bytes. */
    /* Largest tile in texels along u, v, s, t: 1 to 64, 64, 32, 32, and at most 393,216 in all,
     * 65,536 with TESSERA_MAX_ERROR; all 0 (the default): the encoder tries. */
    uint32_t tile[4];
    int32_t verify; /* 1 (the default): every tile is decoded and compared before it is kept */
    int32_t strict; /* 1: NaN and infinities are errors; 0 (the default): replaced and counted */
    int32_t layers; /* 1: coarse levels first, so that any beginning of the file shows all of it */
    /* Most bytes of texels held at a time where a source has to be walked in slabs; 512 MiB.
     * Memory and callbacks are not: they are read tile by tile. */
    uint64_t memory_bytes;
    /* Coding tools on (+) and off (-), for experiments: "-copies,+grids"; null: as effort has
     * it. An unknown name is answered with the list of all. */
    const char* tools;
    /* Which texels matter: one channel of TESSERA_UNORM8, 0 where any value will do; sides those
     * of the texture or 1. Null: all. */
    const tessera_texel_source* mask;
    const tessera_description* description; /* null: nothing is said */
    const tessera_key_value* metadata;      /* to store; "Software" is added where absent */
    size_t metadata_count;
    tessera_progress_function progress;   /* null: none */
    tessera_cancelled_function cancelled; /* null: none */
    void* user;                           /* of both */
    int32_t journal;                      /* tessera_journal, of tessera_encode_to_path */
    /* 1: a TESSERA_PSNR that no quantiser reaches is met by a lossless file; 0 (the default): only
     * where that is smaller than the finest quantiser's and the source is not slow, else the report
     * has target_met 0. */
    int32_t lossless_fallback;
    /* With a journal: what the texels come from, as names and values. A resume under others is
     * refused. */
    const tessera_key_value* source_facts;
    size_t source_fact_count;
    /* With TESSERA_PROXY_MESH, and only then: a Draco mesh with uv (format/FORMAT.md, 5.2), stored as
     * it is. */
    const void* mesh;
    size_t mesh_bytes;
    /* A file that the texels were decoded from and perhaps edited since; of their size, sample type and
     * channels, opened whole. Tiles that are still what it decodes to keep its bytes, the others get
     * its quantiser, tables and shape: rate and tile are not looked at, tools must be null. Null: all
     * tiles are encoded. */
    const tessera_decoder* reuse;
} tessera_encode_options;

TESSERA_API void tessera_encode_options_init_sized(tessera_encode_options* options,
                                                   size_t struct_size);
#define tessera_encode_options_init(o) tessera_encode_options_init_sized((o), sizeof *(o))

/* What was reached. The caller sets struct_size (tessera_encode_report_init); no more is
 * written. */
typedef struct {
    size_t struct_size;
    uint64_t file_bytes;
    uint64_t raw_bytes;    /* of the texels */
    double bits_per_texel; /* 8 * file_bytes / texels */
    double psnr;      /* dB over all samples that matter (half: over 16-bit codes); 999: lossless */
    double max_error; /* of any sample that matters: 8-bit steps, or ulps of half */
    double seconds;   /* by the clock */
    uint64_t texels_that_matter;
    uint64_t nan_count;      /* replaced by 0 */
    uint64_t infinity_count; /* replaced by +-65504 */
    uint32_t passes;         /* over the whole texture */
    int32_t target_met;      /* 0: the rate asked for lies beyond what can be reached, see note */
    char note[256];          /* why not, or why the file is lossless, or "" */
    uint64_t kept_tiles;     /* with `reuse`: tiles whose bytes are that file's; else 0 */
} tessera_encode_report;

TESSERA_API void tessera_encode_report_init_sized(tessera_encode_report* report,
                                                  size_t struct_size);
#define tessera_encode_report_init(r) tessera_encode_report_init_sized((r), sizeof *(r))

/* All the ways to encode: options null: the defaults; report null: not wanted. They may run at
 * the same time, each on its own threads. Errors: TESSERA_BAD_ARGUMENT (options out of range, a
 * target in bytes that cannot be met), TESSERA_IO, TESSERA_RUNTIME, TESSERA_UNSUPPORTED,
 * TESSERA_INVALID_FILE (strict, and a sample that is not finite), TESSERA_CANCELLED, and those
 * of callbacks. */

/* Whether tessera_encode_... would refuse these options before it reads a texel. Quick. */
TESSERA_API int tessera_check_options(const tessera_texture* texture,
                                      const tessera_encode_options* options);

/* Into the file `path`, which appears, or is replaced, when it is whole. */
TESSERA_API int tessera_encode_to_path(const tessera_texel_source* source, const char* path,
                                       const tessera_encode_options* options,
                                       tessera_encode_report* report);

/* Into memory: *file holds *file_bytes bytes, to be freed with tessera_free. On an error *file is
 * null and *file_bytes 0. */
TESSERA_API int tessera_encode_to_memory(const tessera_texel_source* source, void** file,
                                         size_t* file_bytes, const tessera_encode_options* options,
                                         tessera_encode_report* report);

/* Takes the next bytes of the file. */
typedef int (*tessera_write_function)(void* user, const void* bytes, size_t count);

/* Through a function, from the first byte to the last, in pieces of about a MiB, all from the
 * calling thread, once everything is encoded. After an error the pieces so far are worth
 * nothing. */
TESSERA_API int tessera_encode_to_function(const tessera_texel_source* source,
                                           tessera_write_function write, void* user,
                                           const tessera_encode_options* options,
                                           tessera_encode_report* report);

/* ---- Opening --------------------------------------------------------------------------------- */

typedef struct {
    size_t struct_size;
    /* 1: accept a file of which only the beginning is there (from the end of its index on), and
     * show the tiles that are not from coarser levels, or as background. */
    int32_t allow_partial;
    /* 1: the same for damaged tiles. */
    int32_t allow_damaged;
} tessera_open_options;

TESSERA_API void tessera_open_options_init_sized(tessera_open_options* options, size_t struct_size);
#define tessera_open_options_init(o) tessera_open_options_init_sized((o), sizeof *(o))

typedef struct {
    uint64_t offset; /* of the first byte, in the file */
    void* out;
    size_t bytes; /* to be filled, all of them */
} tessera_byte_range;

/* Where the bytes of a file come from: an archive, a web server. */
typedef struct {
    size_t struct_size;
    uint64_t size; /* bytes that there are */
    void* user;    /* for the functions */
    /* Fills out[bytes] from `offset` on, which lies inside `size`. */
    int (*read)(void* user, uint64_t offset, void* out, size_t bytes);
    /* Fills all ranges, in any order; they stand in any order and may overlap, their buffers do
     * not. For sources that can have several requests under way. Null: `read` is called for
     * each. */
    int (*read_many)(void* user, const tessera_byte_range* ranges, size_t count);
    /* Called once, when the decoder is closed or could not be opened. Null: nothing to do. */
    void (*close)(void* user);
    const char* name; /* for error messages; copied; null: "<callback>" */
    int32_t
        one_at_a_time; /* 1: one call of read or read_many at a time; 0: several threads may read */
    int32_t slow;      /* 1: a read costs far more than its bytes (a round trip), so tiles are read
                              ahead, many at once */
} tessera_byte_source;

TESSERA_API void tessera_byte_source_init_sized(tessera_byte_source* source, size_t struct_size);
#define tessera_byte_source_init(s) tessera_byte_source_init_sized((s), sizeof *(s))

/* Open a file: its head is read, in one or two reads, and checked. options null: the defaults. On
 * success *decoder is to be closed with tessera_close; on an error it is null. Errors: TESSERA_IO,
 * TESSERA_INVALID_FILE, TESSERA_UNSUPPORTED (a later version of the format), those of callbacks. */
TESSERA_API int tessera_open_path(const char* path, const tessera_open_options* options,
                                  tessera_decoder** decoder);
/* file[file_bytes] must stay there, unchanged, until tessera_close. */
TESSERA_API int tessera_open_memory(const void* file, size_t file_bytes,
                                    const tessera_open_options* options, tessera_decoder** decoder);
/* `source` is copied; what it points to must work until its close() is called. */
TESSERA_API int tessera_open_source(const tessera_byte_source* source,
                                    const tessera_open_options* options, tessera_decoder** decoder);

/* No other call may be using the decoder. Null: nothing happens. */
TESSERA_API void tessera_close(tessera_decoder* decoder);

/* ---- What is in a file (quick: nothing is read) ---------------------------------------------- */

TESSERA_API int tessera_get_texture(const tessera_decoder* decoder, tessera_texture* texture);

/* The caller sets description->struct_size (tessera_description_init). Numbers outside the enums
 * are those of a later version of the format. */
TESSERA_API int tessera_get_description(const tessera_decoder* decoder,
                                        tessera_description* description);
/* The Draco mesh of a file with TESSERA_PROXY_MESH, to be freed with the decoder; else null, 0. */
TESSERA_API int tessera_get_mesh(const tessera_decoder* decoder, const void** bytes, size_t* count);

/* The texture is level 0; levels 1, 2, ... are coarser copies of it, if the file has any. Of a file whose views
 * are aligned (format/FORMAT.md, part 2), which has no coarse levels, size and tiles of level 0 are those of the
 * grid that the views are moved in, which is larger than the texture along u and v: boxes to decode are of the
 * texture (tessera_get_texture) all the same. */
typedef struct {
    size_t struct_size;
    uint32_t size[4];     /* texels along u, v, s, t; level 0: see above */
    uint32_t spatial_lod; /* a texel stands for 2^spatial_lod texels of level 0 along u and v, */
    uint32_t angular_lod; /* and 2^angular_lod along s and t */
    uint32_t largest_tile[4]; /* texels */
    uint32_t tile_count[4];   /* tiles along u, v, s, t: tile i of n covers texels
                                  floor(i * size / n) to floor((i + 1) * size / n) */
} tessera_level;

TESSERA_API void tessera_level_init_sized(tessera_level* level, size_t struct_size);
#define tessera_level_init(l) tessera_level_init_sized((l), sizeof *(l))

/* At least 1; 0 for a null decoder. */
TESSERA_API uint32_t tessera_level_count(const tessera_decoder* decoder);
/* The caller sets level->struct_size. TESSERA_BAD_ARGUMENT: there is no such level. */
TESSERA_API int tessera_get_level(const tessera_decoder* decoder, uint32_t number,
                                  tessera_level* level);

/* How much of the file is there, and what was shown in place of the rest so far: tiles of level
 * 0 that were asked for and filled, each counted once. */
typedef struct {
    size_t struct_size;
    uint64_t file_bytes;     /* of the whole file, as it says itself */
    uint64_t received_bytes; /* that are there */
    uint64_t tiles;          /* of all levels */
    uint64_t missing_tiles;  /* filled because they have not been received */
    uint64_t damaged_tiles;  /* filled because they are damaged */
    uint64_t filled_texels;  /* of both; of the texture, not of the grid of aligned views */
    int32_t is_partial;      /* 1: received_bytes < file_bytes */
    int32_t reserved;
} tessera_file_state;

TESSERA_API void tessera_file_state_init_sized(tessera_file_state* state, size_t struct_size);
#define tessera_file_state_init(s) tessera_file_state_init_sized((s), sizeof *(s))

/* The caller sets state->struct_size. */
TESSERA_API int tessera_get_file_state(const tessera_decoder* decoder, tessera_file_state* state);

/* Entries are sorted by key. Keys and values belong to the decoder and end with a NUL that is not
 * counted in value_bytes, which may be null. */
TESSERA_API size_t tessera_metadata_count(const tessera_decoder* decoder); /* 0 for null */
/* TESSERA_BAD_ARGUMENT: there is no entry `index`. */
TESSERA_API int tessera_metadata_at(const tessera_decoder* decoder, size_t index, const char** key,
                                    const char** value, size_t* value_bytes);
/* The value of `key`, or null if the file does not have it. Also null for null arguments. */
TESSERA_API const char* tessera_metadata_value(const tessera_decoder* decoder, const char* key);

/* ---- Texels ---------------------------------------------------------------------------------- */

typedef enum {
    TESSERA_CHECK_PAGES = 0, /* read the page around each tile and check its checksum */
    TESSERA_CHECK_TILES = 1  /* read the tile alone; some damage passes */
} tessera_integrity;

typedef struct {
    size_t struct_size;
    uint32_t level; /* the box is of this level; 0 */
    uint32_t
        threads; /* 0 (the default): all cores, as far as the box has tiles; coarse levels: one */
    int32_t integrity; /* tessera_integrity, of level 0; coarse levels are always checked */
    int32_t reserved;  /* 0 */
    tessera_progress_function progress;   /* null: none; for coarse levels only at the end */
    tessera_cancelled_function cancelled; /* null: none; for coarse levels only at the start */
    void* user;                           /* of both */
} tessera_decode_options;

TESSERA_API void tessera_decode_options_init_sized(tessera_decode_options* options,
                                                   size_t struct_size);
#define tessera_decode_options_init(o) tessera_decode_options_init_sized((o), sizeof *(o))

/* Decodes the texels of a box into out[out_bytes], which must have exactly the size of the box
 * (tessera_box_bytes). Only the tiles that the box touches are read. options null: the defaults.
 * On an error `out` holds anything. Errors: TESSERA_BAD_ARGUMENT (the box does not lie in the
 * level, or the buffer does not fit), TESSERA_IO, TESSERA_INVALID_FILE, TESSERA_RUNTIME,
 * TESSERA_CANCELLED, those of callbacks. */
TESSERA_API int tessera_decode_box(const tessera_decoder* decoder, const uint32_t begin[4],
                                   const uint32_t end[4], void* out, size_t out_bytes,
                                   const tessera_decode_options* options);

#ifdef __cplusplus
}
#endif
#endif
