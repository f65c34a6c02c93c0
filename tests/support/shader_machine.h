// Runs the decoder's shaders as C++. GLM supplies the types; this file supplies the macros of
// shaders/dialect.glsl, the buffers (with guard bands) and the passes. Include it in only one
// source of a program.
//
// Every access to a buffer is checked: an index out of range throws, which no shader may cause,
// whatever the bytes. The words that a batch uses are followed by a guard band, as if the buffer
// had been allocated for a larger batch, so that writes beyond the batch are detected, too. Every
// loop iteration is counted, and the largest count of one invocation is kept.
#pragma once

#include "decoder_glsl/batch/decode_batch.h"

#include <algorithm>
#include <cstdint>
#include <glm/common.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#define TSR_INOUT(type) type&
#define TSR_LOOP shader_machine_round()
#define TSR_PREDICTED_TILES

namespace tessera::shaders {

using namespace glm;
using uint = std::uint32_t;

inline std::uint64_t shader_machine_rounds = 0;
inline void shader_machine_round() {
    ++shader_machine_rounds;
}

template <class Word> class Buffer {
public:
    void assign(std::size_t size, const Word& value) { words_.assign(size, value); }
    void set(std::vector<Word> words) { words_ = std::move(words); }
    [[gnu::always_inline]] Word& operator[](std::size_t at) {
        if (at >= words_.size())
            refuse(at);
        return words_[at];
    }
    int length() const { return static_cast<int>(words_.size()); }
    const std::vector<Word>& words() const { return words_; }
    // True if all words from `first` on equal `value`.
    bool holds(std::size_t first, const Word& value) const {
        return std::all_of(words_.begin() + static_cast<std::ptrdiff_t>(first), words_.end(),
                           [&](const Word& word) { return word == value; });
    }

private:
    [[noreturn, gnu::noinline]] void refuse(std::size_t at) const {
        throw std::out_of_range("word " + std::to_string(at) + " of " +
                                std::to_string(words_.size()));
    }
    std::vector<Word> words_;
};

inline Buffer<uint> tsr_tables, tsr_batch, tsr_work;
inline Buffer<uvec4> tsr_coefficients;
inline Buffer<uint> tsr_own, tsr_cross; // shared memory of levels.comp
inline Buffer<int> tsr_patch_memory;    // shared memory of texels.comp

inline uint TSR_ATOMIC_ADD(uint index, uint value) {
    const uint before = tsr_work[index];
    tsr_work[index] += value;
    return before;
}
inline void TSR_ATOMIC_OR(uint index, uint value) {
    tsr_work[index] |= value;
}

constexpr uint unpainted = 0xDEADDEADu; // not a sample, which has 16 bits

// The image that texels are written to.
struct Image {
    int width = 0, height = 0, layers = 0;
    std::vector<uvec4> pixels;
    std::uint64_t outside = 0;

    void resize(int w, int h, int l) {
        width = w, height = h, layers = l;
        outside = 0;
        pixels.assign(std::size_t(w) * h * l, uvec4(unpainted));
    }
    uvec4& at(int x, int y, int layer) {
        return pixels[(std::size_t(layer) * height + y) * width + x];
    }
};
inline Image image;
inline void tsr_write_texel(ivec3 at, uvec4 samples) {
    if (at.x < 0 || at.y < 0 || at.z < 0 || at.x >= image.width || at.y >= image.height ||
        at.z >= image.layers)
        ++image.outside;
    else
        image.at(at.x, at.y, at.z) = samples;
}

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

// Runs the passes of a batch, one invocation after another.
class Machine {
public:
    static constexpr uint stale = 0xA5A5A5A5u; // stands for what earlier work left in a buffer
    static constexpr std::size_t guard = 1024; // words after those that a batch uses

    std::uint64_t most_rounds = 0; // of one invocation
    std::uint32_t most_waves = 0;  // of one batch
    std::uint32_t most_steps = 0;  // of predictions from the border in one tile
    // When all invocations together have taken this many rounds, no more are started: damaged
    // batches can ask for more work than a test has time for.
    std::uint64_t patience = ~std::uint64_t{0};

    void load_tables(std::span<const std::uint32_t> words) {
        tsr_tables.set({words.begin(), words.end()});
    }

    void run(const DecodeBatch& batch) {
        decode_levels(batch);
        write_texels(batch);
    }

    // Passes 1 to 3.
    void decode_levels(const DecodeBatch& batch) {
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

    // Passes 4 to 7.
    void write_texels(const DecodeBatch& batch) {
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

    // The damage word of a tile in the batch.
    static uint damage(uint slot) { return tsr_work[tsr_state_at(slot) + tsr_st_damaged]; }

    // True if nothing was written beyond the words that the batch uses.
    static bool guards_hold(const DecodeBatch& batch) {
        return tsr_work.holds(batch.work_words, stale) &&
               tsr_coefficients.holds(batch.coefficients, uvec4(stale));
    }

    template <class Call> void invoke(Call call) {
        if (spent_ >= patience)
            return;
        shader_machine_rounds = 0;
        call();
        most_rounds = std::max(most_rounds, shader_machine_rounds);
        spent_ += shader_machine_rounds;
    }

private:
    void write_wave(const DecodeBatch& batch) {
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

    void predict_borders(uint tiles) {
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

    std::uint64_t spent_ = 0; // rounds
};

} // namespace tessera::shaders
