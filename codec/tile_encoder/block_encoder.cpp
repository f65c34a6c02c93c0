#include "codec/tile_encoder/block_encoder.h"

#include "codec/tile_encoder/colour_choice.h"

#include <algorithm>
#include <optional>

namespace tessera {
namespace {

// The trellis takes most of the encoding time, so it does not run where estimates already decide.
// These are off by a tenth or so, so more than this factor decides (codec/DECISIONS.md, "Efforts").
constexpr float clearly_more = 1.5f;
// Estimates of one block with two colours err alike, so a smaller factor decides between them.
constexpr float colours_apart = 1.15f;

} // namespace

// What is known of the block, and the means to find out more.
class BlockEncoder::CurrentBlock {
public:
    CurrentBlock(BlockEncoder& encoder, BlockSearch& search, const Block& block,
                 const BlockPrediction& prediction, const TilePlanes& decoded)
        : encoder_(encoder), search_(search), block_(block), prediction_(prediction),
          decoded_(decoded), known_(encoder.coded_.at(block, prediction)) {
        if (!prediction.copies())
            return;
        transform();
        encoder.coded_.check(known_, encoder.plain_, encoder.coding_->planes);
    }

    // The rotation that gathers most energy; -1: none does.
    int rotation() {
        if (!known_.moments) {
            transform();
            const auto& plane = encoder_.plain_.plane;
            known_.moments = kept_moments({{plane[0].data(), plane[1].data(), plane[2].data()},
                                           static_cast<std::size_t>(block_.shape.texels())},
                                          encoder_.coding_->parameters);
        }
        return choose_rotation(*known_.moments, encoder_.last_rotation - 1);
    }

    float estimate(int colour) {
        CodedBlock::Way& way = this->way(colour);
        if (!way.estimate)
            way.estimate = search_.estimate(coefficients(colour));
        return *way.estimate;
    }

    // Puts the levels into encoder_.coded_. With energy, costs of different colours and copies
    // compare.
    CodedBlock::Way code(int colour, bool with_energy) {
        CodedBlock::Way& way = this->way(colour);
        if (!way.is_coded) {
            const BlockCoefficients& block = coefficients(colour);
            TileLevels& levels = encoder_.coded_.levels();
            way.planes = levels.planes.size();
            const float energy = with_energy ? encoder_.quantizer_.energy(block) : 0.0f;
            way.cost = encoder_.quantizer_.quantize(block, levels) + energy;
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
            search_.transform_block(block_, prediction_, decoded_, encoder_.plain_);
        is_transformed_ = true;
    }

    const BlockCoefficients& coefficients(int colour) {
        transform();
        if (colour != 0 && rotated_to_ != colour) {
            rotate_colours(encoder_.plain_, colour - 1, encoder_.rotated_);
            rotated_to_ = colour;
        }
        return encoder_.coefficients(colour);
    }

    BlockEncoder& encoder_;
    BlockSearch& search_;
    const Block& block_;
    const BlockPrediction& prediction_;
    const TilePlanes& decoded_;
    CodedBlock& known_;
    bool is_transformed_ = false;
    int rotated_to_ = 0; // the colour of encoder_.rotated_; 0: that of another block
};

float BlockEncoder::encode(BlockSearch& search, const Block& block,
                           const BlockPrediction& prediction, const TilePlanes& decoded,
                           TileLevels& out, float limit) {
    CurrentBlock hand(*this, search, block, prediction, decoded);
    const int planes = coding_->planes;
    const bool rotates = coding_->rotates && settings_->rotate_colours;
    // A block of zeros does not lose the same on rotated axes as on Y, Co and Cg, which are not
    // orthogonal, so costs relative to it would not compare.
    const bool needs_energy = compares_ || rotates;
    bool tries_plain = true, tries_rotated = rotates;
    std::optional<int> rotation;
    // Without a trellis coding takes little longer than estimating.
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
        coded_.append(plain, planes, out);
        return plain.cost;
    };
    float least = unreachable_cost;
    if (tries_plain) {
        const CodedBlock::Way plain = hand.code(0, needs_energy);
        if (coded_.is_zero(plain, planes))
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
                                          (bits[*rotation + 1 == last_rotation ? 1 : 2] - bits[0]);
    // A block whose first plane is empty has no symbol for its colour.
    if (cost >= least || coded_.first_plane(rotated).coded_length == 0)
        return take_plain();
    last_rotation = *rotation + 1;
    coded_.append(rotated, planes, out);
    return cost;
}

void BlockEncoder::encode_as(const BlockCoefficients& block, int colour, TileLevels& out) {
    out.clear();
    if (colour != 0) {
        rotate_colours(block, colour - 1, rotated_);
        quantizer_.quantize(rotated_, out);
        if (out.planes[0].coded_length != 0)
            return;
        out.clear();
    }
    quantizer_.quantize(block, out);
}

} // namespace tessera
