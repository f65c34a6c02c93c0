#include "tools/texture_io/mask_io.h"

#include "codec/encoder.h"
#include "format/samples.h"
#include "format/texture.h"
#include "tools/support/copy_texture.h"
#include "tools/support/interrupt.h"
#include "tools/support/parse.h"
#include "tools/support/standard_streams.h"
#include "tools/texture_io/texture_io.h"

#include <utility>
#include <vector>

namespace tessera {
namespace {

constexpr std::uint64_t largest_share = 2; // a half of slab_bytes

class LoadedMask : public TexelSource {
public:
    LoadedMask(const Extent4& size, std::vector<std::byte> values)
        : values_(std::move(values)), source_({size, SampleType::unorm8, 1}, values_) {}
    LoadedMask(const LoadedMask&) = delete;
    LoadedMask& operator=(const LoadedMask&) = delete;
    const TextureDesc& desc() const override { return source_.desc(); }
    Status read(const Box4& box, std::span<std::byte> out) override {
        return source_.read(box, out);
    }

private:
    const std::vector<std::byte> values_;
    MemorySource source_;
};

// Keeps a byte per texel of any texture: whether its first channel is not 0.
class MaskSink : public TexelSink {
public:
    explicit MaskSink(const TextureDesc& desc) : desc_(desc), values_(texel_count(desc.size)) {}
    Status write(const Box4& box, std::span<const std::byte> texels) override {
        std::vector<std::byte> matters(box.texels());
        for (std::size_t i = 0; i < matters.size(); ++i) {
            const auto first = load_sample(&texels[i * desc_.texel_bytes()], desc_.type);
            matters[i] = static_cast<std::byte>(sample_code(first, desc_.type) != 0);
        }
        copy_box(box, box, matters, Box4::whole(desc_.size), values_, 1);
        return {};
    }
    std::vector<std::byte> take() { return std::move(values_); }

private:
    const TextureDesc desc_;
    std::vector<std::byte> values_;
};

Result<std::unique_ptr<TexelSource>> load(TexelSource& source, unsigned threads,
                                          std::uint64_t& slab_bytes) {
    const TextureDesc& desc = source.desc();
    const std::uint64_t bytes = texel_count(desc.size), most = slab_bytes / largest_share;
    if (bytes > most)
        return Status(ErrorCode::over_budget, "the mask takes " + std::to_string(bytes) +
                                                  " bytes of memory, only " + std::to_string(most) +
                                                  " are allowed (a raw file, .gray, takes none)");
    slab_bytes -= bytes;
    MaskSink sink(desc);
    TESSERA_TRY(copy_texture(source, sink, threads, {}, "mask", slab_bytes));
    return std::unique_ptr<TexelSource>(std::make_unique<LoadedMask>(desc.size, sink.take()));
}

Result<TextureHints> mask_hints(const MaskArguments& arguments, const Extent4& texture_size,
                                unsigned threads) {
    TextureHints hints;
    hints.threads = threads;
    hints.size = texture_size;
    if (!arguments.size.empty()) {
        TESSERA_TRY_ASSIGN(hints.size, parse_extent(arguments.size).with_context("--mask-size"));
    }
    if (arguments.path.ends_with(".raw") ||
        arguments.path == standard_stream) { // other names imply type and channels
        hints.type = SampleType::unorm8;
        hints.channels = std::uint8_t{1};
    }
    return hints;
}

} // namespace

void add_mask_options(CLI::App& app, MaskArguments& a, const std::string& meaning) {
    auto* mask = app.add_option("--mask", a.path,
                                "Texture that is 0 in its first channel where texels are masked: "
                                ".gray, read in place, or any other kind, loaded whole; " +
                                    meaning);
    app.add_option(
           "--mask-size", a.size,
           "UxVxSxT of the mask (default: the texture's). Sides of 1 are broadcast: 512x256x1x1 "
           "masks surface positions, 1x1x32x32 directions")
        ->needs(mask);
}

Result<std::unique_ptr<TexelSource>> open_mask(const MaskArguments& arguments,
                                               const Extent4& texture_size, unsigned threads,
                                               std::uint64_t& slab_bytes) {
    if (arguments.path.empty())
        return std::unique_ptr<TexelSource>();
    TESSERA_TRY_ASSIGN(const auto hints, mask_hints(arguments, texture_size, threads));
    TESSERA_TRY_ASSIGN(auto opened, open_texture(arguments.path, hints).with_context("--mask"));
    std::unique_ptr<TexelSource> mask = interruptible(std::move(opened.source));
    const TextureDesc& desc = mask->desc();
    const bool in_place =
        opened.kind == TextureKind::raw && desc.channels == 1 && sample_bytes(desc.type) == 1;
    if (!in_place) {
        TESSERA_TRY_ASSIGN(
            mask, load(*mask, threads, slab_bytes).with_context("--mask " + arguments.path));
    }
    TESSERA_TRY(check_mask(mask.get(), texture_size).with_context(arguments.path));
    return mask;
}

} // namespace tessera
