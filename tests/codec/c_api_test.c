/* Tests all of tessera.h from C, including its errors. Exits with 0 if all checks hold.
 *   c_api_test FILE   FILE: a path to write to; the file is removed at the end */
#include "codec/tessera.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define CHECK(condition)                                                                           \
    do {                                                                                           \
        if (!(condition)) {                                                                        \
            fprintf(stderr, "%s:%d: %s does not hold (%s)\n", __FILE__, __LINE__, #condition,      \
                    tessera_last_error());                                                         \
            return 1;                                                                              \
        }                                                                                          \
    } while (0)
/* Checks that a call fails with this code and with a message that contains `part`. */
#define REFUSED(call, error, part)                                                                 \
    do {                                                                                           \
        CHECK((call) == (error));                                                                  \
        CHECK(strstr(tessera_last_error(), part) != NULL);                                         \
    } while (0)

enum { own_error = 1234 };

/* ---- A small texture, from memory and from a function */

enum { U = 9, V = 7, S = 5, T = 3, C = 3, small_bytes = U * V * S * T * C };
static const tessera_texture small_texture = {{U, V, S, T}, TESSERA_UNORM8, C};
static const uint32_t origin[4] = {0, 0, 0, 0}, small_end[4] = {U, V, S, T};
static unsigned char small_texels[small_bytes];

static void make_small_texels(void) {
    size_t i;
    for (i = 0; i < small_bytes; ++i)
        small_texels[i] = (unsigned char)(i * 2654435761u >> 13);
}

static size_t place(size_t u, size_t v, size_t s, size_t t) {
    return (((v * U + u) * T + t) * S + s) * C;
}

typedef struct {
    int calls, fail_at, code, is_busy, overlaps;
    const char* sentence;
} reader;

static int read_texels(void* user, const uint32_t begin[4], const uint32_t end[4], void* out,
                       size_t out_bytes) {
    reader* r = user;
    unsigned char* to = out;
    uint32_t u, v, s, t;
    r->overlaps += r->is_busy;
    r->is_busy = 1;
    if (++r->calls == r->fail_at) {
        tessera_set_callback_error(r->sentence);
        r->is_busy = 0;
        return r->code;
    }
    for (v = begin[1]; v < end[1]; ++v)
        for (u = begin[0]; u < end[0]; ++u)
            for (t = begin[3]; t < end[3]; ++t)
                for (s = begin[2]; s < end[2]; ++s, to += C)
                    memcpy(to, small_texels + place(u, v, s, t), C);
    r->is_busy = 0;
    return to == (unsigned char*)out + out_bytes ? 0 : own_error;
}

static tessera_texel_source small_source(void) {
    tessera_texel_source source;
    tessera_texel_source_init(&source);
    source.texture = small_texture;
    source.texels = small_texels;
    source.texel_bytes = small_bytes;
    return source;
}

static tessera_texel_source source_of(reader* r) {
    tessera_texel_source source;
    tessera_texel_source_init(&source);
    source.texture = small_texture;
    source.read = read_texels;
    source.user = r;
    source.one_at_a_time = 1;
    return source;
}

static tessera_encode_options lossless(void) {
    tessera_encode_options options;
    tessera_encode_options_init(&options);
    options.rate_kind = TESSERA_MAX_ERROR;
    options.rate_value = 0;
    options.effort = 0;
    options.threads = 2;
    options.tile[0] = options.tile[1] = 4; /* several tiles, to stop between them */
    options.tile[2] = options.tile[3] = 2;
    return options;
}

/* ---- Files in memory, through functions */

typedef struct {
    const unsigned char* bytes;
    int reads, many, closed, fail_at, code;
} byte_reader;

static int read_bytes(void* user, uint64_t offset, void* out, size_t bytes) {
    byte_reader* r = user;
    if (++r->reads == r->fail_at)
        return r->code;
    memcpy(out, r->bytes + offset, bytes);
    return 0;
}

static int read_many_bytes(void* user, const tessera_byte_range* ranges, size_t count) {
    byte_reader* r = user;
    size_t i;
    ++r->many;
    for (i = 0; i < count; ++i)
        memcpy(ranges[i].out, r->bytes + ranges[i].offset, ranges[i].bytes);
    return 0;
}

static void close_bytes(void* user) {
    ++((byte_reader*)user)->closed;
}

static tessera_byte_source bytes_of(byte_reader* r, size_t size) {
    tessera_byte_source source;
    tessera_byte_source_init(&source);
    source.size = size;
    source.user = r;
    source.read = read_bytes;
    source.close = close_bytes;
    source.name = "reader";
    source.one_at_a_time = 1;
    return source;
}

typedef struct {
    unsigned char* bytes;
    size_t count, room;
    int pieces, code;
} writer;

static int write_bytes(void* user, const void* bytes, size_t count) {
    writer* w = user;
    ++w->pieces;
    if (w->code != 0)
        return w->code;
    if (count > w->room - w->count)
        return own_error;
    memcpy(w->bytes + w->count, bytes, count);
    w->count += count;
    return 0;
}

static int is_small_texture(tessera_decoder* decoder) {
    unsigned char texels[small_bytes];
    return tessera_decode_box(decoder, origin, small_end, texels, sizeof texels, NULL) == 0 &&
           memcmp(texels, small_texels, small_bytes) == 0;
}

/* ---- Tests */

static int test_versions_and_names(void) {
    uint32_t major = 99, minor = 99;
    char version[64] = "";
    CHECK(tessera_api_version() == TESSERA_API_VERSION);
    strncat(version, tessera_version(), sizeof version - 1);
    CHECK(strchr(version, '.') != NULL);
    tessera_format_version(&major, &minor);
    tessera_format_version(NULL, NULL);
    CHECK(major < 99 && minor < 99);
    CHECK(strcmp(tessera_error_name(TESSERA_OK), "ok") == 0);
    CHECK(strcmp(tessera_error_name(TESSERA_BAD_ARGUMENT), "bad_argument") == 0);
    CHECK(strcmp(tessera_error_name(TESSERA_IO), "io") == 0);
    CHECK(strcmp(tessera_error_name(TESSERA_INVALID_FILE), "invalid_file") == 0);
    CHECK(strcmp(tessera_error_name(TESSERA_RUNTIME), "runtime") == 0);
    CHECK(strcmp(tessera_error_name(TESSERA_UNSUPPORTED), "unsupported") == 0);
    CHECK(strcmp(tessera_error_name(TESSERA_CANCELLED), "cancelled") == 0);
    CHECK(strcmp(tessera_error_name(own_error), "callback") == 0);
    CHECK(strcmp(tessera_error_name(-1), "callback") == 0);
    return 0;
}

static int test_path(const char* path) {
    const tessera_texel_source source = small_source();
    const tessera_encode_options options = lossless();
    tessera_encode_report report;
    const uint32_t begin[4] = {5, 2, 0, 1}, end[4] = {9, 4, 5, 2};
    unsigned char box[4 * 2 * 5 * 1 * 3];
    tessera_decode_options decode;
    tessera_texture found;
    tessera_decoder* decoder = NULL;
    uint64_t bytes = 0;
    size_t i = 0, u, v, s, c;

    tessera_encode_report_init(&report);
    CHECK(tessera_encode_to_path(&source, path, &options, &report) == 0);
    CHECK(report.psnr == 999 && report.max_error == 0 && report.target_met == 1);
    CHECK(report.note[0] == 0 && report.raw_bytes == small_bytes && report.file_bytes > 100);
    CHECK(report.texels_that_matter == U * V * S * T && report.passes >= 1);
    CHECK(report.nan_count == 0 && report.infinity_count == 0 && report.seconds > 0);
    CHECK(report.bits_per_texel == 8.0 * (double)report.file_bytes / (U * V * S * T));

    REFUSED(tessera_open_path("/nonexistent/x.tess", NULL, &decoder), TESSERA_IO, "/nonexistent");
    CHECK(decoder == NULL);
    CHECK(tessera_open_path(path, NULL, &decoder) == 0);
    CHECK(tessera_get_texture(decoder, &found) == 0);
    CHECK(memcmp(&found, &small_texture, sizeof found) == 0);
    CHECK(tessera_box_bytes(&found, begin, end, &bytes) == 0 && bytes == sizeof box);
    REFUSED(tessera_decode_box(decoder, begin, end, box, sizeof box - 1, NULL),
            TESSERA_BAD_ARGUMENT, "buffer");
    REFUSED(tessera_decode_box(decoder, end, begin, box, sizeof box, NULL), TESSERA_BAD_ARGUMENT,
            "box");
    tessera_decode_options_init(&decode);
    CHECK(decode.threads == 0 && decode.level == 0 && decode.integrity == TESSERA_CHECK_PAGES);
    for (decode.integrity = 0; decode.integrity < 2; ++decode.integrity) {
        memset(box, 0, sizeof box);
        CHECK(tessera_decode_box(decoder, begin, end, box, sizeof box, &decode) == 0);
        for (i = 0, v = 2; v < 4; ++v)
            for (u = 5; u < 9; ++u)
                for (s = 0; s < 5; ++s)
                    for (c = 0; c < 3; ++c, ++i)
                        CHECK(box[i] == small_texels[place(u, v, s, 1) + c]);
    }
    REFUSED(tessera_decode_box(decoder, begin, end, box, sizeof box, &decode), TESSERA_BAD_ARGUMENT,
            "integrity");
    CHECK(is_small_texture(decoder));
    tessera_close(decoder);
    tessera_close(NULL);
    return 0;
}

/* Every way to pass texels and files gives the same bytes. */
static int test_memory_and_functions(const char* path) {
    const tessera_texel_source memory = small_source();
    const tessera_encode_options options = lossless();
    tessera_encode_options again;
    tessera_encode_report report;
    reader r = {0};
    const tessera_texel_source function = source_of(&r);
    void *first = NULL, *second = NULL;
    size_t first_bytes = 0, second_bytes = 0;
    writer w = {0};
    byte_reader b = {0};
    tessera_byte_source bytes;
    tessera_decoder* decoder = NULL;
    FILE* file;
    CHECK(tessera_encode_to_memory(&memory, &first, &first_bytes, &options, NULL) == 0);
    CHECK(tessera_encode_to_memory(&function, &second, &second_bytes, &options, NULL) == 0);
    CHECK(first_bytes == second_bytes && memcmp(first, second, first_bytes) == 0);
    CHECK(r.calls > 10 && r.overlaps == 0);
    w.bytes = second;
    w.room = second_bytes;
    memset(second, 0, second_bytes);
    CHECK(tessera_encode_to_function(&memory, write_bytes, &w, &options, NULL) == 0);
    CHECK(w.count == first_bytes && memcmp(first, second, first_bytes) == 0);
    CHECK(tessera_encode_to_path(&memory, path, &options, NULL) == 0);
    file = fopen(path, "rb");
    CHECK(file != NULL);
    memset(second, 0, second_bytes);
    CHECK(fread(second, 1, second_bytes, file) == second_bytes && fgetc(file) == EOF);
    fclose(file);
    CHECK(memcmp(first, second, first_bytes) == 0);
    tessera_free(second);
    tessera_free(NULL);

    CHECK(tessera_open_memory(first, first_bytes, NULL, &decoder) == 0);
    CHECK(is_small_texture(decoder));
    /* Encoding the decoded texels with reuse gives the same file at any rate. */
    tessera_encode_options_init(&again);
    again.reuse = decoder;
    tessera_encode_report_init(&report);
    CHECK(tessera_encode_to_memory(&memory, &second, &second_bytes, &again, &report) == 0);
    CHECK(first_bytes == second_bytes && memcmp(first, second, first_bytes) == 0);
    CHECK(report.kept_tiles >= 1);
    tessera_free(second);
    tessera_close(decoder);

    b.bytes = first;
    bytes = bytes_of(&b, first_bytes);
    CHECK(tessera_open_source(&bytes, NULL, &decoder) == 0);
    CHECK(b.reads >= 1 && b.reads <= 2 && b.closed == 0);
    CHECK(is_small_texture(decoder));
    CHECK(b.closed == 0);
    tessera_close(decoder);
    CHECK(b.closed == 1);

    bytes.read_many = read_many_bytes; /* as for a file on a web server */
    bytes.slow = 1;
    CHECK(tessera_open_source(&bytes, NULL, &decoder) == 0);
    CHECK(is_small_texture(decoder));
    tessera_close(decoder);
    CHECK(b.closed == 2);
    tessera_free(first);
    return 0;
}

static int test_failing_functions(const char* path) {
    const tessera_encode_options options = lossless();
    const tessera_texel_source memory = small_source();
    reader r = {0};
    tessera_texel_source source = source_of(&r);
    writer w = {0};
    byte_reader b = {0};
    tessera_byte_source bytes;
    tessera_decoder* decoder = NULL;
    void* file = &r;
    size_t file_bytes = 99;
    /* Reading texels fails in the first call or in a later one. */
    for (r.fail_at = 1; r.fail_at <= 8; r.fail_at += 7) {
        r.calls = 0;
        r.code = own_error;
        r.sentence = NULL;
        REFUSED(tessera_encode_to_memory(&source, &file, &file_bytes, &options, NULL), own_error,
                "read failed with code 1234 (callback)");
        CHECK(file == NULL && file_bytes == 0);
        r.calls = 0;
        r.code = TESSERA_IO;
        r.sentence = "the tape is torn";
        REFUSED(tessera_encode_to_path(&source, path, &options, NULL), TESSERA_IO,
                "the tape is torn");
    }
    CHECK(remove(path) != 0); /* no file was left */
    r.calls = 0;
    r.code = -5; /* the earlier message must not appear again */
    r.sentence = NULL;
    REFUSED(tessera_encode_to_path(&source, path, &options, NULL), -5, "code -5 (callback)");
    /* Writing the file fails. */
    w.code = own_error;
    REFUSED(tessera_encode_to_function(&memory, write_bytes, &w, &options, NULL), own_error,
            "write failed");
    CHECK(w.pieces == 1);
    /* Opening a file fails. */
    CHECK(tessera_encode_to_memory(&memory, &file, &file_bytes, &options, NULL) == 0);
    b.bytes = file;
    b.code = own_error;
    b.fail_at = 1;
    bytes = bytes_of(&b, file_bytes);
    REFUSED(tessera_open_source(&bytes, NULL, &decoder), own_error, "reader: the function read");
    CHECK(decoder == NULL && b.closed == 1);
    tessera_free(file);
    return 0;
}

/* ---- Stopping */

typedef struct {
    int calls, stop_at;
    double last, total;
    char stage[32];
} listener;

static int listen_to(void* user, const char* stage, double done, double total) {
    listener* l = user;
    l->last = done;
    l->total = total;
    l->stage[0] = 0;
    strncat(l->stage, stage, sizeof l->stage - 1);
    return ++l->calls == l->stop_at;
}

static int always(void* user) {
    (void)user;
    return 1;
}

/* Writes nothing, because several threads call it. */
static int is_time(void* user) {
    return ((const listener*)user)->calls >= 3;
}

static int test_stopping(const char* path) {
    const tessera_texel_source source = small_source();
    tessera_encode_options options = lossless();
    tessera_decode_options decode;
    unsigned char texels[small_bytes];
    tessera_decoder* decoder = NULL;
    listener l = {0};
    void *file = NULL, *plain = NULL;
    size_t file_bytes = 0, plain_bytes = 0;
    CHECK(tessera_encode_to_memory(&source, &plain, &plain_bytes, &options, NULL) == 0);
    options.progress = listen_to;
    options.user = &l;
    options.threads = 1;
    CHECK(tessera_encode_to_memory(&source, &file, &file_bytes, &options, NULL) == 0);
    CHECK(l.calls > 10 && l.last <= l.total && strlen(l.stage) > 0);
    CHECK(file_bytes == plain_bytes && memcmp(file, plain, file_bytes) == 0);
    tessera_free(file);
    for (l.stop_at = 1; l.stop_at < 10; l.stop_at += 4) {
        l.calls = 0;
        REFUSED(tessera_encode_to_path(&source, path, &options, NULL), TESSERA_CANCELLED,
                "interrupted");
        CHECK(l.calls >= l.stop_at && l.calls <= l.stop_at + 1);
        CHECK(remove(path) != 0);
    }
    l.calls = l.stop_at = 0;
    options.cancelled = always;
    CHECK(tessera_encode_to_path(&source, path, &options, NULL) == TESSERA_CANCELLED);
    options.cancelled = is_time;
    CHECK(tessera_encode_to_path(&source, path, &options, NULL) == TESSERA_CANCELLED);

    /* With a journal the next run resumes and gives the same file. */
    options.journal = TESSERA_JOURNAL_START;
    l.calls = 0;
    l.stop_at = 50; /* in the middle of the pass over the texture */
    options.cancelled = NULL;
    CHECK(tessera_encode_to_path(&source, path, &options, NULL) == TESSERA_CANCELLED);
    CHECK(strstr(tessera_last_error(), ".journal") != NULL);
    options.journal = TESSERA_JOURNAL_RESUME;
    l.calls = l.stop_at = 0;
    options.rate_value = 1;
    CHECK(tessera_encode_to_path(&source, path, &options, NULL) == TESSERA_BAD_ARGUMENT);
    options.rate_value = 0;
    CHECK(tessera_encode_to_path(&source, path, &options, NULL) == 0);
    CHECK(tessera_open_path(path, NULL, &decoder) == 0);
    CHECK(is_small_texture(decoder));
    tessera_close(decoder);

    CHECK(tessera_open_memory(plain, plain_bytes, NULL, &decoder) == 0);
    tessera_decode_options_init(&decode);
    decode.progress = listen_to;
    decode.user = &l;
    decode.threads = 1;
    l.calls = l.stop_at = 0;
    CHECK(tessera_decode_box(decoder, origin, small_end, texels, sizeof texels, &decode) == 0);
    CHECK(l.calls > 10 && l.last == l.total && strcmp(l.stage, "decode") == 0);
    for (l.stop_at = 1; l.stop_at < 10; l.stop_at += 4) {
        l.calls = 0;
        REFUSED(tessera_decode_box(decoder, origin, small_end, texels, sizeof texels, &decode),
                TESSERA_CANCELLED, "interrupted");
        CHECK(l.calls >= l.stop_at && l.calls <= l.stop_at + 1);
    }
    decode.progress = NULL;
    decode.cancelled = always;
    CHECK(tessera_decode_box(decoder, origin, small_end, texels, sizeof texels, &decode) ==
          TESSERA_CANCELLED);
    tessera_close(decoder);
    tessera_free(plain);
    return 0;
}

/* ---- Coarse levels, parts of files, damage */

enum { big_side = 64, big_bytes = big_side * big_side * 8 * 8 };

static int test_levels_parts_and_damage(void) {
    const uint32_t end[4] = {big_side, big_side, 8, 8};
    unsigned char* texels = malloc(big_bytes);
    unsigned char* got = malloc(big_bytes);
    unsigned char* file = NULL;
    size_t file_bytes = 0, i;
    tessera_texel_source source;
    tessera_encode_options options;
    tessera_open_options open;
    tessera_decode_options decode;
    tessera_decoder* decoder = NULL;
    tessera_level level;
    tessera_file_state state;
    tessera_texture texture;
    uint64_t bytes = 0;
    listener l = {0};
    byte_reader b = {0};
    tessera_byte_source byte_source;
    void* made = NULL;
    CHECK(texels != NULL && got != NULL);
    for (i = 0; i < big_bytes; ++i) /* a ramp along v with some noise */
        texels[i] = (unsigned char)(i / (big_side * 64) * 3 + (i * 2654435761u >> 28 & 7));
    tessera_texel_source_init(&source);
    source.texture.size[0] = source.texture.size[1] = big_side;
    source.texture.size[2] = source.texture.size[3] = 8;
    source.texture.channels = 1;
    source.texels = texels;
    source.texel_bytes = big_bytes;
    tessera_encode_options_init(&options);
    options.rate_value = 95; /* the noise makes the file longer than the first read */
    options.effort = 0;
    options.layers = 1;
    options.tile[0] = options.tile[1] = 16;
    options.tile[2] = options.tile[3] = 8;
    CHECK(tessera_encode_to_memory(&source, &made, &file_bytes, &options, NULL) == 0);
    file = made;

    CHECK(tessera_open_memory(file, file_bytes, NULL, &decoder) == 0);
    CHECK(tessera_level_count(decoder) >= 2);
    tessera_level_init(&level);
    CHECK(tessera_get_level(decoder, 0, &level) == 0);
    CHECK(memcmp(level.size, end, sizeof end) == 0);
    CHECK(level.spatial_lod == 0 && level.angular_lod == 0);
    CHECK(level.largest_tile[0] == 16 && level.largest_tile[3] == 8);
    CHECK(level.tile_count[0] == 4 && level.tile_count[1] == 4 && level.tile_count[2] == 1);
    CHECK(tessera_get_level(decoder, 1, &level) == 0);
    CHECK(level.spatial_lod + level.angular_lod >= 1);
    CHECK(level.size[0] == (uint32_t)big_side >> level.spatial_lod);
    CHECK(level.size[3] == 8u >> level.angular_lod);
    REFUSED(tessera_get_level(decoder, 99, &level), TESSERA_BAD_ARGUMENT,
            "level 99 does not exist");
    REFUSED(tessera_get_level(decoder, tessera_level_count(decoder), &level), TESSERA_BAD_ARGUMENT,
            "does not exist");
    /* The coarse level shows the same ramp. */
    CHECK(tessera_get_texture(decoder, &texture) == 0);
    CHECK(tessera_box_bytes(&texture, origin, level.size, &bytes) == 0 && bytes < big_bytes);
    tessera_decode_options_init(&decode);
    decode.level = 1;
    decode.progress = listen_to;
    decode.user = &l;
    CHECK(tessera_decode_box(decoder, origin, level.size, got, (size_t)bytes, &decode) == 0);
    CHECK(l.calls == 1);
    CHECK(got[0] < 30 && got[bytes - 1] > 150);
    l.stop_at = 2;
    CHECK(tessera_decode_box(decoder, origin, level.size, got, (size_t)bytes, &decode) ==
          TESSERA_CANCELLED);
    decode.cancelled = always;
    CHECK(tessera_decode_box(decoder, origin, level.size, got, (size_t)bytes, &decode) ==
          TESSERA_CANCELLED);
    decode.cancelled = NULL;
    decode.progress = NULL;
    REFUSED(tessera_decode_box(decoder, origin, end, got, big_bytes, &decode), TESSERA_BAD_ARGUMENT,
            "level 1");
    decode.level = 99;
    CHECK(tessera_decode_box(decoder, origin, end, got, big_bytes, &decode) ==
          TESSERA_BAD_ARGUMENT);
    tessera_file_state_init(&state);
    CHECK(tessera_get_file_state(decoder, &state) == 0);
    CHECK(state.is_partial == 0 && state.file_bytes == file_bytes);
    CHECK(state.received_bytes == file_bytes && state.tiles > 16 && state.filled_texels == 0);
    tessera_close(decoder);

    /* A read of tiles fails, and the next try succeeds. */
    b.bytes = file;
    byte_source = bytes_of(&b, file_bytes);
    CHECK(tessera_open_source(&byte_source, NULL, &decoder) == 0);
    for (b.code = TESSERA_IO; b.code <= own_error; b.code += own_error - TESSERA_IO) {
        b.fail_at = b.reads + 1;
        CHECK(tessera_decode_box(decoder, origin, end, got, big_bytes, NULL) == b.code);
        CHECK(strstr(tessera_last_error(), "reader: the function read failed") != NULL);
    }
    CHECK(tessera_decode_box(decoder, origin, end, got, big_bytes, NULL) == 0);
    tessera_close(decoder);
    CHECK(b.closed == 1);

    /* The last byte is missing. */
    CHECK(tessera_open_memory(file, file_bytes - 1, NULL, &decoder) == TESSERA_INVALID_FILE);
    tessera_open_options_init(&open);
    open.allow_partial = 1;
    CHECK(tessera_open_memory(file, file_bytes - 1, &open, &decoder) == 0);
    memset(got, 255, big_bytes);
    CHECK(tessera_decode_box(decoder, origin, end, got, big_bytes, NULL) == 0);
    CHECK(got[0] < 30 && got[big_bytes - 1] > 150);
    CHECK(tessera_get_file_state(decoder, &state) == 0);
    CHECK(state.is_partial == 1 && state.received_bytes == file_bytes - 1);
    CHECK(state.file_bytes == file_bytes && state.missing_tiles >= 1 && state.missing_tiles < 16);
    CHECK(state.damaged_tiles == 0 && state.filled_texels == state.missing_tiles * 16 * 16 * 64);
    tessera_close(decoder);

    /* The last byte is wrong. */
    file[file_bytes - 1] ^= 1;
    CHECK(tessera_open_memory(file, file_bytes, NULL, &decoder) == 0);
    REFUSED(tessera_decode_box(decoder, origin, end, got, big_bytes, NULL), TESSERA_INVALID_FILE,
            "tile");
    tessera_close(decoder);
    tessera_open_options_init(&open);
    open.allow_damaged = 1;
    CHECK(tessera_open_memory(file, file_bytes, &open, &decoder) == 0);
    CHECK(tessera_decode_box(decoder, origin, end, got, big_bytes, NULL) == 0);
    CHECK(tessera_get_file_state(decoder, &state) == 0);
    CHECK(state.damaged_tiles >= 1 && state.missing_tiles == 0 && state.is_partial == 0);
    tessera_close(decoder);
    file[0] ^= 1;
    decoder = (tessera_decoder*)got;
    REFUSED(tessera_open_memory(file, file_bytes, NULL, &decoder), TESSERA_INVALID_FILE,
            "<memory>");
    CHECK(decoder == NULL);
    tessera_free(made);
    free(texels);
    free(got);
    return 0;
}

/* ---- Metadata, description and masks */

static int test_metadata_and_description(void) {
    const tessera_key_value entries[] = {{"Title", "M\xC3\xBCnster"}, {"Artist", "n.n."}};
    const tessera_key_value twice[] = {{"Title", "a"}, {"Title", "b"}};
    const tessera_key_value latin1 = {"Title", "M\xFCnster"}, nothing = {"Title", NULL};
    const tessera_texel_source source = small_source();
    tessera_encode_options options = lossless();
    tessera_description description, found;
    tessera_decoder* decoder = NULL;
    void* file = NULL;
    size_t file_bytes = 0, bytes = 0, i;
    const char *key = NULL, *value = NULL;
    const void* mesh = NULL;
    options.metadata = entries;
    options.metadata_count = 2;
    tessera_description_init(&description);
    description.proxy = TESSERA_PROXY_SPHERE;
    description.surface_map = TESSERA_SURFACE_SPHERE_LONGITUDE_LATITUDE;
    description.angular_map = TESSERA_ANGULAR_HEMISPHERE_ALPHA_BETA;
    description.transfer = TESSERA_TRANSFER_SRGB;
    description.primaries = TESSERA_PRIMARIES_BT709;
    description.sphere_centre[1] = 2;
    description.sphere_radius = 3.5f;
    description.viewing_radius[0] = 4;
    description.viewing_radius[1] = 5;
    options.description = &description;
    CHECK(tessera_encode_to_memory(&source, &file, &file_bytes, &options, NULL) == 0);
    CHECK(tessera_open_memory(file, file_bytes, NULL, &decoder) == 0);
    tessera_description_init(&found);
    CHECK(tessera_get_description(decoder, &found) == 0);
    CHECK(memcmp(&found, &description, sizeof found) == 0);
    CHECK(tessera_metadata_count(decoder) == 2); /* the file is too small for Software */
    CHECK(tessera_metadata_value(decoder, "Software") == NULL);
    CHECK(strcmp(tessera_metadata_value(decoder, "Title"), "M\xC3\xBCnster") == 0);
    CHECK(tessera_metadata_value(decoder, "Nothing") == NULL);
    CHECK(tessera_metadata_at(decoder, 0, &key, &value, &bytes) == 0);
    CHECK(strcmp(key, "Artist") == 0 && strcmp(value, "n.n.") == 0 && bytes == 4);
    for (i = 0; i < tessera_metadata_count(decoder); ++i) {
        CHECK(tessera_metadata_at(decoder, i, &key, &value, NULL) == 0);
        CHECK(tessera_metadata_value(decoder, key) == value);
    }
    CHECK(tessera_metadata_at(decoder, i, &key, &value, NULL) == TESSERA_BAD_ARGUMENT);
    CHECK(tessera_get_mesh(decoder, &mesh, &bytes) == 0 && mesh == NULL && bytes == 0);
    CHECK(tessera_get_mesh(decoder, NULL, &bytes) == TESSERA_BAD_ARGUMENT);
    tessera_close(decoder);
    tessera_free(file);

    description.proxy = TESSERA_PROXY_MESH;
    description.sphere_radius = 0;
    REFUSED(tessera_check_options(&small_texture, &options), TESSERA_BAD_ARGUMENT, "no mesh");
    options.mesh = "DRACO";
    options.mesh_bytes = 5;
    REFUSED(tessera_check_options(&small_texture, &options), TESSERA_BAD_ARGUMENT, "cut off");
    options.mesh = NULL;
    REFUSED(tessera_check_options(&small_texture, &options), TESSERA_BAD_ARGUMENT, "mesh");
    options.mesh_bytes = 0;
    description.proxy = TESSERA_PROXY_SPHERE_INSIDE;
    description.sphere_radius = 1;
    description.angular_map = TESSERA_ANGULAR_OCTAHEDRAL_MIRRORED;
    CHECK(tessera_check_options(&small_texture, &options) == 0);

    options.metadata = twice;
    REFUSED(tessera_check_options(&small_texture, &options), TESSERA_BAD_ARGUMENT, "twice");
    options.metadata_count = 1;
    options.metadata = &latin1;
    REFUSED(tessera_check_options(&small_texture, &options), TESSERA_BAD_ARGUMENT, "UTF-8");
    options.metadata = &nothing;
    REFUSED(tessera_check_options(&small_texture, &options), TESSERA_BAD_ARGUMENT, "null");
    options.metadata = NULL;
    REFUSED(tessera_check_options(&small_texture, &options), TESSERA_BAD_ARGUMENT, "null");
    options.metadata_count = 0;
    CHECK(tessera_check_options(&small_texture, &options) == 0);
    description.alpha = TESSERA_ALPHA_STRAIGHT;
    REFUSED(tessera_check_options(&small_texture, &options), TESSERA_BAD_ARGUMENT, "alpha");
    description.alpha = TESSERA_ALPHA_NONE;
    description.transfer = 77;
    REFUSED(tessera_check_options(&small_texture, &options), TESSERA_BAD_ARGUMENT, "transfer");
    return 0;
}

static int test_masks_and_halves(void) {
    /* Only some views matter. Their texels must be exact. */
    unsigned char mask_texels[S] = {1, 1, 0, 0, 1}, got[small_bytes];
    const uint16_t halves[8] = {0x3C00, 0x7E00, 0x7C00, 0xFC00, 0, 0x3C00, 0x3800, 0x7E00};
    const uint32_t end[4] = {8, 1, 1, 1};
    uint16_t back[8];
    tessera_texel_source source = small_source(), mask;
    tessera_encode_options options = lossless();
    tessera_encode_report report;
    tessera_decoder* decoder = NULL;
    void* file = NULL;
    size_t file_bytes = 0, u, v, s, t;
    tessera_texel_source_init(&mask);
    mask.texture.size[0] = mask.texture.size[1] = mask.texture.size[3] = 1;
    mask.texture.size[2] = S;
    mask.texture.channels = 1;
    mask.texels = mask_texels;
    mask.texel_bytes = S;
    options.mask = &mask;
    tessera_encode_report_init(&report);
    CHECK(tessera_encode_to_memory(&source, &file, &file_bytes, &options, &report) == 0);
    CHECK(report.texels_that_matter == U * V * 3 * T);
    CHECK(tessera_open_memory(file, file_bytes, NULL, &decoder) == 0);
    CHECK(tessera_decode_box(decoder, origin, small_end, got, sizeof got, NULL) == 0);
    for (v = 0; v < V; ++v)
        for (u = 0; u < U; ++u)
            for (t = 0; t < T; ++t)
                for (s = 0; s < S; ++s)
                    if (mask_texels[s])
                        CHECK(memcmp(got + place(u, v, s, t), small_texels + place(u, v, s, t),
                                     C) == 0);
    tessera_close(decoder);
    tessera_free(file);
    mask.texel_bytes = S - 1;
    REFUSED(tessera_check_options(&small_texture, &options), TESSERA_BAD_ARGUMENT, "mask");

    options = lossless();
    memcpy(source.texture.size, end, sizeof end);
    source.texture.type = TESSERA_HALF16;
    source.texture.channels = 1;
    source.texels = halves;
    source.texel_bytes = sizeof halves;
    CHECK(tessera_encode_to_memory(&source, &file, &file_bytes, &options, &report) == 0);
    CHECK(report.nan_count == 2 && report.infinity_count == 2);
    CHECK(tessera_open_memory(file, file_bytes, NULL, &decoder) == 0);
    CHECK(tessera_decode_box(decoder, origin, end, back, sizeof back, NULL) == 0);
    CHECK(back[0] == 0x3C00 && back[1] == 0 && back[2] == 0x7BFF && back[3] == 0xFBFF);
    tessera_close(decoder);
    tessera_free(file);
    options.strict = 1;
    CHECK(tessera_encode_to_memory(&source, &file, &file_bytes, &options, &report) ==
          TESSERA_INVALID_FILE);
    /* The target is beyond the finest quantiser. The noise is stored losslessly, which meets it. */
    options = lossless();
    options.rate_kind = TESSERA_PSNR;
    options.rate_value = 120;
    for (u = 0; u < 8; ++u)
        back[u] = (uint16_t)(u * 3671 % 31000);
    source.texels = back;
    CHECK(tessera_encode_to_memory(&source, &file, &file_bytes, &options, &report) == 0);
    CHECK(report.psnr >= 120 && report.target_met == 1);
    tessera_free(file);
    return 0;
}

/* For this texture a file of the finest quantiser is smaller than a lossless one. */
static int test_targets_beyond_every_quantiser(void) {
    const tessera_texel_source source = small_source();
    tessera_encode_options options = lossless();
    tessera_encode_report missed, met;
    void* file = NULL;
    size_t file_bytes = 0;
    CHECK(options.lossless_fallback == 0);
    options.rate_kind = TESSERA_PSNR;
    options.rate_value = 100;
    tessera_encode_report_init(&missed);
    tessera_encode_report_init(&met);
    CHECK(tessera_encode_to_memory(&source, &file, &file_bytes, &options, &missed) == 0);
    CHECK(missed.target_met == 0 && missed.psnr < 100 && missed.note[0] != 0);
    tessera_free(file);
    options.lossless_fallback = 1;
    CHECK(tessera_encode_to_memory(&source, &file, &file_bytes, &options, &met) == 0);
    CHECK(met.target_met == 1 && met.psnr == 999 && met.max_error == 0 && met.note[0] != 0);
    CHECK(met.file_bytes > missed.file_bytes && met.passes > missed.passes);
    tessera_free(file);
    return 0;
}

/* An array of the axes s, t, u, v and channels, in which u counts down, gives the same bytes as the
 * dense texels; as does one whose channels are the outermost axis. */
static int test_strides(void) {
    const tessera_texel_source dense = small_source();
    const tessera_encode_options options = lossless();
    static const int64_t orders[2][5] = {{-V * C, C, T * U * V * C, U * V * C, 1},
                                         {V * S * T, S * T, T, 1, U * V * S * T}};
    static unsigned char texels[small_bytes];
    void *wanted = NULL, *file = NULL;
    size_t wanted_bytes = 0, file_bytes = 0, i, u, v, s, t, c;
    CHECK(tessera_encode_to_memory(&dense, &wanted, &wanted_bytes, &options, NULL) == 0);
    for (i = 0; i < 2; ++i) {
        const int64_t* step = orders[i];
        unsigned char* first = texels + (step[0] < 0 ? -step[0] * (U - 1) : 0);
        tessera_texel_source source = dense;
        for (v = 0; v < V; ++v)
            for (u = 0; u < U; ++u)
                for (t = 0; t < T; ++t)
                    for (s = 0; s < S; ++s)
                        for (c = 0; c < C; ++c)
                            first[(int64_t)u * step[0] + (int64_t)v * step[1] +
                                  (int64_t)s * step[2] + (int64_t)t * step[3] +
                                  (int64_t)c * step[4]] = small_texels[place(u, v, s, t) + c];
        source.texels = first;
        source.texel_bytes = 0;
        memcpy(source.strides, step, sizeof source.strides);
        CHECK(tessera_encode_to_memory(&source, &file, &file_bytes, &options, NULL) == 0);
        CHECK(file_bytes == wanted_bytes && memcmp(file, wanted, wanted_bytes) == 0);
        tessera_free(file);
    }
    tessera_free(wanted);
    return 0;
}

/* ---- Errors */

static int test_options_out_of_range(void) {
    tessera_encode_options options;
    tessera_texture texture = small_texture;
    const tessera_texel_source good = small_source();
    tessera_texel_source source = good;
    void* file = NULL;
    size_t file_bytes = 0;
    CHECK(tessera_check_options(&texture, NULL) == 0);
    options = lossless();
    options.rate_kind = TESSERA_QUALITY;
    options.rate_value = 101;
    REFUSED(tessera_check_options(&texture, &options), TESSERA_BAD_ARGUMENT, "quality");
    options.rate_kind = 5;
    REFUSED(tessera_check_options(&texture, &options), TESSERA_BAD_ARGUMENT, "rate_kind");
    options = lossless();
    options.rate_kind = TESSERA_BYTES;
    options.rate_value = 100;
    REFUSED(tessera_check_options(&texture, &options), TESSERA_BAD_ARGUMENT, "smaller than");
    options = lossless();
    options.effort = -1;
    REFUSED(tessera_check_options(&texture, &options), TESSERA_BAD_ARGUMENT, "effort");
    options = lossless();
    options.tile[0] = 257;
    REFUSED(tessera_check_options(&texture, &options), TESSERA_BAD_ARGUMENT, "tile");
    options = lossless();
    options.journal = 3;
    REFUSED(tessera_check_options(&texture, &options), TESSERA_BAD_ARGUMENT, "journal");
    texture.channels = 5;
    REFUSED(tessera_check_options(&texture, NULL), TESSERA_BAD_ARGUMENT, "channels");
    texture.channels = 256 + 3;
    REFUSED(tessera_check_options(&texture, NULL), TESSERA_BAD_ARGUMENT, "channels");
    texture = small_texture;
    texture.type = 2;
    REFUSED(tessera_check_options(&texture, NULL), TESSERA_BAD_ARGUMENT, "type");
    texture = small_texture;
    texture.size[2] = 0;
    CHECK(tessera_check_options(&texture, NULL) == TESSERA_BAD_ARGUMENT);

    source.texel_bytes -= 1;
    REFUSED(tessera_encode_to_memory(&source, &file, &file_bytes, NULL, NULL), TESSERA_BAD_ARGUMENT,
            "texel_bytes");
    source = good;
    source.read = read_texels;
    REFUSED(tessera_encode_to_memory(&source, &file, &file_bytes, NULL, NULL), TESSERA_BAD_ARGUMENT,
            "either texels or read");
    source.texels = NULL;
    source.strides[1] = 3;
    REFUSED(tessera_encode_to_memory(&source, &file, &file_bytes, NULL, NULL), TESSERA_BAD_ARGUMENT,
            "strides belong to texels");
    source.read = NULL;
    CHECK(tessera_encode_to_memory(&source, &file, &file_bytes, NULL, NULL) ==
          TESSERA_BAD_ARGUMENT);
    CHECK(file == NULL);
    return 0;
}

static int test_box_bytes(void) {
    tessera_texture texture = {{1, 1, 1, 1}, TESSERA_HALF16, 4};
    const uint32_t one[4] = {1, 1, 1, 1};
    uint32_t end[4] = {1u << 20, 1u << 20, 1u << 10, 1u << 10};
    uint64_t bytes = 7;
    CHECK(tessera_box_bytes(&texture, origin, one, &bytes) == 0 && bytes == 8);
    CHECK(tessera_box_bytes(&texture, origin, end, &bytes) == 0);
    CHECK(bytes == (uint64_t)8 << 60 || sizeof(size_t) < 8);
    end[0] *= 2; /* 2^64 */
    bytes = 7;
    REFUSED(tessera_box_bytes(&texture, origin, end, &bytes), TESSERA_UNSUPPORTED,
            "too many bytes for a size_t");
    CHECK(bytes == 7);
    CHECK(tessera_box_bytes(&texture, one, one, &bytes) == TESSERA_BAD_ARGUMENT);
    CHECK(tessera_box_bytes(&texture, one, origin, &bytes) == TESSERA_BAD_ARGUMENT);
    texture.channels = 0;
    CHECK(tessera_box_bytes(&texture, origin, one, &bytes) == TESSERA_BAD_ARGUMENT);
    return 0;
}

/* Structures of programs built for an older or newer library. */
static int test_structures_that_grow(void) {
    const tessera_texel_source source = small_source();
    struct {
        tessera_encode_options now;
        uint64_t later[2];
    } newer;
    struct {
        tessera_encode_report now;
        uint64_t later;
    } report;
    tessera_encode_options older;
    tessera_open_options open;
    tessera_decoder* decoder = NULL;
    void* file = NULL;
    size_t file_bytes = 0, full_bytes = 0;

    /* The library sets the defaults of the fields that the caller knows. */
    memset(&older, 0xEE, sizeof older);
    tessera_encode_options_init_sized(&older, offsetof(tessera_encode_options, threads));
    CHECK(older.struct_size == offsetof(tessera_encode_options, threads));
    CHECK(older.rate_kind == TESSERA_QUALITY && older.rate_value == 75);
    CHECK(older.threads == 0xEEEEEEEEu); /* later fields were not written */
    older.effort = 0;
    CHECK(tessera_encode_to_memory(&source, &file, &file_bytes, &older, NULL) == 0);
    tessera_free(file);
    tessera_encode_options_init(&older);
    older.effort = 0;
    CHECK(tessera_encode_to_memory(&source, &file, &full_bytes, &older, NULL) == 0);
    CHECK(file_bytes == full_bytes);

    tessera_encode_options_init_sized(&newer.now, sizeof newer);
    CHECK(newer.now.struct_size == sizeof newer && newer.later[0] == 0 && newer.later[1] == 0);
    CHECK(tessera_check_options(&small_texture, &newer.now) == 0);
    newer.later[1] = 1;
    REFUSED(tessera_check_options(&small_texture, &newer.now), TESSERA_UNSUPPORTED,
            "is not known to this library");
    newer.now.struct_size = 0;
    REFUSED(tessera_check_options(&small_texture, &newer.now), TESSERA_BAD_ARGUMENT,
            "tessera_encode_options_init");
    newer.now.struct_size = (size_t)-1;
    CHECK(tessera_check_options(&small_texture, &newer.now) == TESSERA_BAD_ARGUMENT);
    tessera_free(file);

    memset(&report, 0xEE, sizeof report);
    report.now.struct_size = offsetof(tessera_encode_report, psnr);
    CHECK(tessera_encode_to_memory(&source, &file, &file_bytes, &older, &report.now) == 0);
    CHECK(report.now.file_bytes == file_bytes && report.now.bits_per_texel > 0);
    CHECK(report.now.passes == 0xEEEEEEEEu);
    CHECK(report.now.struct_size == offsetof(tessera_encode_report, psnr));
    tessera_free(file);
    tessera_encode_report_init_sized(&report.now, sizeof report);
    report.later = 5;
    CHECK(tessera_encode_to_memory(&source, &file, &file_bytes, &older, &report.now) == 0);
    CHECK(report.now.passes >= 1 && report.later == 0);
    tessera_free(file);
    report.now.struct_size = 0;
    REFUSED(tessera_encode_to_memory(&source, &file, &file_bytes, &older, &report.now),
            TESSERA_BAD_ARGUMENT, "tessera_encode_report_init");
    CHECK(file == NULL);

    memset(&open, 0, sizeof open);
    REFUSED(tessera_open_memory(small_texels, small_bytes, &open, &decoder), TESSERA_BAD_ARGUMENT,
            "tessera_open_options_init");
    tessera_open_options_init_sized(NULL, sizeof open);
    open.struct_size = 3;
    tessera_open_options_init_sized(&open, 0);
    CHECK(open.struct_size == 3);
    return 0;
}

static int test_null_pointers(void) {
    const tessera_texel_source source = small_source();
    tessera_encode_options options = lossless();
    tessera_byte_source bytes;
    byte_reader b = {0};
    tessera_decoder *decoder = NULL, *other = NULL;
    tessera_texture texture;
    tessera_level level;
    tessera_file_state state;
    tessera_description description;
    unsigned char texels[small_bytes];
    const char *key = NULL, *value = NULL;
    void* file = NULL;
    size_t file_bytes = 0;
    uint64_t size = 0;
    const int bad = TESSERA_BAD_ARGUMENT;
    CHECK(tessera_encode_to_memory(NULL, &file, &file_bytes, &options, NULL) == bad);
    CHECK(tessera_encode_to_memory(&source, NULL, &file_bytes, &options, NULL) == bad);
    CHECK(tessera_encode_to_memory(&source, &file, NULL, &options, NULL) == bad);
    REFUSED(tessera_encode_to_path(&source, NULL, &options, NULL), bad, "path");
    CHECK(tessera_encode_to_path(NULL, "x", &options, NULL) == bad);
    CHECK(tessera_encode_to_function(&source, NULL, NULL, &options, NULL) == bad);
    CHECK(tessera_check_options(NULL, &options) == bad);
    CHECK(tessera_encode_to_memory(&source, &file, &file_bytes, &options, NULL) == 0);
    CHECK(tessera_open_path(NULL, NULL, &decoder) == bad);
    CHECK(tessera_open_path("x", NULL, NULL) == bad);
    CHECK(tessera_open_memory(NULL, 5, NULL, &decoder) == bad);
    CHECK(tessera_open_memory(file, file_bytes, NULL, NULL) == bad);
    CHECK(tessera_open_memory(file, 0, NULL, &decoder) == TESSERA_INVALID_FILE);
    CHECK(tessera_open_source(NULL, NULL, &decoder) == bad);
    bytes = bytes_of(&b, file_bytes);
    CHECK(tessera_open_source(&bytes, NULL, NULL) == bad && b.closed == 1);
    bytes.read = NULL;
    CHECK(tessera_open_source(&bytes, NULL, &decoder) == bad && b.closed == 2);
    CHECK(tessera_open_memory(file, file_bytes, NULL, &decoder) == 0);
    CHECK(tessera_get_texture(NULL, &texture) == bad);
    CHECK(tessera_get_texture(decoder, NULL) == bad);
    tessera_description_init(&description);
    CHECK(tessera_get_description(NULL, &description) == bad);
    CHECK(tessera_get_description(decoder, NULL) == bad);
    CHECK(tessera_level_count(NULL) == 0);
    tessera_level_init(&level);
    CHECK(tessera_get_level(NULL, 0, &level) == bad);
    CHECK(tessera_get_level(decoder, 0, NULL) == bad);
    tessera_file_state_init(&state);
    CHECK(tessera_get_file_state(NULL, &state) == bad);
    CHECK(tessera_get_file_state(decoder, NULL) == bad);
    CHECK(tessera_metadata_count(NULL) == 0);
    CHECK(tessera_metadata_at(NULL, 0, &key, &value, NULL) == bad);
    CHECK(tessera_metadata_at(decoder, 0, NULL, &value, NULL) == bad);
    CHECK(tessera_metadata_at(decoder, 0, &key, NULL, NULL) == bad);
    CHECK(tessera_metadata_value(NULL, "x") == NULL);
    CHECK(tessera_metadata_value(decoder, NULL) == NULL);
    CHECK(tessera_box_bytes(NULL, origin, small_end, &size) == bad);
    CHECK(tessera_box_bytes(&small_texture, NULL, small_end, &size) == bad);
    CHECK(tessera_box_bytes(&small_texture, origin, NULL, &size) == bad);
    CHECK(tessera_box_bytes(&small_texture, origin, small_end, NULL) == bad);
    CHECK(tessera_decode_box(NULL, origin, small_end, texels, sizeof texels, NULL) == bad);
    CHECK(tessera_decode_box(decoder, NULL, small_end, texels, sizeof texels, NULL) == bad);
    CHECK(tessera_decode_box(decoder, origin, NULL, texels, sizeof texels, NULL) == bad);
    REFUSED(tessera_decode_box(decoder, origin, small_end, NULL, sizeof texels, NULL), bad,
            "null pointer");
    CHECK(tessera_open_memory(small_texels, small_bytes, NULL, &other) == TESSERA_INVALID_FILE);
    tessera_close(decoder);
    tessera_free(file);
    return 0;
}

/* A refused call changes nothing. Decoders of the same file are independent. */
static int test_wrong_order(void) {
    const tessera_encode_options options = lossless();
    reader r = {0};
    const tessera_texel_source source = source_of(&r);
    tessera_decoder *one = NULL, *other = NULL;
    unsigned char texels[small_bytes];
    void* file = NULL;
    size_t file_bytes = 0;
    tessera_set_callback_error("said by nobody"); /* outside of a callback */
    r.fail_at = 1;
    r.code = own_error;
    CHECK(tessera_encode_to_memory(&source, &file, &file_bytes, &options, NULL) == own_error);
    CHECK(strstr(tessera_last_error(), "said by nobody") == NULL);
    tessera_free(file);
    r.fail_at = 0;
    CHECK(tessera_encode_to_memory(&source, &file, &file_bytes, &options, NULL) == 0);
    CHECK(tessera_open_memory(file, file_bytes, NULL, &one) == 0);
    CHECK(tessera_open_memory(file, file_bytes, NULL, &other) == 0);
    REFUSED(tessera_decode_box(one, small_end, origin, texels, sizeof texels, NULL),
            TESSERA_BAD_ARGUMENT, "box");
    CHECK(is_small_texture(one));
    tessera_close(one);
    CHECK(is_small_texture(other));
    tessera_close(other);
    tessera_free(file);
    return 0;
}

int main(int argc, char** argv) {
    const char* path = argc > 1 ? argv[1] : "c_api_test.tess";
    CHECK(strcmp(tessera_last_error(), "") == 0);
    make_small_texels();
    remove(path);
    if (test_versions_and_names() || test_path(path) || test_memory_and_functions(path))
        return 1;
    CHECK(remove(path) == 0);
    if (test_failing_functions(path) || test_stopping(path))
        return 1;
    CHECK(remove(path) == 0);
    return test_levels_parts_and_damage() || test_metadata_and_description() ||
           test_masks_and_halves() || test_strides() || test_targets_beyond_every_quantiser() ||
           test_options_out_of_range() || test_box_bytes() || test_structures_that_grow() ||
           test_null_pointers() || test_wrong_order();
}
