// The part of the C interface that needs the encoder.
#include "codec/c_api/c_api_support.h"

#include "codec/encoder.h"
#include "format/texture.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <utility>

using namespace tessera;
using namespace tessera::c_api;

namespace {

class CallbackTexels : public TexelSource {
public:
    CallbackTexels(const TextureDesc& desc, const tessera_texel_source& source)
        : desc_(desc), source_(source), turn_(source.one_at_a_time != 0) {}
    const TextureDesc& desc() const override { return desc_; }
    bool cheap_to_reread() const override { return source_.slow == 0; }
    Status read(const Box4& box, std::span<std::byte> out) override {
        const auto turn = turn_.take();
        return status_of_callback("read", [&] {
            return source_.read(source_.user, box.begin.data(), box.end.data(), out.data(),
                                out.size());
        });
    }

private:
    const TextureDesc desc_;
    const tessera_texel_source source_;
    TurnLock turn_;
};

// Copies `count` elements that are `stride` bytes apart.
using Gather = void (*)(const std::byte* from, std::int64_t stride, std::size_t count,
                        std::byte* to);
template <std::size_t bytes>
void gather(const std::byte* from, std::int64_t stride, std::size_t count, std::byte* to) {
    for (std::size_t i = 0; i < count; ++i, from += stride, to += bytes)
        std::memcpy(to, from, bytes);
}

Gather gather_of(std::size_t element_bytes) {
    switch (element_bytes) {
    case 1:
        return gather<1>;
    case 2:
        return gather<2>;
    case 3:
        return gather<3>;
    case 4:
        return gather<4>;
    case 6:
        return gather<6>;
    default:
        return gather<8>;
    }
}

// Texels in memory whose axes are in any order.
class StridedTexels : public TexelSource {
public:
    StridedTexels(const TextureDesc& desc, const tessera_texel_source& source)
        : desc_(desc), texels_(static_cast<const std::byte*>(source.texels)),
          has_whole_texels_(desc.channels == 1 || source.strides[4] == sample_bytes(desc)),
          gather_(gather_of(has_whole_texels_ ? desc.texel_bytes()
                                              : static_cast<std::size_t>(sample_bytes(desc)))) {
        std::copy_n(source.strides, 5, strides_.begin());
    }
    const TextureDesc& desc() const override { return desc_; }
    Status read(const Box4& box, std::span<std::byte> out) override {
        const std::size_t along_s = box.end[2] - box.begin[2];
        std::byte* to = out.data();
        for (std::uint32_t v = box.begin[1]; v < box.end[1]; ++v)
            for (std::uint32_t u = box.begin[0]; u < box.end[0]; ++u)
                for (std::uint32_t t = box.begin[3]; t < box.end[3]; ++t) {
                    read_row(at(u, v, box.begin[2], t), along_s, to);
                    to += along_s * desc_.texel_bytes();
                }
        return {};
    }

private:
    static std::int64_t sample_bytes(const TextureDesc& desc) {
        return static_cast<std::int64_t>(desc.texel_bytes() / desc.channels);
    }
    const std::byte* at(std::uint32_t u, std::uint32_t v, std::uint32_t s, std::uint32_t t) const {
        return texels_ + u * strides_[0] + v * strides_[1] + s * strides_[2] + t * strides_[3];
    }
    void read_row(const std::byte* from, std::size_t count, std::byte* to) const {
        if (has_whole_texels_)
            return gather_(from, strides_[2], count, to);
        for (; count > 0; --count, from += strides_[2], to += desc_.texel_bytes())
            gather_(from, strides_[4], desc_.channels, to);
    }

    const TextureDesc desc_;
    const std::byte* const texels_;
    const bool has_whole_texels_; // whose channels are side by side
    const Gather gather_;
    std::array<std::int64_t, 5> strides_ = {};
};

Result<std::unique_ptr<TexelSource>> make_source(const tessera_texel_source& source) {
    TESSERA_TRY_ASSIGN(const TextureDesc desc, take_texture(source.texture));
    if ((source.texels == nullptr) == (source.read == nullptr))
        return bad("tessera_texel_source: set either texels or read");
    const bool has_strides =
        std::ranges::any_of(source.strides, [](std::int64_t stride) { return stride != 0; });
    if (source.read != nullptr && has_strides)
        return bad("tessera_texel_source: strides belong to texels, not to read");
    if (source.read != nullptr)
        return std::unique_ptr<TexelSource>(std::make_unique<CallbackTexels>(desc, source));
    if (has_strides)
        return std::unique_ptr<TexelSource>(std::make_unique<StridedTexels>(desc, source));
    const std::uint64_t needed = desc.box_bytes(Box4::whole(desc.size));
    if (source.texel_bytes != needed)
        return bad("texel_bytes is " + std::to_string(source.texel_bytes) + "; a texture of " +
                   to_string(desc.size) + " has " + std::to_string(needed) + " bytes");
    return std::unique_ptr<TexelSource>(std::make_unique<MemorySource>(
        desc, std::span(static_cast<const std::byte*>(source.texels), source.texel_bytes)));
}

Result<std::unique_ptr<TexelSource>> make_source(const tessera_texel_source* source,
                                                 const char* what) {
    if (source == nullptr)
        return missing(what);
    TESSERA_TRY_ASSIGN(const tessera_texel_source wanted,
                       take_struct(source, {}, "tessera_texel_source"));
    return make_source(wanted).with_context(what);
}

Result<Description> make_description(const tessera_description* given) {
    TESSERA_TRY_ASSIGN(const tessera_description d, take_struct(given, {}, "tessera_description"));
    Description description;
    TESSERA_TRY_ASSIGN(description.proxy, take_enum<Proxy>(d.proxy, "proxy"));
    TESSERA_TRY_ASSIGN(description.surface_map,
                       take_enum<SurfaceMap>(d.surface_map, "surface_map"));
    TESSERA_TRY_ASSIGN(description.angular_map,
                       take_enum<AngularMap>(d.angular_map, "angular_map"));
    TESSERA_TRY_ASSIGN(description.transfer, take_enum<Transfer>(d.transfer, "transfer"));
    TESSERA_TRY_ASSIGN(description.primaries, take_enum<Primaries>(d.primaries, "primaries"));
    TESSERA_TRY_ASSIGN(description.alpha, take_enum<AlphaMode>(d.alpha, "alpha"));
    std::copy_n(d.sphere_centre, 3, description.sphere_centre);
    description.sphere_radius = d.sphere_radius;
    std::copy_n(d.viewing_radius, 2, description.viewing_radius);
    return description;
}

// Calls take(key, value) for each entry. Errors: bad_argument for a null pointer; take's.
template <class Take>
Status for_each_entry(const tessera_key_value* entries, std::size_t count, const char* what,
                      const Take& take) {
    if (entries == nullptr && count > 0)
        return missing(what);
    for (std::size_t i = 0; i < count; ++i) {
        if (entries[i].key == nullptr || entries[i].value == nullptr)
            return missing(what).with_context("entry " + std::to_string(i));
        TESSERA_TRY(take(entries[i].key, entries[i].value));
    }
    return {};
}

tessera_encode_options default_options() {
    const EncodeOptions defaults;
    tessera_encode_options options = {};
    options.struct_size = sizeof options;
    options.rate_kind = static_cast<int32_t>(defaults.rate.kind);
    options.rate_value = defaults.rate.value;
    options.effort = defaults.effort;
    options.memory_bytes = defaults.slab_bytes;
    options.verify = defaults.verify ? 1 : 0;
    return options;
}

// The options of one call and the objects that they refer to.
class Call {
public:
    static Result<std::unique_ptr<Call>> make(const tessera_encode_options* given) {
        TESSERA_TRY_ASSIGN(const tessera_encode_options o,
                           take_struct(given, default_options(), "tessera_encode_options"));
        std::unique_ptr<Call> call(new Call(o));
        TESSERA_TRY(call->fill(o));
        return call;
    }

    const EncodeOptions& options() const { return options_; }
    Status explain(const Status& status) const { return watch_.explain(status); }

private:
    explicit Call(const tessera_encode_options& o) : watch_(o.progress, o.cancelled, o.user) {}

    Status fill(const tessera_encode_options& o) {
        TESSERA_TRY_ASSIGN(options_.rate.kind,
                           take_enum(o.rate_kind, RateTarget::Kind::max_error, "rate_kind"));
        options_.rate.value = o.rate_value;
        options_.effort = o.effort;
        options_.threads = o.threads;
        std::copy_n(o.tile, 4, options_.tile_extent.begin());
        options_.verify = o.verify != 0;
        options_.strict = o.strict != 0;
        options_.lossless_fallback = o.lossless_fallback != 0;
        options_.layers = o.layers != 0;
        options_.slab_bytes = o.memory_bytes;
        if (o.mask != nullptr) {
            TESSERA_TRY_ASSIGN(mask_, make_source(o.mask, "mask"));
            options_.mask = mask_.get();
        }
        TESSERA_TRY_ASSIGN(options_.description, make_description(o.description));
        TESSERA_TRY(for_each_entry(
            o.metadata, o.metadata_count, "metadata", [this](const char* key, const char* value) {
                return options_.metadata.emplace(key, value).second
                           ? Status()
                           : bad("metadata \"" + std::string(key) + "\" is given twice");
            }));
        if (o.mesh == nullptr && o.mesh_bytes > 0)
            return missing("mesh");
        const auto* const mesh = static_cast<const std::byte*>(o.mesh);
        options_.mesh.assign(mesh, mesh + o.mesh_bytes);
        options_.reuse = o.reuse != nullptr ? &decoder_of(*o.reuse) : nullptr;
        TESSERA_TRY_ASSIGN(options_.journal, take_enum(o.journal, JournalUse::resume, "journal"));
        TESSERA_TRY(for_each_entry(o.source_facts, o.source_fact_count, "source_facts",
                                   [this](const char* name, const char* value) {
                                       options_.labels.facts.emplace_back(name, value);
                                       return Status();
                                   }));
        options_.progress = watch_.progress_function();
        options_.cancelled = watch_.cancelled_function();
        return {};
    }

    Watch watch_;
    std::unique_ptr<TexelSource> mask_;
    EncodeOptions options_;
};

tessera_encode_report make_report(const EncodeReport& r, const TextureDesc& desc) {
    tessera_encode_report report = {};
    report.file_bytes = r.file_bytes;
    report.raw_bytes = r.raw_bytes;
    report.bits_per_texel = r.bits_per_texel;
    report.psnr = r.psnr;
    report.max_error = r.max_error;
    report.seconds = r.seconds;
    report.texels_that_matter = r.texels_that_matter.value_or(texel_count(desc.size));
    report.nan_count = r.nan_count;
    report.infinity_count = r.infinity_count;
    report.passes = r.passes;
    report.target_met = r.target_met ? 1 : 0;
    r.note.copy(report.note, sizeof report.note - 1);
    report.kept_tiles = r.kept_tiles.value_or(0);
    return report;
}

// Calls encode(texels, options), which is one of the encoder's functions, and writes the report.
template <class Encode>
Status run(const tessera_texel_source* source, const tessera_encode_options* options,
           tessera_encode_report* report, const Encode& encode) {
    TESSERA_TRY_ASSIGN(const std::unique_ptr<TexelSource> texels, make_source(source, "source"));
    TESSERA_TRY_ASSIGN(const std::unique_ptr<Call> call, Call::make(options));
    if (report != nullptr) // checked before the work starts
        TESSERA_TRY(check_struct_size(report->struct_size, "tessera_encode_report"));
    const Result<EncodeReport> reached = encode(*texels, call->options());
    if (!reached.ok())
        return call->explain(reached.status());
    return report == nullptr ? Status()
                             : give_struct(report, make_report(*reached, texels->desc()),
                                           "tessera_encode_report");
}

// A growing buffer of bytes that can be freed with free().
class Buffer {
public:
    Buffer() = default;
    ~Buffer() { std::free(bytes_); }
    Buffer(const Buffer&) = delete;
    Buffer& operator=(const Buffer&) = delete;

    Status append(std::span<const std::byte> piece) {
        if (piece.size() > room_ - size_) {
            const std::size_t room = std::max(size_ + piece.size(), 2 * room_);
            void* larger = std::realloc(bytes_, room);
            if (larger == nullptr)
                return {ErrorCode::runtime, "out of memory: the file has more than " +
                                                std::to_string(size_) + " bytes"};
            bytes_ = larger;
            room_ = room;
        }
        if (!piece.empty())
            std::memcpy(static_cast<std::byte*>(bytes_) + size_, piece.data(), piece.size());
        size_ += piece.size();
        return {};
    }
    std::size_t size() const { return size_; }
    void* release() { return std::exchange(bytes_, nullptr); }

private:
    void* bytes_ = nullptr;
    std::size_t size_ = 0, room_ = 0;
};

} // namespace

void tessera_texel_source_init_sized(tessera_texel_source* source, size_t struct_size) {
    init_struct(source, struct_size, {});
}

void tessera_encode_options_init_sized(tessera_encode_options* options, size_t struct_size) {
    init_struct(options, struct_size, default_options());
}

void tessera_encode_report_init_sized(tessera_encode_report* report, size_t struct_size) {
    init_struct(report, struct_size, {});
}

int tessera_check_options(const tessera_texture* texture, const tessera_encode_options* options) {
    return guarded([&]() -> Status {
        if (texture == nullptr)
            return missing("texture");
        TESSERA_TRY_ASSIGN(const TextureDesc desc, take_texture(*texture));
        TESSERA_TRY_ASSIGN(const std::unique_ptr<Call> call, Call::make(options));
        return check_options(desc, call->options());
    });
}

int tessera_encode_to_path(const tessera_texel_source* source, const char* path,
                           const tessera_encode_options* options, tessera_encode_report* report) {
    return guarded([&]() -> Status {
        if (path == nullptr)
            return missing("path");
        return run(source, options, report, [path](TexelSource& texels, const EncodeOptions& o) {
            return encode_file(texels, path, o);
        });
    });
}

int tessera_encode_to_memory(const tessera_texel_source* source, void** file, size_t* file_bytes,
                             const tessera_encode_options* options, tessera_encode_report* report) {
    return guarded([&]() -> Status {
        if (file == nullptr || file_bytes == nullptr)
            return missing("file or file_bytes");
        *file = nullptr;
        *file_bytes = 0;
        Buffer buffer;
        TESSERA_TRY(run(source, options, report, [&](TexelSource& texels, const EncodeOptions& o) {
            return encode_stream(
                texels,
                [&buffer](std::span<const std::byte> piece) { return buffer.append(piece); }, o);
        }));
        *file_bytes = buffer.size();
        *file = buffer.release();
        return {};
    });
}

int tessera_encode_to_function(const tessera_texel_source* source, tessera_write_function write,
                               void* user, const tessera_encode_options* options,
                               tessera_encode_report* report) {
    return guarded([&]() -> Status {
        if (write == nullptr)
            return missing("write");
        return run(source, options, report, [=](TexelSource& texels, const EncodeOptions& o) {
            return encode_stream(
                texels,
                [=](std::span<const std::byte> piece) {
                    return status_of_callback(
                        "write", [&] { return write(user, piece.data(), piece.size()); });
                },
                o);
        });
    });
}
