// Decodes arbitrary bytes as tile payloads with the shaders and with the CPU's TileDecoder, and
// checks that both agree.
#pragma once

#include "codec/reconstruct/tile_decoder.h"
#include "format/container/file_coding.h"
#include "tests/support/shader_machine.h"
#include "tests/support/vector_sink.h"

#include <functional>
#include <memory>
#include <set>
#include <span>
#include <string>
#include <vector>

namespace tessera::test {

// The most rounds that one invocation may take through its loops. FORMAT.md 3.1 limits the work of
// a segment for the sake of this bound.
constexpr std::uint64_t shader_round_limit = 24576;

// A file whose tiles are all background. Only its header and parameters matter here.
inline std::vector<std::byte> empty_file(const TextureDesc& desc, const Extent4& tile_extent,
                                         const CodingParameters& parameters, bool corrections) {
    const auto section = write_coding_parameters(parameters, desc.channels, corrections);
    ContainerContents contents;
    contents.desc = desc;
    contents.tile_extent = tile_extent;
    contents.colour = desc.channels >= 3 ? ColourTransform::ycocg_r : ColourTransform::none;
    for (std::size_t i = 0; i < desc.channels; ++i)
        contents.background[i] = static_cast<std::uint16_t>(9 + 50 * i);
    contents.required_features =
        (corrections ? feature_corrections : 0) | features_of(parameters) | feature_stored;
    contents.codec_parameters = section;
    contents.tile = [](std::uint64_t) { return std::span<const std::byte>(); };
    std::vector<std::byte> file;
    VectorSink sink(file);
    if (!write_container(contents, sink))
        file.clear();
    return file;
}

class ShaderOracle {
public:
    using Payload = std::vector<std::byte>;
    struct Layout {
        bool folded = false; // texture folded over layers, or tiles side by side with gaps
    };

    // Precondition: `file` is valid.
    explicit ShaderOracle(std::vector<std::byte> file)
        : file_(std::move(file)), source_(wrap_memory(file_)),
          reader_(std::move(*ContainerReader::open(*source_))),
          tables_(std::move(*DecodeTables::make(reader_))),
          coding_(*coding_of(reader_), reader_.desc().type, reader_.desc().channels),
          colour_{reader_.desc(), reader_.header().colour, reader_.header().background,
                  (reader_.header().required_features & feature_corrections) != 0,
                  (reader_.header().required_features & feature_stored) != 0},
          decoder_(coding_, colour_) {}
    ShaderOracle(const ShaderOracle&) = delete;
    ~ShaderOracle() {
        if (loaded_ == this)
            loaded_ = nullptr;
    }

    const ContainerReader& reader() const { return reader_; }
    const TileCoding& coding() const { return coding_; }
    BlockShape shape_of_tile(std::uint64_t tile) const {
        return tile_shape(reader_.grid().box(tile));
    }
    std::uint64_t most_rounds() const { return machine_.most_rounds; }
    std::uint32_t most_steps() const { return machine_.most_steps; }
    std::uint64_t accepted() const { return accepted_; } // number of tiles
    std::uint64_t refused() const { return refused_; }

    // Decodes payload i as tile i of the grid. Returns a description of the first difference, or ""
    // if there is none. The shaders must refuse exactly the payloads that the CPU refuses.
    std::string check(std::span<const Payload> payloads, const Layout& layout) {
        const DecodeBatch batch = make_batch(payloads, layout);
        load();
        machine_.run(batch);
        if (const std::string wrong = common_faults(); !wrong.empty())
            return wrong;
        if (shaders::image.outside != 0)
            return "texels outside the image";
        if (!Machine::guards_hold(batch))
            return "a buffer was written behind its end";
        const std::set<std::uint64_t> damaged(batch.damaged.begin(), batch.damaged.end());
        std::uint64_t texels = 0;
        for (std::uint32_t slot = 0; slot < payloads.size(); ++slot) {
            const std::string wrong =
                check_tile(slot, payloads[slot], damaged.contains(slot), layout);
            if (!wrong.empty())
                return "tile " + std::to_string(slot) + ": " + wrong;
            texels += static_cast<std::uint64_t>(shape_of_tile(slot).texels());
        }
        return painted_pixels() == texels ? "" : "texels between the tiles";
    }

    // The same for the first tile alone.
    std::string check_one(const Payload& payload) {
        return check(std::vector<Payload>{payload}, Layout());
    }

    // Like check(), but changes the batch's words first. The texels are then undefined, and texels
    // outside the image are dropped as on a GPU. The shaders must terminate and stay inside their
    // buffers, which throw otherwise.
    std::string check_changed(std::span<const Payload> payloads, const Layout& layout,
                              const std::function<void(std::span<std::uint32_t>)>& change,
                              std::uint64_t patience) {
        DecodeBatch batch = make_batch(payloads, layout);
        change(batch.words);
        load();
        machine_.patience = patience;
        machine_.run(batch);
        machine_.patience = ~std::uint64_t{0};
        return common_faults();
    }

private:
    using Machine = shaders::Machine;
    using Sample4 = std::array<std::uint32_t, 4>;

    void load() {
        const std::pair state{tables_.words().size(), tables_.generation()};
        if (loaded_ != this || loaded_state_ != state)
            machine_.load_tables(tables_.words());
        loaded_ = this;
        loaded_state_ = state;
    }

    std::string common_faults() const {
        if (machine_.most_rounds > shader_round_limit)
            return std::to_string(machine_.most_rounds) + " rounds in one invocation";
        return {};
    }

    TexelPlan plan(const Layout& layout) const {
        const Extent4& size = reader_.desc().size;
        if (layout.folded)
            return {5, 3, (size[0] + 4) / 5, size[2], size[3]};
        TexelPlan plan;
        plan.stride_s = reader_.grid().tile_extent()[2] + 1;
        plan.stride_t = reader_.grid().tile_extent()[3] + 1;
        return plan;
    }
    TexelPlace place(std::uint64_t tile, const Layout& layout) const {
        const Box4 box = reader_.grid().box(tile);
        if (layout.folded)
            return {box.begin[2], box.begin[3], 0, box.begin[0], box.begin[1]};
        const auto wide = reader_.grid().tile_extent()[0] * plan(layout).stride_s;
        return {static_cast<std::uint32_t>(tile) * wide, 0, 0, 0, 0};
    }

    DecodeBatch make_batch(std::span<const Payload> payloads, const Layout& layout) {
        const TexelPlan texel_plan = plan(layout);
        BatchBuilder builder(tables_, reader_.grid(), {}, texel_plan);
        for (std::uint64_t tile = 0; tile < payloads.size(); ++tile)
            builder.add(tile, payloads[tile], place(tile, layout));
        const Extent4& size = reader_.desc().size;
        const Extent4& extent = reader_.grid().tile_extent();
        if (layout.folded)
            shaders::image.resize(static_cast<int>(5 * size[2]), static_cast<int>(3 * size[3]),
                                  static_cast<int>(texel_plan.folds_u * ((size[1] + 2) / 3)));
        else
            shaders::image.resize(
                static_cast<int>(payloads.size() * extent[0] * texel_plan.stride_s),
                static_cast<int>(extent[1] * texel_plan.stride_t), 1);
        return builder.finish();
    }

    std::string check_tile(std::uint32_t slot, const Payload& payload, bool no_streams,
                           const Layout& layout) {
        const BlockShape shape = shape_of_tile(slot);
        std::vector<std::byte> texels(static_cast<std::size_t>(shape.texels()) *
                                      colour_.desc.texel_bytes());
        const bool sound = decoder_.decode(payload, shape, texels).ok();
        ++(sound ? accepted_ : refused_);
        const bool damage = Machine::damage(slot) != 0 || no_streams;
        if (sound && damage)
            return "the shaders refuse what the CPU accepts, damage " +
                   std::to_string(Machine::damage(slot));
        if (!sound && !damage)
            return "the shaders accept what the CPU refuses";
        // A damaged tile must be background.
        if (!sound && !decoder_.decode({}, shape, texels).ok())
            return "an empty payload is refused";
        if (!same_texels(slot, texels, layout))
            return "texels differ";
        return sound ? check_blocks(slot) : std::string();
    }

    // Order of `texels`: v, u, t, s.
    bool same_texels(std::uint32_t slot, std::span<const std::byte> texels,
                     const Layout& layout) const {
        const auto& n = shape_of_tile(slot).n;
        const TexelPlan p = plan(layout);
        const TexelPlace at = place(slot, layout);
        const std::byte* next = texels.data();
        for (std::uint32_t v = at.v0; v < at.v0 + n[1]; ++v)
            for (std::uint32_t u = at.u0; u < at.u0 + n[0]; ++u)
                for (std::uint32_t t = 0; t < n[3]; ++t)
                    for (std::uint32_t s = 0; s < n[2]; ++s, next += colour_.desc.texel_bytes()) {
                        const auto& got = shaders::image.at(
                            static_cast<int>(at.x + u % p.fold_u * p.stride_s + s),
                            static_cast<int>(at.y + v % p.fold_v * p.stride_t + t),
                            static_cast<int>(at.layer + u / p.fold_u + p.folds_u * (v / p.fold_v)));
                        if (Sample4{got.x, got.y, got.z, got.w} != stored(next))
                            return false;
                    }
        return true;
    }

    // The four stored channels of a texel.
    Sample4 stored(const std::byte* texel) const {
        const SampleType type = colour_.desc.type;
        const auto c = [&](std::size_t i) -> std::uint32_t {
            return load_sample(texel + i * sample_bytes(type), type);
        };
        const std::uint32_t one = type == SampleType::unorm8 ? 255 : 0x3C00;
        switch (colour_.desc.channels) {
        case 1:
            return {c(0), c(0), c(0), one};
        case 2:
            return {c(0), c(0), c(0), c(1)};
        case 3:
            return {c(0), c(1), c(2), one};
        default:
            return {c(0), c(1), c(2), c(3)};
        }
    }

    static std::uint64_t painted_pixels() {
        const auto& pixels = shaders::image.pixels;
        return static_cast<std::uint64_t>(std::count_if(
            pixels.begin(), pixels.end(), [](const auto& p) { return p.x != shaders::unpainted; }));
    }

    // Compares blocks and the numbers of nodes and levels with those of the CPU's decoder.
    std::string check_blocks(std::uint32_t slot) const {
        using namespace shaders;
        const TileLevels& levels = decoder_.levels();
        const uint state = tsr_state_at(slot);
        if (tsr_work[state + tsr_st_blocks] != levels.blocks.size() ||
            tsr_work[state + tsr_st_nodes] != levels.splits.size() ||
            tsr_work[state + tsr_st_levels] != levels.nonzeros.size())
            return "counts differ";
        for (uint i = 0; i < levels.blocks.size(); ++i) {
            const Block& block = levels.blocks[i];
            const uint at = tsr_block_at(slot, i);
            const ivec4 sides = tsr_sides_of(tsr_work[at + tsr_k_shape]);
            const ivec4 origin = tsr_origin_of(tsr_work[at + tsr_k_place]);
            for (int axis = 0; axis < 4; ++axis)
                if (origin[axis] != block.origin[axis] || sides[axis] != block.shape.n[axis])
                    return "block " + std::to_string(i) + " differs";
        }
        return {};
    }

    static inline const ShaderOracle* loaded_ = nullptr;          // the shaders' buffers are global
    static inline std::pair<std::size_t, unsigned> loaded_state_; // of its tables

    const std::vector<std::byte> file_;
    std::unique_ptr<ByteSource> source_;
    ContainerReader reader_;
    DecodeTables tables_;
    TileCoding coding_;
    ColourCoding colour_;
    TileDecoder decoder_;
    Machine machine_;
    std::uint64_t accepted_ = 0, refused_ = 0;
};

} // namespace tessera::test
