#include "tests/support/shader_machine.h"

#define TSR_INOUT(type) type&
#define TSR_LOOP ++shader_machine_rounds
#define TSR_PREDICTED_TILES

namespace tessera::shaders {
namespace {

Buffer<uint> tsr_own, tsr_cross; // shared memory of levels.comp
Buffer<int> tsr_patch_memory;    // shared memory of texels.comp

uint TSR_ATOMIC_ADD(uint index, uint value) {
    const uint before = tsr_work[index];
    tsr_work[index] += value;
    return before;
}
void TSR_ATOMIC_OR(uint index, uint value) {
    tsr_work[index] |= value;
}

void tsr_write_texel(ivec3 at, uvec4 samples) {
    if (at.x < 0 || at.y < 0 || at.z < 0 || at.x >= image.width || at.y >= image.height ||
        at.z >= image.layers)
        ++image.outside;
    else
        image.at(at.x, at.y, at.z) = samples;
}

} // namespace

// The shaders' GLSL, included unchanged.
#include "decoder_glsl/shaders/border.comp.glsl"
#include "decoder_glsl/shaders/corrections.comp.glsl"
#include "decoder_glsl/shaders/filter.comp.glsl"
#include "decoder_glsl/shaders/groups.comp.glsl"
#include "decoder_glsl/shaders/items.comp.glsl"
#include "decoder_glsl/shaders/levels.comp.glsl"
#include "decoder_glsl/shaders/order.comp.glsl"
#include "decoder_glsl/shaders/texels.comp.glsl"
#include "decoder_glsl/shaders/tree.comp.glsl"

void Machine::decode_levels(const DecodeBatch& batch) {
    std::vector<uint> words = batch.words;
    words.resize(words.size() + guard, stale);
    tsr_batch.set(std::move(words));
    // Apart from the counters, the previous contents must not matter.
    tsr_work.assign(batch.work_words + guard, stale);
    tsr_work[tsr_w_items] = tsr_work[tsr_w_wave] = 0;
    tsr_coefficients.assign(batch.coefficients + guard, uvec4(stale));
    spent_ = 0;
    const auto tiles = static_cast<uint>(batch.tiles.size());
    for (uint tile = 0; tile < tiles; ++tile)
        invoke([&] { tsr_decode_tree(tile); });
    for (uint segment = 0; segment < batch.most_segments; ++segment)
        for (uint tile = 0; tile < tiles; ++tile) {
            if (tile % tsr_levels_group == 0) { // shared memory is uninitialised in a new group
                tsr_own.assign(tsr_levels_group * tsr_memory_words, 0x5A5A5A5Au);
                tsr_cross.assign(tsr_levels_group * tsr_memory_words, 0x5A5A5A5Au);
            }
            invoke([&] { tsr_decode_segment(tile, segment, tile % tsr_levels_group); });
        }
    for (uint i = 0; i < batch.corrections; ++i)
        invoke([&] { tsr_decode_corrections(i); });
    for (uint slot = 0; slot < batch.raw_chunks * 64; ++slot)
        invoke([&] { tsr_order_level(slot); });
}

void Machine::write_texels(const DecodeBatch& batch) {
    for (uint wave = 0; wave < batch.waves; ++wave) {
        write_wave(batch);
        if (wave == 0 && batch.borders)
            predict_borders(static_cast<uint>(batch.tiles.size()));
    }
    if (tsr_tables[tsr_t_filtered] != 0)
        for (uint tile = 0; tile < batch.tiles.size(); ++tile)
            for (uint texel = 0; texel < (batch.most_texels + 63) / 64 * 64; ++texel)
                invoke([&] { tsr_filter_texel(tile, texel); });
    most_waves = std::max(most_waves, batch.waves);
}

void Machine::write_wave(const DecodeBatch& batch) {
    for (uint tile = 0; tile < batch.tiles.size(); ++tile)
        for (uint lane = 0; lane < 64; ++lane)
            invoke([&] { tsr_cut_tile(tile, lane); });
    invoke([&] { tsr_size_dispatch(); });
    const uint groups = tsr_work[tsr_w_groups] * tsr_work[tsr_w_groups + 1];
    for (uint group = 0; group < groups && spent_ < patience; ++group) {
        spent_ += 64;
        tsr_patch_memory.assign(tsr_patch_words, 0x5A5A5A5A);
        const TsrItem item = tsr_item(group);
        std::array<std::uint64_t, 64> rounds{};
        const auto stage = [&](auto run_stage) {
            for (int lane = 0; lane < 64; ++lane) {
                shader_machine_rounds = 0;
                run_stage(lane);
                rounds[static_cast<std::size_t>(lane)] += shader_machine_rounds;
                spent_ += shader_machine_rounds;
            }
        };
        stage([&](int lane) { tsr_clear_patch(item, lane); });
        stage([&](int lane) { tsr_sum_u_v(item, lane); });
        stage([&](int lane) { tsr_sum_s(item, lane); });
        stage([&](int lane) { tsr_sum_t(item, lane); });
        most_rounds = std::max(most_rounds, *std::max_element(rounds.begin(), rounds.end()));
    }
}

void Machine::predict_borders(uint tiles) {
    for (uint tile = 0; tile < tiles && spent_ < patience; ++tile) {
        const TsrBorder border = tsr_border(tile);
        std::array<std::uint64_t, 64> rounds{};
        uint begin = 0;
        for (uint i = 0; i < border.steps && spent_ < patience; ++i) {
            ++spent_;
            const uint end = tsr_step_end(border, i, begin);
            for (int lane = 0; lane < 64; ++lane) {
                shader_machine_rounds = 1;
                tsr_predict_step(tile, border, begin, end, lane);
                rounds[static_cast<std::size_t>(lane)] += shader_machine_rounds;
                spent_ += shader_machine_rounds;
            }
            begin = end;
        }
        for (int lane = 0; lane < 64 && border.joins; ++lane) {
            shader_machine_rounds = 1;
            tsr_join_planes(tile, lane);
            rounds[static_cast<std::size_t>(lane)] += shader_machine_rounds;
            spent_ += shader_machine_rounds;
        }
        most_steps = std::max(most_steps, border.steps);
        most_rounds = std::max(most_rounds, *std::max_element(rounds.begin(), rounds.end()));
    }
}

} // namespace tessera::shaders
