#include "decoder_glsl/cache/cache_plan.h"

#include "decoder_glsl/shaders/shader_layout.h"

namespace tessera {

using namespace layout;

TexelPlan CachePlan::texel_plan() const {
    return {.stride_s = slot.stride_s, .stride_t = slot.stride_t};
}

TexelPlace CachePlan::place_of(std::uint32_t slot_number) const {
    const std::uint32_t line = slot_number / columns;
    return {.x = slot_number % columns * slot.width,
            .y = line % rows * slot.height,
            .layer = line / rows};
}

std::uint32_t CachePlan::page_of(std::uint32_t slot_number) const {
    const std::uint32_t line = slot_number / columns;
    return slot_number % columns | (line % rows << tsr_page_row_at) |
           (line / rows << tsr_page_layer_at);
}

std::uint64_t slots_across(const CacheSlot& slot) {
    return std::clamp(most_texture_side / slot.width, 1u, tsr_page_side);
}

std::optional<CachePlan> plan_cache(const CacheSlot& slot, std::uint64_t wanted,
                                    std::uint64_t most) {
    // Whole lines of equal length: rounded up where `most` allows it, else down.
    const std::uint64_t across = slots_across(slot);
    std::uint64_t lines = (wanted + across - 1) / across;
    const std::uint64_t columns = (wanted + lines - 1) / lines;
    if (lines * columns > most)
        lines = std::max<std::uint64_t>(most / columns, 1);
    const std::uint64_t rows = (lines + most_texture_side - 1) / most_texture_side;
    if (slot.width > most_texture_side || slot.height * rows > most_texture_side)
        return std::nullopt;
    return CachePlan{.slot = slot,
                     .columns = static_cast<std::uint32_t>(columns),
                     .rows = static_cast<std::uint32_t>(rows),
                     .layers = static_cast<std::uint32_t>(lines / rows)};
}

} // namespace tessera
