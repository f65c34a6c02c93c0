#include "codec/decoder.h"
#include "codec/encoder.h"
#include "format/texture.h"
#include "codec/tessera.h"

#include <algorithm>
#include <exception>
#include <string>

using namespace tessera;

struct tessera_decoder {
    std::unique_ptr<ByteSource> bytes;
    Decoder decoder;
};

namespace {

thread_local std::string last_error;

int report(const Status& status) {
    if (!status.ok())
        last_error = status.message();
    return static_cast<int>(status.code());
}

// Runs `body`, a function that returns a Status, and lets no exception out.
template <class Body> int guarded(Body body) {
    try {
        return report(body());
    } catch (const std::exception& e) {
        return report({ErrorCode::runtime, e.what()});
    }
}

Status missing() {
    return {ErrorCode::bad_argument, "a pointer is null"};
}

} // namespace

const char* tessera_last_error(void) {
    return last_error.c_str();
}

int tessera_encode_file(const tessera_texture* texture, const void* texels, size_t texel_bytes,
                        const char* path, tessera_rate rate, double rate_value, int effort,
                        unsigned threads) {
    return guarded([&]() -> Status {
        if (texture == nullptr || texels == nullptr || path == nullptr)
            return missing();
        if (texture->channels > 4 || texture->type > TESSERA_HALF16 || rate > TESSERA_MAX_ERROR)
            return {ErrorCode::bad_argument, "channels, sample type or rate out of range"};
        TextureDesc desc;
        std::copy_n(texture->size, 4, desc.size.begin());
        desc.channels = static_cast<std::uint8_t>(texture->channels);
        desc.type = static_cast<SampleType>(texture->type);
        TESSERA_TRY(check_desc(desc));
        MemorySource source(desc, {static_cast<const std::byte*>(texels), texel_bytes});
        EncodeOptions options;
        options.rate = {static_cast<RateTarget::Kind>(rate), rate_value};
        options.effort = effort;
        options.threads = threads;
        return encode_file(source, path, options).status();
    });
}

int tessera_open(const char* path, tessera_decoder** decoder) {
    return guarded([&]() -> Status {
        if (path == nullptr || decoder == nullptr)
            return missing();
        *decoder = nullptr;
        auto bytes = open_file(path);
        if (!bytes)
            return bytes.status();
        auto opened = Decoder::open(**bytes);
        if (!opened)
            return opened.status();
        *decoder = new tessera_decoder{std::move(*bytes), std::move(*opened)};
        return {};
    });
}

void tessera_close(tessera_decoder* decoder) {
    delete decoder;
}

int tessera_describe(const tessera_decoder* decoder, tessera_texture* texture) {
    return guarded([&]() -> Status {
        if (decoder == nullptr || texture == nullptr)
            return missing();
        const TextureDesc& desc = decoder->decoder.desc();
        std::copy_n(desc.size.begin(), 4, texture->size);
        texture->type = static_cast<tessera_sample_type>(desc.type);
        texture->channels = desc.channels;
        return {};
    });
}

int tessera_decode_box(const tessera_decoder* decoder, const uint32_t begin[4],
                       const uint32_t end[4], void* out, size_t out_bytes, unsigned threads) {
    return guarded([&]() -> Status {
        if (decoder == nullptr || begin == nullptr || end == nullptr || out == nullptr)
            return missing();
        Box4 box;
        std::copy_n(begin, 4, box.begin.begin());
        std::copy_n(end, 4, box.end.begin());
        return decoder->decoder.decode_box(box, {static_cast<std::byte*>(out), out_bytes}, threads);
    });
}
