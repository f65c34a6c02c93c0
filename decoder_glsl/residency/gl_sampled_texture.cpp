#include "decoder_glsl/gl_sampled_texture.h"

#include "decoder_glsl/cache/cache_plan.h"
#include "decoder_glsl/gl/gl_device.h"
#include "decoder_glsl/residency/gl_residency.h"
#include "decoder_glsl/residency/gl_tile_decoder.h"
#include "decoder_glsl/shaders/shader_layout.h"
#include "format/tile/limits.h"

#include <algorithm>
#include <cstdio>

namespace tessera {

using namespace layout;

const char* name_of(Residency residency) {
    return residency == Residency::on_load ? "load" : "feedback";
}

std::string mebibytes(std::uint64_t bytes) {
    char text[40];
    std::snprintf(text, sizeof text, "%.1f MiB", static_cast<double>(bytes) / (1 << 20));
    return text;
}

PlainLayout plain_layout(const Extent4& size) {
    const auto fold = [](std::uint32_t images, std::uint32_t side, std::uint32_t& folds) {
        const std::uint32_t most = std::max(most_texture_side / side, 1u);
        folds = (images + most - 1) / most;
        return (images + folds - 1) / folds;
    };
    std::uint32_t folds_u = 1, folds_v = 1;
    PlainLayout p;
    p.plan.fold_u = fold(size[0], size[2], folds_u);
    p.plan.fold_v = fold(size[1], size[3], folds_v);
    p.plan.folds_u = folds_u;
    p.plan.stride_s = size[2];
    p.plan.stride_t = size[3];
    p.shape = {.width = p.plan.fold_u * size[2],
               .height = p.plan.fold_v * size[3],
               .layers = folds_u * folds_v};
    return p;
}

namespace {

// Layers have an atlas as well, but no proxy.
bool has_atlas(const ContainerReader& reader) {
    const Description& d = reader.description();
    return (d.proxy == Proxy::mesh || d.proxy == Proxy::none) &&
           d.surface_map == SurfaceMap::mesh_uv;
}

// Mips need the mesh of the file. Where it does not decode there are none, and an application can
// still draw the texture on a mesh of its own.
AtlasMips mips_of(const ContainerReader& reader, const SurfaceMesh* given) {
    if (given != nullptr)
        return {*given, reader.grid()};
    constexpr std::uint64_t most_bytes = 1ull << 30; // while it is decoded
    if (!has_atlas(reader))
        return {};
    const auto mesh = decode_mesh(reader.proxy_mesh(), most_bytes);
    return mesh.ok() ? AtlasMips(*mesh, reader.grid()) : AtlasMips();
}

TextureShape decoded_shape(const ContainerReader& reader) {
    return plain_layout(has_atlas(reader) ? AtlasMips::kept_size(reader.grid())
                                          : reader.desc().size)
        .shape;
}

// Appends the words of an axis for one mip, where 0 is the texture itself. In a slot its texels
// begin at `before`. Every tile begins at a whole texel of the mip.
void add_axis(const TileGrid& grid, std::size_t axis, unsigned mip, std::uint32_t before,
              std::vector<std::uint32_t>& words) {
    const std::uint64_t shorter = grid.size()[axis] / grid.count()[axis];
    static_assert(max_tile_side + max_tile_side / 2 <= tsr_axis_places);
    Extent4 tile{0, 0, 0, 0};
    for (; tile[axis] < grid.count()[axis]; ++tile[axis]) {
        const std::uint32_t extent = grid.box(tile).extent()[axis];
        const std::uint32_t longer = extent > shorter ? 1 : 0;
        for (std::uint32_t x = 0; x << mip < extent; ++x)
            words.push_back(tile[axis] | ((before + x) << tsr_axis_place_at) |
                            (longer << tsr_axis_longer_at) | (mip << tsr_axis_mip_at));
    }
}

// The charts of the texels of a mip. Most atlases have few enough for 16 bits, which halves what is
// often more memory than the texels take.
void pack_charts(std::span<const std::uint32_t> charts, bool halves,
                 std::vector<std::uint32_t>& words) {
    if (!halves) {
        words.insert(words.end(), charts.begin(), charts.end());
        return;
    }
    for (std::size_t i = 0; i < charts.size(); i += 2)
        words.push_back(charts[i] | (i + 1 < charts.size() ? charts[i + 1] << 16 : 0));
}

void add_mip_table(const AtlasMips& mips, std::vector<std::uint32_t>& words) {
    const std::size_t table = words.size();
    words.resize(table + (mips.count() + 1) * tsr_mip_words);
    // Level 0 has all charts.
    const bool halves = std::ranges::max(mips.charts(0)) <= 0xFFFF;
    std::array<std::uint32_t, 2> begin{0, 0}; // on the axes
    for (unsigned mip = 0; mip <= mips.count(); ++mip) {
        const auto size = mips.size(mip);
        std::uint32_t* line = words.data() + table + mip * tsr_mip_words;
        line[tsr_mip_u] = begin[0];
        line[tsr_mip_v] = begin[1];
        line[tsr_mip_size] = size[0] | (size[1] << 16);
        line[tsr_mip_charts] = static_cast<std::uint32_t>(words.size());
        line[tsr_mip_halves] = halves;
        pack_charts(mips.charts(mip), halves, words);
        for (std::size_t a = 0; a < 2; ++a)
            begin[a] += size[a];
    }
}

} // namespace

std::uint64_t decoded_bytes(const ContainerReader& reader) {
    const TextureShape shape = decoded_shape(reader);
    return std::uint64_t{shape.width} * shape.height * shape.layers *
           (4 * sample_bytes(reader.desc().type));
}

Residency choose_residency(const ContainerReader& reader, std::uint64_t budget) {
    const TextureShape shape = decoded_shape(reader);
    const bool fits = shape.width <= most_texture_side && shape.height <= most_texture_side &&
                      shape.layers <= most_texture_side;
    // A quarter of the budget is reserved for decoding.
    return fits && decoded_bytes(reader) <= budget - budget / 4 ? Residency::on_load
                                                                : Residency::on_feedback;
}

std::vector<std::uint32_t> sampler_words(const TextureFile& file) {
    const TileGrid& grid = file.reader.grid();
    const AtlasMips& mips = file.mips;
    const CacheSlot slot = cache_slot(grid, mips.count() > 0);
    std::vector<std::uint32_t> words(tsr_sampler_words, 0);
    for (std::size_t axis = 0; axis < 4; ++axis) {
        words[tsr_p_size + axis] = grid.size()[axis];
        words[tsr_p_tiles + axis] = grid.count()[axis];
    }
    for (const std::size_t axis : {axis_u, axis_v}) { // all mips, one after the other
        words[tsr_p_axis_at + axis] = static_cast<std::uint32_t>(words.size());
        add_axis(grid, axis, 0, 0, words);
        for (unsigned mip = 1; mip <= mips.count(); ++mip)
            add_axis(grid, axis, mip, axis == axis_u ? slot.u : slot.v - (slot.v >> (mip - 1)),
                     words);
    }
    words[tsr_p_slot_u] = slot.u;
    words[tsr_p_slot_v] = slot.v;
    words[tsr_p_angular_map] = static_cast<std::uint32_t>(file.reader.description().angular_map);
    words[tsr_p_inside] = file.reader.description().proxy == Proxy::sphere_inside;
    words[tsr_p_half] = file.half;
    words[tsr_p_background] = file.tables.words()[tsr_t_background_texel];
    words[tsr_p_background + 1] = file.tables.words()[tsr_t_background_texel + 1];
    words[tsr_p_mips] = mips.count();
    words[tsr_p_mip_at] = static_cast<std::uint32_t>(words.size());
    if (mips.count() > 0)
        add_mip_table(mips, words);
    return words;
}

BatchLimits limits_within(std::uint64_t bytes, bool keeps_values) {
    constexpr std::uint64_t block = 128ull << 20; // every device has storage buffers of this size
    const std::uint64_t values = keeps_values ? bytes / 2 : 0;
    bytes -= values;
    BatchLimits limits;
    // A byte of payload can hold 8 levels, each of 8 bytes of work and 16 bytes of coefficients.
    // The payload itself and the records of tiles take much less.
    limits.words = std::min(bytes / 16, block) / 4;
    limits.coefficients = std::min(bytes / 16 * 9, block) / 16;
    limits.work_words = std::min(bytes / 16 * 6 + values, block) / 4;
    limits.tiles = 2048;
    return limits;
}

BatchFeed::BatchFeed(TextureFile& file, const TexelPlan& plan, const BatchLimits& limits,
                     Flush flush)
    : file_(file), limits_(limits), builder_(file.tables, file.reader.grid(), limits, plan),
      flush_(std::move(flush)) {}

Status BatchFeed::add(std::uint64_t tile, const TexelPlace& place) {
    TESSERA_TRY_ASSIGN(const auto bytes, file_.reader.load_tile(tile));
    if (builder_.add(tile, bytes.bytes, place))
        return {};
    TESSERA_TRY(finish());
    builder_.add(tile, bytes.bytes, place);
    return {};
}

Status BatchFeed::finish() {
    if (builder_.empty())
        return {};
    DecodeBatch batch = builder_.finish();
    const auto share = [](std::uint64_t needed, std::uint64_t limit) {
        return static_cast<double>(needed) / static_cast<double>(std::max<std::uint64_t>(limit, 1));
    };
    // Above 1 only if one tile alone exceeds the limits, because the builder adds no other beyond
    // them.
    const double most = std::max({share(batch.work_words, limits_.work_words),
                                  share(batch.coefficients, limits_.coefficients),
                                  share(batch.words.size(), limits_.words)});
    if (most > 1)
        return {ErrorCode::unsupported,
                file_.reader.name() + ": tile " + std::to_string(batch.tiles[0]) +
                    " alone needs more work memory than a budget of " + mebibytes(file_.budget) +
                    " leaves for decoding; " +
                    mebibytes(static_cast<std::uint64_t>(most * static_cast<double>(file_.budget)) +
                              (1u << 20)) +
                    " suffices"};
    return flush_(batch);
}

void bind_sampler(const GlBuffer& parameters, const GlTexture& texels, GLuint number) {
    parameters.bind_storage(sampler_binding + number);
    parameters.bind_uniforms(parameters_binding + number, tsr_sampler_words * 4);
    texels.bind_texture(texels_unit + number);
}

struct SampledTexture::State {
    SampledTextureOptions options;
    TextureFile file;
    std::unique_ptr<Resident> resident;
};

SampledTexture::SampledTexture(std::unique_ptr<State> state) : state_(std::move(state)) {}
SampledTexture::SampledTexture(SampledTexture&&) noexcept = default;
SampledTexture& SampledTexture::operator=(SampledTexture&&) noexcept = default;
SampledTexture::~SampledTexture() = default;

// Everything but the residency.
Result<std::unique_ptr<SampledTexture::State>>
SampledTexture::prepare(const ContainerReader& reader, const SampledTextureOptions& options) {
    TESSERA_TRY(check_device().with_context("this device cannot decode Tessera files"));
    if (reader.alignment().any())
        return Status{ErrorCode::unsupported,
                      reader.name() + ": holds camera views, not a texture of a sphere or a mesh"};
    // Tile numbers and the products of sizes and tile counts must fit the shaders' 32-bit numbers.
    const TileGrid& grid = reader.grid();
    bool fits = grid.tiles() < (1ull << 24);
    for (std::size_t axis = 0; axis < 4; ++axis)
        fits = fits && grid.size()[axis] <= 65536;
    // Shaders divide in floats, with an error of up to 2.5 units in the last of 24 bits
    // (tsr_angular_tiles).
    constexpr std::uint64_t most = (1u << 23) / 5;
    for (const std::size_t axis : {axis_s, axis_t})
        fits = fits && std::uint64_t{grid.size()[axis]} * grid.count()[axis] < most;
    if (!fits)
        return Status{
            ErrorCode::unsupported,
            reader.name() +
                ": larger than 65,536 along an axis, more than 16 million tiles, or more than "
                "1,200 tiles of one direction along s or t"};
    TESSERA_TRY_ASSIGN(auto tables, DecodeTables::make(reader));
    const bool half = traits_of(reader.desc().type).is_float;
    TESSERA_TRY_ASSIGN(auto decoder, GlTileDecoder::create(tables, half));
    AtlasMips mips = mips_of(reader, options.mesh);
    if (options.residency == Residency::on_feedback && !cache_slot(grid, mips.count() > 0).fits())
        mips = {}; // a slot with mips beside such long tiles is too large for a texture
    return std::unique_ptr<State>(new State{.options = options,
                                            .file = {.reader = reader,
                                                     .tables = std::move(tables),
                                                     .half = half,
                                                     .budget = options.budget,
                                                     .share = {},
                                                     .decoder = std::move(decoder),
                                                     .mips = std::move(mips)},
                                            .resident = nullptr});
}

Result<SampledTexture> SampledTexture::create(const ContainerReader& reader,
                                              const SampledTextureOptions& options) {
    const SampledTextureRequest file{&reader, options};
    TESSERA_TRY_ASSIGN(auto textures, create(std::span(&file, 1), options.budget));
    return std::move(textures.front());
}

Result<std::vector<SampledTexture>>
SampledTexture::create(std::span<const SampledTextureRequest> files, std::uint64_t budget) {
    const auto differs = [&](const SampledTextureRequest& file) {
        return file.options.residency != files[0].options.residency ||
               file.options.hardware_filter != files[0].options.hardware_filter;
    };
    constexpr std::size_t most_files = 64; // each has fewer than 2^24 tiles, so 32 bits number all
    if (files.empty() || files.size() > most_files || std::ranges::any_of(files, differs))
        return Status{ErrorCode::bad_argument,
                      "textures of one program are 1 to 64, of the same residency and filter"};
    return files[0].options.residency == Residency::on_load ? create_plain(files, budget)
                                                            : create_cached(files, budget);
}

Result<std::vector<SampledTexture>>
SampledTexture::create_plain(std::span<const SampledTextureRequest> files, std::uint64_t budget) {
    std::vector<SampledTexture> textures;
    for (const SampledTextureRequest& file : files) {
        SampledTextureOptions options = file.options;
        options.budget = budget;
        TESSERA_TRY_ASSIGN(std::unique_ptr<State> state, prepare(*file.reader, options));
        TESSERA_TRY_ASSIGN(state->resident,
                           make_plain_texture(state->file, options.hardware_filter));
        textures.push_back(SampledTexture(std::move(state)));
        budget -= std::min(budget, textures.back().bytes());
    }
    return textures;
}

Result<std::vector<SampledTexture>>
SampledTexture::create_cached(std::span<const SampledTextureRequest> files, std::uint64_t budget) {
    // The smallest texture needs slots, too.
    constexpr std::uint64_t least_weight = 1ull << 20;
    struct Part {
        std::unique_ptr<State> state;
        std::vector<std::uint32_t> words;
        double weight;
    };
    std::vector<Part> parts;
    std::uint64_t tiles = 0, fixed_of_all = 0;
    double weights = 0;
    for (const SampledTextureRequest& file : files) {
        TESSERA_TRY_ASSIGN(auto state, prepare(*file.reader, file.options));
        auto words = sampler_words(state->file);
        const auto weight = static_cast<double>(decoded_bytes(*file.reader) + least_weight);
        state->file.budget = budget;
        state->file.share.fixed =
            fixed_cache_bytes(state->file, words.size(), file.options.coarse) +
            least_cache_work(state->file);
        fixed_of_all += state->file.share.fixed;
        weights += weight;
        tiles += file.reader->grid().tiles();
        parts.push_back({std::move(state), std::move(words), weight});
    }
    TESSERA_TRY_ASSIGN(auto buffer, GlBuffer::create(tiles * 4, BufferUse::device, "marks"));
    const auto marks = std::make_shared<GlMarksBuffer>(
        std::move(buffer), sampler_binding + static_cast<GLuint>(files.size()));
    std::vector<SampledTexture> textures;
    std::uint64_t first_mark = 0;
    for (Part& part : parts) {
        State& state = *part.state;
        state.file.share.fixed_of_all = fixed_of_all;
        state.file.share.share = part.weight / weights;
        TESSERA_TRY_ASSIGN(state.resident,
                           make_cached_texture(state.file, state.options, std::move(part.words),
                                               marks, first_mark));
        first_mark += state.file.reader.grid().tiles();
        textures.push_back(SampledTexture(std::move(part.state)));
    }
    return textures;
}

Result<SampledTexture> SampledTexture::from_texels(const ContainerReader& reader,
                                                   TexelSource& source, bool hardware_filter) {
    if (source.desc() != reader.desc())
        return Status{ErrorCode::difference,
                      reader.name() + ": the texels to upload have another size or type"};
    SampledTextureOptions options;
    options.residency = Residency::on_load;
    options.hardware_filter = hardware_filter;
    TESSERA_TRY_ASSIGN(std::unique_ptr<State> state, prepare(reader, options));
    TESSERA_TRY_ASSIGN(state->resident,
                       make_uploaded_texture(state->file, source, hardware_filter));
    return SampledTexture(std::move(state));
}

std::vector<ShaderDefine> SampledTexture::defines() const {
    std::vector<ShaderDefine> defines;
    if (state_->options.residency == Residency::on_feedback)
        defines.emplace_back("TESSERA_RESIDENT_CACHE", "1");
    if (state_->options.hardware_filter)
        defines.emplace_back("TESSERA_HARDWARE_FILTER", "1");
    return defines;
}

void SampledTexture::bind(unsigned number) const {
    state_->resident->bind(number);
}
Result<UpdateReport> SampledTexture::update(bool wait) {
    return state_->resident->update(wait);
}
Status SampledTexture::drop_cache() {
    return state_->resident->drop_cache();
}
std::uint64_t SampledTexture::bytes() const {
    return state_->resident->bytes();
}
std::uint64_t SampledTexture::damaged_tiles() const {
    return state_->resident->damaged_tiles();
}
std::uint64_t SampledTexture::cache_slots() const {
    return state_->resident->slots();
}
std::uint64_t SampledTexture::budget_for(std::uint64_t tiles) const {
    const std::uint64_t part = state_->resident->budget_for(tiles);
    return part == 0 ? 0 : state_->file.share.budget_for(part);
}
void SampledTexture::set_stage_hook(StageHook hook) {
    state_->file.decoder.set_stage_hook(std::move(hook));
}

} // namespace tessera
