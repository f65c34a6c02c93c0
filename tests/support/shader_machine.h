// Runs the decoder's shaders as C++. GLM supplies the types; this file supplies the buffers (with guard
// bands) and the passes, shader_machine.cpp the macros of shaders/dialect.glsl.
//
// Every access to a buffer is checked: an index out of range throws, which no shader may cause,
// whatever the bytes. The words that a batch uses are followed by a guard band, as if the buffer
// had been allocated for a larger batch, so that writes beyond the batch are detected, too. Every
// loop iteration is counted, and the largest count of one invocation is kept.
#pragma once

#include "decoder_glsl/batch/decode_batch.h"
#include "decoder_glsl/shaders/shader_layout.h"

#include <algorithm>
#include <cstdint>
#include <glm/common.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <stdexcept>
#include <string>
#include <vector>

namespace tessera::shaders {

using namespace glm;
using namespace layout;
using uint = std::uint32_t;

inline std::uint64_t shader_machine_rounds = 0; // of the invocation that runs

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

// Functions of the shaders that tests call.
uint tsr_table(int at);
int tsr_basis_of(int n);
int tsr_sine_basis_of(int n);
ivec4 tsr_sides_of(uint shape);
ivec4 tsr_origin_of(uint place);
uint tsr_state_at(uint tile);
uint tsr_block_at(uint tile, uint block);
void tsr_cut_tile(uint tile, uint lane);

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
    void decode_levels(const DecodeBatch& batch); // passes 1 to 3
    void write_texels(const DecodeBatch& batch);  // passes 4 to 7

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
    void write_wave(const DecodeBatch& batch);
    void predict_borders(uint tiles);

    std::uint64_t spent_ = 0; // rounds
};

} // namespace tessera::shaders
