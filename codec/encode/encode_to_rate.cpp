#include "codec/encode/encode_to_rate.h"

#include "codec/decoder.h"
#include "codec/encode/encode_facts.h"
#include "codec/encode/file_contents.h"
#include "codec/pass/tile_reuse.h"
#include "codec/texels/aligned_texels.h"
#include "codec/texels/texel_mask.h"
#include "codec/trials/alignment_choice.h"
#include "codec/trials/background.h"
#include "codec/trials/tile_choice.h"
#include "format/container/syntax.h"

#include <utility>

namespace tessera {
namespace {

// Pictures of at most so many texels take little time, but atlases, which have masks, are one of
// many layers.
constexpr std::uint64_t most_texels_of_small_picture = std::uint64_t{1} << 19;

bool is_small_picture(const Extent4& size, const EncodeOptions& options) {
    return size[axis_s] == 1 && size[axis_t] == 1 && options.mask == nullptr &&
           texel_count(size) <= most_texels_of_small_picture;
}

EncodePlan plan_of(TexelSource& source, const EncodeOptions& options, const ToolSwitches& tools,
                   std::uint64_t texels_that_matter) {
    const TextureDesc desc = source.desc();
    const EffortSettings effort =
        EffortSettings::of(options.effort, tools, is_small_picture(desc.size, options));
    const bool is_colour = desc.channels >= 3 && effort.ycocg;
    return {.source = source,
            .options = options,
            .colour = {.desc = desc,
                       .transform = is_colour ? ColourTransform::ycocg_r : ColourTransform::none,
                       .corrections = options.rate.kind == RateTarget::Kind::max_error,
                       .stored = true},
            .effort = effort,
            .mask = options.mask,
            .texels_that_matter = texels_that_matter,
            .tools = tools,
            .views = AlignedViews(desc.size, {})};
}

// The plan without its grid of tiles, with views aligned if that pays.
Result<std::unique_ptr<TextureEncode>> plan_views(TexelSource& source, const EncodeOptions& options,
                                                  const ToolSwitches& tools) {
    const Extent4 size = source.desc().size;
    TESSERA_TRY_ASSIGN(const std::uint64_t matter,
                       count_texels_that_matter(options.mask, size, options.threads));
    const EncodePlan plain = plan_of(source, options, tools, matter);
    ViewMotion motion;
    if (options.reuse != nullptr) {
        motion.alignment = options.reuse->container().alignment();
    } else {
        TESSERA_TRY_ASSIGN(motion, motion_between_views(plain));
    }
    auto encode = std::make_unique<TextureEncode>(
        TextureEncode{.looks_transposed = motion.looks_transposed, .plan = plain});
    encode->plan.parallax = motion.parallax;
    if (!motion.alignment.any())
        return encode;
    TESSERA_TRY_ASSIGN(auto held, hold_slabs(source, options.threads, options.slab_bytes));
    TexelSource& any_order = held ? *held : source;
    if (options.reuse == nullptr) {
        TESSERA_TRY_ASSIGN(const bool pays, alignment_pays(plain, any_order, motion));
        if (!pays)
            return encode;
    }
    const AlignedViews views(size, motion.alignment);
    auto texels = texels_in_grid(any_order, views), mask = mask_of_grid(options.mask, views);
    EncodePlan aligned = plan_of(*texels, options, tools, matter);
    aligned.mask = mask.get();
    aligned.views = views;
    aligned.parallax = motion.parallax;
    return std::make_unique<TextureEncode>(
        TextureEncode{.held = std::move(held),
                      .texels = std::move(texels),
                      .mask = std::move(mask),
                      .looks_transposed = motion.looks_transposed,
                      .plan = aligned});
}

// The shape of the tiles, and the parameters of a file whose tiles are reused.
Result<CodingParameters> cut_into_tiles(EncodePlan& plan) {
    CodingParameters reused;
    if (plan.options.reuse != nullptr) {
        TESSERA_TRY_ASSIGN(reused, plan_reuse(*plan.options.reuse, plan));
    } else {
        TESSERA_TRY_ASSIGN(const Extent4 tile_extent, choose_tile_extent(plan));
        plan.grid = TileGrid(plan.colour.desc.size, tile_extent);
    }
    if (plan.grid.tiles() > max_tiles)
        return Status(ErrorCode::unsupported, "more than 2^32 - 1 tiles");
    return reused;
}

} // namespace

Status TextureEncode::make_levels(const PassResult& pass) {
    if (!plan.options.layers || levels_of == pass.number)
        return {};
    TESSERA_TRY_ASSIGN(levels, make_coarse_levels(plan, pass));
    levels_of = pass.number;
    return {};
}

Result<std::uint64_t> TextureEncode::file_bytes(const PassResult& pass) {
    TESSERA_TRY(make_levels(pass));
    return FileContents(plan, pass, levels).bytes();
}

Result<std::unique_ptr<TextureEncode>> encode_to_rate(TexelSource& source,
                                                      const EncodeOptions& options,
                                                      const ToolSwitches& tools, Journal* journal) {
    TESSERA_TRY_ASSIGN(std::unique_ptr<TextureEncode> encode, plan_views(source, options, tools));
    EncodePlan& plan = encode->plan;
    const bool resume = options.journal == JournalUse::resume;
    if (journal != nullptr && resume)
        TESSERA_TRY(journal->may_resume(facts_of(plan)));
    TESSERA_TRY_ASSIGN(const CodingParameters reused, cut_into_tiles(plan));
    TESSERA_TRY_ASSIGN(const Sample sample, read_sample(plan));
    if (options.reuse == nullptr)
        plan.colour.background = find_background(sample, plan.colour.desc);
    if (journal != nullptr) {
        TESSERA_TRY(journal->begin(facts_of(plan, sample), resume));
        plan.journal = journal;
    }
    if (options.reuse != nullptr) {
        TESSERA_TRY_ASSIGN(encode->outcome.pass, run_pass(plan, reused, 1, "encode"));
        encode->outcome.passes = 1;
        return encode;
    }
    TESSERA_TRY_ASSIGN(encode->outcome, control_rate(plan, sample, [&](const PassResult& pass) {
                           return encode->file_bytes(pass);
                       }));
    return encode;
}

} // namespace tessera
