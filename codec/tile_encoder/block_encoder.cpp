#include "codec/tile_encoder/block_encoder.h"

#include "codec/tile_encoder/colour_choice.h"

#include <algorithm>
#include <utility>

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
                 const BlockPrediction& prediction, const TilePlanes* decoded)
        : encoder_(encoder), search_(search), block_(block), prediction_(prediction),
          decoded_(decoded), known_(encoder.coded_.at(block, prediction)),
          has_colours_(encoder.coding_->rotates && encoder.settings_->rotate_colours) {
        if (!prediction.copies())
            return;
        transform();
        encoder.coded_.check(known_, encoder.plain_, encoder.coding_->planes);
    }
    // A block whose coefficients are known.
    CurrentBlock(BlockEncoder& encoder, BlockSearch& search, const Block& block,
                 const BlockPrediction& prediction, const KnownBlock& known)
        : CurrentBlock(encoder, search, block, prediction, nullptr) {
        std::swap(encoder.plain_, *known.coefficients);
        is_transformed_ = true;
        way({}).estimate = known.estimate;
    }

    bool has_colours() const { return has_colours_; }

    // A block of zeros does not lose the same on rotated axes as on Y, Co and Cg, which are not
    // orthogonal, so costs relative to it would not compare.
    bool needs_energy() const { return encoder_.compares_ || has_colours_; }

    // The rotation that gathers most energy; plain: none does.
    BlockColour rotation() {
        if (!known_.moments) {
            transform();
            const auto& plane = encoder_.plain_.plane;
            known_.moments = kept_moments({{plane[0].data(), plane[1].data(), plane[2].data()},
                                           static_cast<std::size_t>(block_.shape.texels())},
                                          encoder_.coding_->parameters);
        }
        const int rotation = choose_rotation(*known_.moments, encoder_.memory.last.rotation - 1);
        return {.rotation = static_cast<std::uint8_t>(rotation + 1), .share = {}};
    }

    // How luma predicts the chroma of a block that was coded plain.
    LumaFit fit_chroma() {
        transform();
        return encoder_.quantizer_.fit_chroma(encoder_.plain_, encoder_.coded_.levels(),
                                              way({}).planes);
    }

    float estimate(const BlockColour& colour) {
        CodedBlock::Way& way = this->way(colour);
        if (!way.estimate)
            way.estimate = search_.estimate(coefficients(colour));
        return *way.estimate;
    }

    // Codes the block with this colour, and keeps that if it costs less than all before.
    void offer(const BlockColour& colour) {
        const CodedBlock::Way way = code(colour);
        const bool has_symbol = has_colours_ && has_luma(way);
        // A block whose first plane is empty has no symbol for its colour.
        if (!colour.is_plain() && !has_symbol)
            return;
        const float cost = way.cost + (has_symbol ? encoder_.settings_->quantizer.lambda *
                                                        encoder_.colour_bits(colour)
                                                  : 0.0f);
        if (cost < least_) {
            least_ = cost;
            best_ = way;
        }
    }
    bool is_zero() const { return encoder_.coded_.is_zero(best_, encoder_.coding_->planes); }
    bool has_luma() const { return has_luma(best_); }
    // Appends the levels of the cheapest colour. Returns their cost.
    float take(TileLevels& out) {
        encoder_.coded_.append(best_, encoder_.coding_->planes, out);
        if (has_colours_ && has_luma())
            encoder_.memory.remember(best_.colour);
        return least_;
    }

private:
    bool has_luma(const CodedBlock::Way& way) const {
        return encoder_.coded_.first_plane(way).coded_length != 0;
    }

    // Puts the levels into encoder_.coded_. With energy, costs of different colours and copies
    // compare.
    CodedBlock::Way code(const BlockColour& colour) {
        if (const CodedBlock::Way& known = way(colour); known.is_coded)
            return known;
        const BlockCoefficients& block = coefficients(colour);
        const float energy = needs_energy() ? encoder_.quantizer_.energy(block) : 0.0f;
        TileLevels& levels = encoder_.coded_.levels();
        const std::size_t first_plane = levels.planes.size();
        BlockQuantizer::Cost cost;
        if (colour.predicts_chroma()) {
            const CodedBlock::Way& plain = way({});
            cost =
                encoder_.quantizer_.quantize_chroma(block, plain.planes, plain.luma_cost, levels);
        } else {
            cost = encoder_.quantizer_.quantize(block, levels);
        }
        CodedBlock::Way& coded = way(colour);
        coded.planes = first_plane;
        coded.cost = cost.all + energy;
        coded.luma_cost = cost.luma;
        coded.is_coded = true;
        return coded;
    }

    CodedBlock::Way& way(const BlockColour& colour) {
        for (CodedBlock::Way& way : known_.ways)
            if (way.colour == colour)
                return way;
        known_.ways.emplace_back().colour = colour;
        return known_.ways.back();
    }

    void transform() {
        if (!is_transformed_)
            search_.transform_block(block_, prediction_, *decoded_, encoder_.plain_);
        is_transformed_ = true;
    }

    const BlockCoefficients& coefficients(const BlockColour& colour) {
        transform();
        if (!colour.is_plain() && coloured_as_ != colour) {
            if (colour.is_rotated()) {
                rotate_colours(encoder_.plain_, colour.rotation - 1, encoder_.coloured_);
            } else {
                const CodedBlock::Way plain = way({});
                encoder_.quantizer_.predict_chroma(encoder_.plain_, colour,
                                                   encoder_.coded_.levels(), plain.planes,
                                                   encoder_.coloured_);
            }
            coloured_as_ = colour;
        }
        return encoder_.coefficients(colour);
    }

    BlockEncoder& encoder_;
    BlockSearch& search_;
    const Block& block_;
    const BlockPrediction& prediction_;
    const TilePlanes* const decoded_; // null if nothing is copied
    CodedBlock& known_;
    const bool has_colours_;
    float least_ = unreachable_cost; // cost of the cheapest colour so far
    CodedBlock::Way best_;
    bool is_transformed_ = false;
    BlockColour coloured_as_; // the colour of encoder_.coloured_; plain: that of another block
};

float BlockEncoder::encode(BlockSearch& search, const Block& block,
                           const BlockPrediction& prediction, const TilePlanes& decoded,
                           TileLevels& out, float limit) {
    CurrentBlock current(*this, search, block, prediction, &decoded);
    return encode(current, out, limit);
}

float BlockEncoder::encode(BlockSearch& search, const Block& block,
                           const BlockPrediction& prediction, const KnownBlock& known,
                           TileLevels& out, float limit) {
    CurrentBlock current(*this, search, block, prediction, known);
    return encode(current, out, limit);
}

float BlockEncoder::encode(CurrentBlock& current, TileLevels& out, float limit) {
    const bool colours = current.has_colours();
    // Without a trellis coding takes little longer than estimating, and shares of luma would save
    // 1 % for a third of the time.
    const bool estimates = coding_->parameters.dependent && current.needs_energy();
    bool tries_rotated = colours;
    BlockColour rotated;
    float rotated_estimate = unreachable_cost;
    if (estimates) {
        const float plain_estimate = current.estimate({});
        if (colours)
            rotated = current.rotation();
        if (rotated.is_rotated())
            rotated_estimate = current.estimate(rotated);
        if (std::min(plain_estimate, rotated_estimate) > clearly_more * limit)
            return unreachable_cost;
        tries_rotated = rotated_estimate <= colours_apart * plain_estimate;
    }
    current.offer({}); // its luma is needed to predict chroma
    if (current.is_zero())
        return current.take(out);
    if (estimates && colours && settings_->chroma_from_luma && current.has_luma()) {
        const BlockColour shares = best_shares(current.fit_chroma());
        if (shares.predicts_chroma()) {
            const float estimate = current.estimate(shares);
            if (!tries_rotated || estimate <= colours_apart * rotated_estimate)
                current.offer(shares);
            tries_rotated = tries_rotated && rotated_estimate <= colours_apart * estimate;
        }
    }
    if (tries_rotated && !estimates)
        rotated = current.rotation();
    if (tries_rotated && rotated.is_rotated())
        current.offer(rotated);
    return current.take(out);
}

// The shares, of a block's own or as before, that save most; none if none saves more than its bits.
BlockColour BlockEncoder::best_shares(const LumaFit& fit) const {
    const float lambda = settings_->quantizer.lambda;
    BlockColour best;
    float most = -lambda * colour_bits({});
    for (const BlockColour& colour :
         {fit.colour, BlockColour{.rotation = 0, .share = memory.share}})
        if (const float gain = fit.gain(colour) - lambda * colour_bits(colour);
            colour.predicts_chroma() && gain > most) {
            most = gain;
            best = colour;
        }
    return best;
}

float BlockEncoder::colour_bits(const BlockColour& colour) const {
    const int kind = memory.kind_of(colour);
    float bits = costs_->colour[memory.context][kind];
    if (kind == colour_from_luma)
        for (std::size_t c = 0; c < 2; ++c)
            bits += costs_->share[c][difference_token(colour.share[c] - memory.share[c])];
    return bits;
}

void BlockEncoder::encode_as(const BlockCoefficients& block, const BlockColour& colour,
                             TileLevels& out) {
    out.clear();
    if (colour.is_rotated()) {
        rotate_colours(block, colour.rotation - 1, coloured_);
        quantizer_.quantize(coloured_, out);
        if (out.planes[0].coded_length != 0)
            return;
        out.clear();
    }
    const float luma_cost = quantizer_.quantize_luma(block, out);
    const bool predicts = colour.predicts_chroma() && out.planes[0].coded_length != 0;
    if (predicts)
        quantizer_.predict_chroma(block, colour, out, 0, coloured_);
    quantizer_.quantize_others(predicts ? coloured_ : block, 0, luma_cost, out);
}

} // namespace tessera
