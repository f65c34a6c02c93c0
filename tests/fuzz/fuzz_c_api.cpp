// A file through the C interface. The first bytes of the input choose the calls and their sizes,
// which may be wrong. The calls come in any order, even if the file could not be opened.
#include "codec/encoder.h"
#include "codec/tessera.h"
#include "tests/fuzz/container_mend.h"
#include "tests/support/memory_texture.h"

#include <cstring>

namespace tessera::fuzz::c_api {
namespace {

constexpr std::size_t calls = 8;

void call(unsigned which, tessera_decoder* decoder) {
    const std::uint32_t begin[4] = {which / 64, 0, which / 32 % 2, 0},
                        end[4] = {which % 9 + 1, 3, 2, which % 4 + which / 128};
    std::vector<std::byte> texels(4096);
    const std::uint32_t levels = tessera_level_count(decoder);
    switch (which % calls) {
    case 0:
        (void)tessera_decode_box(decoder, begin, end, texels.data(), which * 8, nullptr);
        return;
    case 1: {
        tessera_texture texture;
        size_t bytes = 0;
        if (tessera_get_texture(decoder, &texture) != TESSERA_OK ||
            tessera_box_bytes(&texture, begin, end, &bytes) != TESSERA_OK || bytes > texels.size())
            return;
        const int error = tessera_decode_box(decoder, begin, end, texels.data(), bytes, nullptr);
        require(error == TESSERA_OK || *tessera_last_error() != 0, "an error without a message");
        return;
    }
    case 2: {
        tessera_description description;
        tessera_description_init(&description);
        (void)tessera_get_description(decoder, &description);
        return;
    }
    case 3: {
        const char *key = nullptr, *value = nullptr;
        for (std::size_t i = 0; i <= tessera_metadata_count(decoder) && i < 100; ++i)
            if (tessera_metadata_at(decoder, i, &key, &value, nullptr) == TESSERA_OK)
                require(std::strcmp(tessera_metadata_value(decoder, key), value) == 0,
                        "a key whose value depends on the function");
        return;
    }
    case 4: {
        tessera_level level;
        tessera_level_init(&level);
        (void)tessera_get_level(decoder, which % (levels + 2), &level);
        return;
    }
    case 5: {
        tessera_file_state state;
        tessera_file_state_init(&state);
        (void)tessera_get_file_state(decoder, &state);
        return;
    }
    case 6: {
        const void* bytes = nullptr;
        std::size_t count = 0;
        (void)tessera_get_mesh(decoder, &bytes, &count);
        return;
    }
    default:
        (void)tessera_decode_box(decoder, nullptr, end, nullptr, 0, nullptr);
    }
}

} // namespace

void mend(Bytes& input) {
    if (input.size() < calls)
        return;
    Bytes file(input.begin() + calls, input.end());
    mend_container(file);
    std::ranges::copy(file, input.begin() + calls);
}

void alter(Bytes& input, unsigned random) {
    if (input.size() >= calls)
        align_views(std::span(input).subspan(calls), random);
}

std::vector<Bytes> seeds() {
    test::MemoryTexture texture =
        test::named_texture({{9, 6, 5, 4}, SampleType::unorm8, 3}, "smooth");
    EncodeOptions options;
    options.threads = 1;
    options.effort = 0;
    options.metadata = {{"Author", "someone"}};
    Bytes file;
    require(encode_memory(texture, file, options).ok(), "a seed does not encode");
    const auto with_calls = [](const std::string& which, const Bytes& opened) {
        Bytes input = bytes_of(which);
        append_bytes(input, opened);
        return input;
    };
    return {with_calls("\1\11\2\3\4\5\6\7", file),
            with_calls("\1\301\101\4\5\2\3\6", test::with_alignment(file, {1, -1}))};
}

void run(const std::uint8_t* data, std::size_t size) {
    if (size < calls)
        return;
    tessera_decoder* decoder = nullptr;
    const int error = tessera_open_memory(data + calls, size - calls, nullptr, &decoder);
    require((error == TESSERA_OK) == (decoder != nullptr), "the error contradicts the decoder");
    for (std::size_t i = 0; i < calls; ++i)
        call(data[i], decoder);
    tessera_close(decoder);
}

const Registered registered({.name = "fuzz_c_api",
                             .seeds = seeds,
                             .run = run,
                             .mend = mend,
                             .alter = alter,
                             .rounds = 400});

} // namespace tessera::fuzz::c_api
