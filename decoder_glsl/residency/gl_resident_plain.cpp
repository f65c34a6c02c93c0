// On load: a plain texture of all decoded tiles, or of texels that the caller has.
#include "decoder_glsl/batch/plain_pixels.h"
#include "decoder_glsl/gl/gl_error.h"
#include "decoder_glsl/residency/gl_mips.h"
#include "decoder_glsl/residency/gl_residency.h"
#include "decoder_glsl/shaders/shader_layout.h"
#include "format/container/tiles_ahead.h"

namespace tessera {
namespace {

using namespace layout;

class PlainTexture final : public Resident {
public:
    void bind(GLuint number) const override { bind_sampler(parameters_, texels_, number); }
    std::uint64_t bytes() const override { return texels_.bytes() + parameters_.bytes(); }
    std::uint64_t damaged_tiles() const override { return damaged_; }

    Status load(TextureFile& file, bool hardware_filter) {
        const PlainLayout plain = layout_of(file);
        const std::uint64_t needed = std::uint64_t{plain.shape.width} * plain.shape.height *
                                     plain.shape.layers * texel_bytes(file.format());
        constexpr std::uint64_t least_work = 4ull << 20;
        if (needed + least_work > file.budget)
            return {ErrorCode::unsupported,
                    file.reader.name() + ": decoded as a whole it takes " + mebibytes(needed) +
                        " and some work memory, the budget is " + mebibytes(file.budget) +
                        "; use a tile cache (on feedback)"};
        TESSERA_TRY(create_objects(file, plain, hardware_filter));

        const std::uint64_t fixed = bytes() + file.decoder.bytes();
        const std::uint64_t left = file.budget > fixed ? file.budget - fixed : 0;
        BatchFeed feed(
            file, plain.plan,
            limits_within(std::min(left, std::uint64_t{256} << 20), file.tables.keeps_values()),
            [&](DecodeBatch& batch) { return decode(file, batch); });
        TESSERA_TRY(fill_background(file));
        const TileGrid& grid = file.reader.grid();
        TilesAhead ahead = all_tiles_ahead(file.reader);
        for (std::uint64_t tile = 0; tile < grid.tiles(); ++tile) {
            TESSERA_TRY(ahead.ready(tile));
            TESSERA_TRY_ASSIGN(const auto location, file.reader.locate(tile));
            if (location.length == 0)
                continue;
            const Box4 box = grid.box(tile);
            TESSERA_TRY(feed.add(
                tile,
                {.x = box.begin[2], .y = box.begin[3], .u0 = box.begin[0], .v0 = box.begin[1]}));
        }
        TESSERA_TRY(feed.finish());
        return compute_mips(file);
    }

    // Goes layer by layer, so that the host holds the texels of one layer at a time.
    Status upload(const TextureFile& file, TexelSource& source, bool hardware_filter) {
        const Extent4& size = file.reader.desc().size;
        const PlainLayout plain = layout_of(file);
        TESSERA_TRY(create_objects(file, plain, hardware_filter));
        std::vector<std::byte> texels, pixels(texels_.layer_bytes());
        for (std::uint32_t layer = 0; layer < plain.shape.layers; ++layer) {
            const Box4 box = box_of_layer(plain.plan, size, layer);
            if (box.begin[0] >= box.end[0] || box.begin[1] >= box.end[1])
                continue; // this layer holds mips only
            texels.resize(source.desc().box_bytes(box));
            TESSERA_TRY(source.begin_slab(box));
            TESSERA_TRY(source.read(box, texels));
            put_pixels(source.desc(), box, texels, plain.shape.width, pixels);
            TESSERA_TRY(texels_.upload(layer, pixels));
        }
        TESSERA_TRY(compute_mips(file));
        return take_gl_errors("uploading texels");
    }

private:
    static PlainLayout layout_of(const TextureFile& file) {
        return plain_layout(file.mips.count() > 0 ? file.mips.kept_size()
                                                  : file.reader.desc().size);
    }

    Status compute_mips(const TextureFile& file) {
        if (file.mips.count() == 0)
            return {};
        TESSERA_TRY_ASSIGN(GlMips mips, GlMips::create(file, false));
        const TileGrid& grid = file.reader.grid();
        for (std::uint64_t tile = 0; tile < grid.tiles(); ++tile) {
            const Box4 box = grid.box(tile);
            const Extent4 extent = box.extent();
            mips.add(0, box, {box.begin[2], box.begin[3]}, {extent[2], extent[3]});
        }
        return mips.compute(texels_, parameters_);
    }

    Status create_objects(const TextureFile& file, const PlainLayout& plain, bool hardware_filter) {
        TESSERA_TRY_ASSIGN(texels_, GlTexture::create(file.format(), plain.shape, "texels"));
        TESSERA_TRY(texels_.interpolate(hardware_filter));
        return put_parameters(file, plain);
    }

    // Often half the tiles are background. They are filled here and need no decoding.
    Status fill_background(const TextureFile& file) {
        const auto texel = std::as_bytes(file.tables.words().subspan(tsr_t_background_texel, 2));
        return texels_.clear(texel.first(texel_bytes(file.format())));
    }

    Status decode(TextureFile& file, const DecodeBatch& batch) {
        TESSERA_TRY(file.decoder.decode(file.tables, batch, texels_));
        TESSERA_TRY_ASSIGN(const auto counts, file.decoder.counts(batch));
        damaged_ += batch.damaged.size();
        for (const TileCounts& tile : counts)
            damaged_ += tile.damaged != 0;
        return {};
    }

    Status put_parameters(const TextureFile& file, const PlainLayout& plain) {
        auto words = sampler_words(file);
        const auto fold_axis = [&](std::size_t axis, std::uint32_t fold, std::uint32_t stride) {
            std::uint32_t word = words[tsr_p_axis_at + axis];
            const auto add = [&](std::uint32_t texel) {
                words[word++] = texel % fold * stride | (texel / fold << 16);
            };
            for (std::uint32_t i = 0; i < words[tsr_p_size + axis]; ++i)
                add(i);
            for (unsigned mip = 1; mip <= file.mips.count(); ++mip)
                for (std::uint32_t i = 0; i < file.mips.size(mip)[axis]; ++i)
                    add(file.mips.begin(mip)[axis] + i);
        };
        fold_axis(0, plain.plan.fold_u, plain.plan.stride_s);
        fold_axis(1, plain.plan.fold_v, plain.plan.stride_t);
        words[tsr_p_folds_u] = plain.plan.folds_u;
        words[tsr_p_width] = plain.shape.width;
        words[tsr_p_height] = plain.shape.height;
        TESSERA_TRY_ASSIGN(parameters_,
                           GlBuffer::create(std::as_bytes(std::span(words)), "sampler parameters"));
        return {};
    }

    GlTexture texels_;
    GlBuffer parameters_;
    std::uint64_t damaged_ = 0;
};

} // namespace

Result<std::unique_ptr<Resident>> make_plain_texture(TextureFile& file, bool hardware_filter) {
    auto texture = std::make_unique<PlainTexture>();
    TESSERA_TRY(texture->load(file, hardware_filter));
    file.decoder.free_work();
    return std::unique_ptr<Resident>(std::move(texture));
}

Result<std::unique_ptr<Resident>> make_uploaded_texture(const TextureFile& file,
                                                        TexelSource& source, bool hardware_filter) {
    auto texture = std::make_unique<PlainTexture>();
    TESSERA_TRY(texture->upload(file, source, hardware_filter));
    return std::unique_ptr<Resident>(std::move(texture));
}

} // namespace tessera
