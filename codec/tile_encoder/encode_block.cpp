// One block of a tile: as it is, or on rotated colour axes, whichever is cheaper. The trellis is most of what
// encoding takes: what estimates already tell apart is not asked of it.
#include "codec/tile_encoder/colour_choice.h"
#include "codec/tile_encoder/tile_encoder.h"

#include <algorithm>
#include <optional>

namespace tessera {
namespace {

// Estimates are off by a tenth or so: one that is so many times another cost is the dearer way
// (codec/DECISIONS.md, "Efforts").
constexpr float clearly_more = 1.5f;
// Errors of two estimates of one block are alike, so these tell more.
constexpr float colours_apart = 1.15f;

} // namespace

// What is known of the block, and what it takes to know more.
class TileEncoder::BlockInHand {
public:
    BlockInHand(TileEncoder& encoder, BlockSearch& search, CodedBlocks& coded, const Block& block,
                const BlockPrediction& prediction)
        : encoder_(encoder), search_(search), coded_(coded), block_(block), prediction_(prediction),
          known_(coded.at(block, prediction)) {
        if (!prediction.copies())
            return;
        transform();
        coded.check(known_, encoder.coefficients_, encoder.coding_->planes);
    }

    // The rotation that gathers most energy; -1: none does.
    int rotation() {
        if (!known_.moments) {
            transform();
            const auto& plane = encoder_.coefficients_.plane;
            known_.moments = kept_moments({{plane[0].data(), plane[1].data(), plane[2].data()},
                                           static_cast<std::size_t>(block_.shape.texels())},
                                          encoder_.coding_->parameters);
        }
        return choose_rotation(*known_.moments, encoder_.last_rotation_ - 1);
    }

    float estimate(int colour) {
        CodedBlock::Way& way = this->way(colour);
        if (!way.estimate)
            way.estimate = search_.estimate(coefficients(colour));
        return *way.estimate;
    }

    // Its levels are in coded_ then. With energy: costs compare with those of other colours and copies.
    CodedBlock::Way code(int colour, bool with_energy) {
        CodedBlock::Way& way = this->way(colour);
        if (!way.is_coded) {
            const BlockCoefficients& block = coefficients(colour);
            way.planes = coded_.levels().planes.size();
            const float energy = with_energy ? encoder_.quantizer_.energy(block) : 0.0f;
            way.cost = encoder_.quantizer_.quantize(block, coded_.levels()) + energy;
            way.is_coded = true;
        }
        return way;
    }

private:
    CodedBlock::Way& way(int colour) {
        for (CodedBlock::Way& way : known_.ways)
            if (way.colour == colour)
                return way;
        known_.ways.emplace_back().colour = colour;
        return known_.ways.back();
    }

    void transform() {
        if (!is_transformed_)
            search_.transform_block(block_, prediction_, encoder_.decoded_, encoder_.coefficients_);
        is_transformed_ = true;
    }

    const BlockCoefficients& coefficients(int colour) {
        transform();
        if (colour == 0)
            return encoder_.coefficients_;
        if (rotated_to_ != colour)
            rotate_colours(encoder_.coefficients_, colour - 1, encoder_.rotated_);
        rotated_to_ = colour;
        return encoder_.rotated_;
    }

    TileEncoder& encoder_;
    BlockSearch& search_;
    CodedBlocks& coded_;
    const Block& block_;
    const BlockPrediction& prediction_;
    CodedBlock& known_;
    bool is_transformed_ = false;
    int rotated_to_ = 0; // the colour of encoder_.rotated_; 0: that of another block
};

float TileEncoder::encode_block(BlockSearch& search, CodedBlocks& coded, const Block& block,
                                const BlockPrediction& prediction, TileLevels& out, float limit) {
    BlockInHand hand(*this, search, coded, block, prediction);
    const bool rotates = coding_->rotates && settings_->rotate_colours;
    const auto take = [&](const CodedBlock::Way& chosen, float cost) {
        coded.append(chosen, coding_->planes, out);
        return cost;
    };
    // A block of zeros is not the same loss on rotated axes as on Y, Co and Cg, which are not
    // orthogonal: costs relative to it would not compare.
    const bool needs_energy = compares_ || rotates;
    bool tries_plain = true, tries_rotated = rotates;
    std::optional<int> rotation;
    // Without a trellis coding takes little more than estimates do.
    if (coding_->parameters.dependent && needs_energy) {
        rotation = rotates ? hand.rotation() : -1;
        const float plain = hand.estimate(0);
        const float rotated = *rotation < 0 ? unreachable_cost : hand.estimate(*rotation + 1);
        if (std::min(plain, rotated) > clearly_more * limit)
            return unreachable_cost;
        tries_plain = plain <= colours_apart * rotated;
        tries_rotated = rotated <= colours_apart * plain;
    }
    const auto take_plain = [&] {
        const CodedBlock::Way plain = hand.code(0, needs_energy);
        return take(plain, plain.cost);
    };
    float least = unreachable_cost;
    if (tries_plain) {
        const CodedBlock::Way plain = hand.code(0, needs_energy);
        if (coded.is_zero(plain, coding_->planes))
            return take_plain();
        least = plain.cost;
    }
    if (tries_rotated && !rotation)
        rotation = hand.rotation();
    if (!tries_rotated || *rotation < 0)
        return take_plain();
    const CodedBlock::Way rotated = hand.code(*rotation + 1, needs_energy);
    const auto& bits = costs_->colour[1];
    const float cost = rotated.cost + settings_->quantizer.lambda *
                                          (bits[*rotation + 1 == last_rotation_ ? 1 : 2] - bits[0]);
    // A block whose first plane is empty has no colour symbol.
    if (cost >= least || coded.first_plane(rotated).coded_length == 0)
        return take_plain();
    last_rotation_ = *rotation + 1;
    return take(rotated, cost);
}

} // namespace tessera
