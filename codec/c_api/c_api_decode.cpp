// The part of the C interface that needs no encoder: errors, versions, decoding.
#include "codec/c_api/c_api_support.h"

#include "codec/decoder.h"
#include "format/metadata.h"

#include <cstdlib>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

using namespace tessera;
using namespace tessera::c_api;

struct tessera_decoder {
    explicit tessera_decoder(Decoder opened) : decoder(std::move(opened)) {
        for (const auto& entry : decoder.container().metadata())
            metadata.push_back(&entry);
    }
    Decoder decoder;
    std::vector<const Metadata::value_type*> metadata; // in the order of tessera_metadata_at
};

namespace {

thread_local std::string last_error;
thread_local std::string callback_error; // set by a callback before it fails

class CallbackBytes : public ByteSource {
public:
    explicit CallbackBytes(const tessera_byte_source& source)
        : source_(source), name_(source.name != nullptr ? source.name : "<callback>"),
          turn_(source.one_at_a_time != 0) {}
    ~CallbackBytes() override {
        if (source_.close != nullptr)
            (void)status_of_callback("close", [this] {
                source_.close(source_.user);
                return 0;
            });
    }
    CallbackBytes(const CallbackBytes&) = delete;
    CallbackBytes& operator=(const CallbackBytes&) = delete;

    std::uint64_t size() const override { return source_.size; }
    std::string name() const override { return name_; }
    bool wants_prefetch() const override { return source_.slow != 0; }

    Status read(std::uint64_t offset, std::span<std::byte> out) override {
        TESSERA_TRY(check_range(*this, offset, out.size()));
        if (out.empty())
            return {};
        const auto turn = turn_.take();
        return status_of_callback(
                   "read",
                   [&] { return source_.read(source_.user, offset, out.data(), out.size()); })
            .with_context(name_);
    }

    Status read_many(std::span<const ReadRequest> requests) override {
        if (source_.read_many == nullptr)
            return ByteSource::read_many(requests);
        std::vector<tessera_byte_range> ranges;
        for (const ReadRequest& request : requests) {
            TESSERA_TRY(check_range(*this, request.offset, request.out.size()));
            if (!request.out.empty())
                ranges.push_back({request.offset, request.out.data(), request.out.size()});
        }
        if (ranges.empty())
            return {};
        const auto turn = turn_.take();
        return status_of_callback(
                   "read_many",
                   [&] { return source_.read_many(source_.user, ranges.data(), ranges.size()); })
            .with_context(name_);
    }

private:
    const tessera_byte_source source_;
    const std::string name_;
    TurnLock turn_;
};

Status open(std::unique_ptr<ByteSource> bytes, const tessera_open_options* options,
            tessera_decoder** decoder) {
    TESSERA_TRY_ASSIGN(const tessera_open_options wanted,
                       take_struct(options, {}, "tessera_open_options"));
    TESSERA_TRY_ASSIGN(Decoder opened, Decoder::open(std::move(bytes),
                                                     {.allow_partial = wanted.allow_partial != 0,
                                                      .allow_damaged = wanted.allow_damaged != 0}));
    *decoder = new tessera_decoder(std::move(opened));
    return {};
}

Box4 box_of(const uint32_t begin[4], const uint32_t end[4]) {
    Box4 box;
    std::copy_n(begin, 4, box.begin.begin());
    std::copy_n(end, 4, box.end.begin());
    return box;
}

Status decode_box(const Decoder& decoder, const Box4& box, std::span<std::byte> out,
                  const tessera_decode_options& options, Watch& watch) {
    TESSERA_TRY_ASSIGN(const Integrity integrity,
                       take_enum(options.integrity, Integrity::tile, "integrity"));
    const auto progress = watch.progress_function();
    const auto cancelled = watch.cancelled_function();
    if (options.level == 0) {
        TESSERA_TRY(decoder.decode_box(box, out,
                                       {.threads = options.threads,
                                        .integrity = integrity,
                                        .progress = progress,
                                        .cancelled = cancelled}));
    } else if (!cancelled || !cancelled()) {
        TESSERA_TRY(decoder.decode_coarse_box(options.level, box, out));
        if (progress)
            progress("decode", 1, 1);
    }
    // A request to stop during the last tile still counts.
    return watch.is_stopped() ? Status(ErrorCode::runtime, "interrupted") : Status();
}

constexpr tessera_decode_options default_decode_options = {.struct_size =
                                                               sizeof(tessera_decode_options),
                                                           .level = 0,
                                                           .threads = 0,
                                                           .integrity = TESSERA_CHECK_PAGES,
                                                           .reserved = 0,
                                                           .progress = nullptr,
                                                           .cancelled = nullptr,
                                                           .user = nullptr};

} // namespace

namespace tessera::c_api {

const Decoder& decoder_of(const tessera_decoder& handle) {
    return handle.decoder;
}

int report(const Status& status) noexcept {
    if (!status.ok()) {
        try {
            last_error = status.message();
        } catch (...) {
            last_error.clear();
        }
    }
    // tessera_error has no number for over_budget.
    return status.code() == ErrorCode::over_budget ? TESSERA_UNSUPPORTED
                                                   : static_cast<int>(status.code());
}

int report_out_of_memory() noexcept {
    last_error = "out of memory"; // short enough to need no allocation
    return TESSERA_RUNTIME;
}

void forget_callback_error() noexcept {
    callback_error.clear();
}

Status callback_failed(const char* which, int code) {
    std::string message = std::exchange(callback_error, {});
    if (message.empty())
        message = std::string("the function ") + which + " failed with code " +
                  std::to_string(code) + " (" + tessera_error_name(code) + ")";
    return {static_cast<ErrorCode>(code), std::move(message)};
}

std::function<void(const char*, double, double)> Watch::progress_function() {
    if (progress_ == nullptr)
        return {};
    return [this](const char* stage, double done, double total) {
        const Status status =
            status_of_callback("progress", [&] { return progress_(user_, stage, done, total); });
        if (!status.ok())
            stopped_ = true;
    };
}

std::function<bool()> Watch::cancelled_function() {
    if (progress_ == nullptr && cancelled_ == nullptr)
        return {};
    return [this] { return stopped_ || ask_cancelled(); };
}

bool Watch::ask_cancelled() {
    if (cancelled_ == nullptr)
        return false;
    if (!status_of_callback("cancelled", [&] { return cancelled_(user_); }).ok())
        stopped_ = true;
    return stopped_;
}

Status Watch::explain(const Status& status) const {
    return !status.ok() && is_stopped()
               ? Status(static_cast<ErrorCode>(TESSERA_CANCELLED), status.message())
               : status;
}

Result<TextureDesc> take_samples(const tessera_texture& texture) {
    TextureDesc desc;
    constexpr auto last = static_cast<SampleType>(sample_types.size() - 1);
    TESSERA_TRY_ASSIGN(desc.type, take_enum(texture.type, last, "the sample type"));
    if (texture.channels < 1 || texture.channels > 4)
        return bad("the number of channels is " + std::to_string(texture.channels) +
                   ", outside 1..4");
    desc.channels = static_cast<std::uint8_t>(texture.channels);
    return desc;
}

Result<TextureDesc> take_texture(const tessera_texture& texture) {
    TESSERA_TRY_ASSIGN(TextureDesc desc, take_samples(texture));
    std::copy_n(texture.size, 4, desc.size.begin());
    TESSERA_TRY(check_desc(desc));
    return desc;
}

} // namespace tessera::c_api

uint32_t tessera_api_version(void) {
    return TESSERA_API_VERSION;
}

const char* tessera_version(void) {
    return library_version;
}

void tessera_format_version(uint32_t* major, uint32_t* minor) {
    if (major != nullptr)
        *major = format_version_major;
    if (minor != nullptr)
        *minor = format_version_minor;
}

const char* tessera_error_name(int error) {
    switch (error) {
    case TESSERA_OK:
        return "ok";
    case TESSERA_BAD_ARGUMENT:
        return "bad_argument";
    case TESSERA_IO:
        return "io";
    case TESSERA_INVALID_FILE:
        return "invalid_file";
    case TESSERA_RUNTIME:
        return "runtime";
    case TESSERA_UNSUPPORTED:
        return "unsupported";
    case TESSERA_CANCELLED:
        return "cancelled";
    default:
        return "callback";
    }
}

const char* tessera_last_error(void) {
    return last_error.c_str();
}

void tessera_set_callback_error(const char* sentence) {
    try {
        callback_error = sentence != nullptr ? sentence : "";
    } catch (...) {
        callback_error.clear(); // the error code remains
    }
}

void tessera_free(void* memory) {
    std::free(memory);
}

int tessera_box_bytes(const tessera_texture* texture, const uint32_t begin[4],
                      const uint32_t end[4], uint64_t* bytes) {
    return guarded([&]() -> Status {
        if (texture == nullptr || begin == nullptr || end == nullptr || bytes == nullptr)
            return missing("texture, begin, end or bytes");
        TESSERA_TRY_ASSIGN(const TextureDesc desc, take_samples(*texture));
        const Box4 box = box_of(begin, end);
        std::uint64_t product = desc.texel_bytes();
        constexpr std::uint64_t most = std::numeric_limits<std::size_t>::max();
        for (std::size_t axis = 0; axis < 4; ++axis) {
            if (box.begin[axis] >= box.end[axis])
                return bad("box " + to_string(box) + " is empty");
            const std::uint64_t side = box.end[axis] - box.begin[axis];
            if (product > most / side)
                return {ErrorCode::unsupported,
                        "box " + to_string(box) + " has too many bytes for a size_t"};
            product *= side;
        }
        *bytes = product;
        return {};
    });
}

void tessera_description_init_sized(tessera_description* description, size_t struct_size) {
    init_struct(description, struct_size, {});
}

void tessera_open_options_init_sized(tessera_open_options* options, size_t struct_size) {
    init_struct(options, struct_size, {});
}

void tessera_byte_source_init_sized(tessera_byte_source* source, size_t struct_size) {
    init_struct(source, struct_size, {});
}

void tessera_level_init_sized(tessera_level* level, size_t struct_size) {
    init_struct(level, struct_size, {});
}

void tessera_file_state_init_sized(tessera_file_state* state, size_t struct_size) {
    init_struct(state, struct_size, {});
}

void tessera_decode_options_init_sized(tessera_decode_options* options, size_t struct_size) {
    init_struct(options, struct_size, default_decode_options);
}

int tessera_open_path(const char* path, const tessera_open_options* options,
                      tessera_decoder** decoder) {
    return guarded([&]() -> Status {
        if (decoder == nullptr)
            return missing("decoder");
        *decoder = nullptr;
        if (path == nullptr)
            return missing("path");
        TESSERA_TRY_ASSIGN(std::unique_ptr<ByteSource> bytes, open_file(path));
        return open(std::move(bytes), options, decoder);
    });
}

int tessera_open_memory(const void* file, size_t file_bytes, const tessera_open_options* options,
                        tessera_decoder** decoder) {
    return guarded([&]() -> Status {
        if (decoder == nullptr)
            return missing("decoder");
        *decoder = nullptr;
        if (file == nullptr)
            return missing("file");
        return open(wrap_memory({static_cast<const std::byte*>(file), file_bytes}), options,
                    decoder);
    });
}

int tessera_open_source(const tessera_byte_source* source, const tessera_open_options* options,
                        tessera_decoder** decoder) {
    return guarded([&]() -> Status {
        if (decoder != nullptr)
            *decoder = nullptr;
        if (source == nullptr)
            return missing("source");
        TESSERA_TRY_ASSIGN(const tessera_byte_source wanted,
                           take_struct(source, {}, "tessera_byte_source"));
        // Created first, so that any error from here on closes the source.
        auto bytes = std::make_unique<CallbackBytes>(wanted);
        if (wanted.read == nullptr)
            return missing("read of tessera_byte_source");
        if (decoder == nullptr)
            return missing("decoder");
        return open(std::move(bytes), options, decoder);
    });
}

void tessera_close(tessera_decoder* decoder) {
    delete decoder;
}

int tessera_get_texture(const tessera_decoder* decoder, tessera_texture* texture) {
    return guarded([&]() -> Status {
        if (decoder == nullptr || texture == nullptr)
            return missing("decoder or texture");
        const TextureDesc& desc = decoder->decoder.desc();
        std::copy_n(desc.size.begin(), 4, texture->size);
        texture->type = static_cast<int32_t>(desc.type);
        texture->channels = desc.channels;
        return {};
    });
}

int tessera_get_description(const tessera_decoder* decoder, tessera_description* description) {
    return guarded([&]() -> Status {
        if (decoder == nullptr)
            return missing("decoder");
        const Description& d = decoder->decoder.container().description();
        tessera_description found = {};
        found.proxy = static_cast<int32_t>(d.proxy);
        found.surface_map = static_cast<int32_t>(d.surface_map);
        found.angular_map = static_cast<int32_t>(d.angular_map);
        found.transfer = static_cast<int32_t>(d.transfer);
        found.primaries = static_cast<int32_t>(d.primaries);
        found.alpha = static_cast<int32_t>(d.alpha);
        std::copy_n(d.sphere_centre, 3, found.sphere_centre);
        found.sphere_radius = d.sphere_radius;
        std::copy_n(d.viewing_radius, 2, found.viewing_radius);
        return give_struct(description, found, "tessera_description");
    });
}

int tessera_get_mesh(const tessera_decoder* decoder, const void** bytes, size_t* count) {
    return guarded([&]() -> Status {
        if (decoder == nullptr || bytes == nullptr || count == nullptr)
            return missing("decoder, bytes or count");
        const std::span<const std::byte> mesh = decoder->decoder.container().proxy_mesh();
        *bytes = mesh.empty() ? nullptr : mesh.data();
        *count = mesh.size();
        return {};
    });
}

uint32_t tessera_level_count(const tessera_decoder* decoder) {
    return decoder == nullptr ? 0
                              : static_cast<uint32_t>(decoder->decoder.container().levels().size());
}

int tessera_get_level(const tessera_decoder* decoder, uint32_t number, tessera_level* level) {
    return guarded([&]() -> Status {
        if (decoder == nullptr)
            return missing("decoder");
        if (number >= tessera_level_count(decoder))
            return bad("level " + std::to_string(number) + " does not exist; there are " +
                       std::to_string(tessera_level_count(decoder)));
        const Level& l = decoder->decoder.container().levels()[number];
        tessera_level found = {};
        std::ranges::copy(l.size, found.size);
        found.spatial_lod = l.spatial_lod;
        found.angular_lod = l.angular_lod;
        std::ranges::copy(l.grid.tile_extent(), found.largest_tile);
        std::ranges::copy(l.grid.count(), found.tile_count);
        return give_struct(level, found, "tessera_level");
    });
}

int tessera_get_file_state(const tessera_decoder* decoder, tessera_file_state* state) {
    return guarded([&]() -> Status {
        if (decoder == nullptr)
            return missing("decoder");
        const ContainerReader& container = decoder->decoder.container();
        const FillReport fill = decoder->decoder.fill_report();
        tessera_file_state found = {};
        found.file_bytes = container.file_bytes();
        found.received_bytes = container.source_bytes();
        found.tiles = container.tile_count();
        found.missing_tiles = fill.missing_tiles;
        found.damaged_tiles = fill.damaged_tiles;
        found.filled_texels = fill.texels;
        found.is_partial = container.is_partial() ? 1 : 0;
        return give_struct(state, found, "tessera_file_state");
    });
}

size_t tessera_metadata_count(const tessera_decoder* decoder) {
    return decoder == nullptr ? 0 : decoder->metadata.size();
}

int tessera_metadata_at(const tessera_decoder* decoder, size_t index, const char** key,
                        const char** value, size_t* value_bytes) {
    return guarded([&]() -> Status {
        if (decoder == nullptr || key == nullptr || value == nullptr)
            return missing("decoder, key or value");
        if (index >= decoder->metadata.size())
            return bad("metadata entry " + std::to_string(index) + " does not exist; there are " +
                       std::to_string(decoder->metadata.size()));
        const auto& [name, text] = *decoder->metadata[index];
        *key = name.c_str();
        *value = text.c_str();
        if (value_bytes != nullptr)
            *value_bytes = text.size();
        return {};
    });
}

const char* tessera_metadata_value(const tessera_decoder* decoder, const char* key) {
    const char* value = nullptr;
    (void)guarded([&]() -> Status {
        if (decoder == nullptr || key == nullptr)
            return {};
        const Metadata& metadata = decoder->decoder.container().metadata();
        if (const auto entry = metadata.find(key); entry != metadata.end())
            value = entry->second.c_str();
        return {};
    });
    return value;
}

int tessera_decode_box(const tessera_decoder* decoder, const uint32_t begin[4],
                       const uint32_t end[4], void* out, size_t out_bytes,
                       const tessera_decode_options* options) {
    return guarded([&]() -> Status {
        if (decoder == nullptr || begin == nullptr || end == nullptr || out == nullptr)
            return missing("decoder, begin, end or out");
        TESSERA_TRY_ASSIGN(const tessera_decode_options wanted,
                           take_struct(options, default_decode_options, "tessera_decode_options"));
        if (wanted.reserved != 0)
            return bad("tessera_decode_options: reserved must be 0");
        Watch watch(wanted.progress, wanted.cancelled, wanted.user);
        return watch.explain(decode_box(decoder->decoder, box_of(begin, end),
                                        {static_cast<std::byte*>(out), out_bytes}, wanted, watch));
    });
}
