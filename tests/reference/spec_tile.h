// The payload, blocks and texels of one tile (FORMAT.md 3 and 4).
#pragma once

#include "tests/reference/spec_arithmetic.h"
#include "tests/reference/spec_container.h"

#include <array>
#include <map>
#include <optional>
#include <vector>

namespace tessera_reference::spec {

struct Segment {
    size_t first_block = 0;
    Bytes bytes;
};

struct Payload {
    std::vector<Segment> segments;
    std::vector<std::optional<Bytes>> corrections; // one per chunk
};

struct Coefficient {
    Vector4 k;
    int cost;
    int position;
    size_t where; // place(k, n)
};
using Scan = std::vector<Coefficient>;

struct Block {
    Vector4 begin; // in the tile, or in its base picture
    Vector4 size;
    bool of_base = false;
    std::optional<int> only_plane; // set if each plane has a split tree of its own
    bool copies_base = false;
    int mode = 0;                              // of a picture's block
    std::array<AxisTransform, 4> transforms{}; // of each axis
    int rotation = -1;                         // -1: not rotated
    std::optional<std::array<int, 2>> shares;  // a, b; set if predicted from luma
    std::optional<size_t> copies_along;        // 0 s, 1 t
    std::array<int, 2> displacement{};         // du, dv of a copy
    int depth = -1;                            // 4.6; -1: not known yet
    bool copies() const { return copies_along.has_value() || copies_base; }
    // The levels of each plane in scan order, as many as the coded length.
    std::array<std::vector<int32_t>, 4> levels;
};

// Reads the rest of the magnitude with token q. Levels and corrections use it.
int64_t read_magnitude(Stream& stream, int q);

class TileDecoder {
public:
    TileDecoder(const Header& header, const Code& code) : header_(header), code_(code) {}

    // Decodes the samples of a tile, in the order of part 2.
    std::vector<uint16_t> decode(Bytes bytes, const Vector4& size);

private:
    void read_split_tree(Stream& stream, const Vector4& begin, const Vector4& size, int a, int b,
                         bool of_base = false);
    void read_base_tree(Stream& stream);
    void read_tile_trees(Stream& stream);
    void begin_picture(const Vector4& size);
    void read_mode(Stream& stream, Block& block);
    int read_difference(Stream& stream, const Table& table);
    std::array<int64_t, 4> predicted_from_base(const Block& block, const Vector4& in_tile) const;
    void read_prediction(Stream& stream, Block& block);
    int depth_of(Block& block);
    std::array<int64_t, 4> predicted(const Block& block, const Vector4& at) const;
    std::vector<int64_t> predicted_from_border(const Block& block, size_t plane) const;
    void read_segment(Stream& stream, size_t begin, size_t end, int64_t work);
    struct ColourMemory;
    void read_colour(Stream& stream, Block& block, ColourMemory& memory);
    void read_transform(Stream& stream, Block& block);
    void read_plane(Stream& stream, Block& block, int plane, int length);
    const Scan& scan_of(const Vector4& n);
    bool is_in_picture(const Block& block) const {
        return block.of_base || size_[2] * size_[3] == 1;
    }
    void reconstruct(const Block& block);
    void fill_picture(const Block& block);
    void filter();
    void make_codes();
    int G() const { return header_.sample_type == 0 ? 4 : 0; } // fraction bits of values
    int64_t value_limit() const { return header_.sample_type == 0 ? 16384 : 262144; }
    void add_corrections(const Payload& payload);
    size_t texel_number(const Vector4& at) const { // part 2
        return static_cast<size_t>(((at[1] * size_[0] + at[0]) * size_[3] + at[3]) * size_[2] +
                                   at[2]);
    }

    const Header& header_;
    const Code& code_;
    std::map<Vector4, Scan> scans_;

    Vector4 size_{};
    std::vector<Block> blocks_;
    std::optional<int> plane_of_tree_; // of the tree that is read
    int64_t nodes_ = 0;
    bool last_block_copied_ = false; // counts only blocks with a prediction symbol
    bool has_base_ = false, last_copied_base_ = false;
    int last_base_displacement_ = 0;
    Vector4 base_size_{};
    // Of the picture that is read: the mode at each texel, by place().
    Vector4 picture_size_{};
    std::vector<int> mode_at_;
    // Of the picture that is reconstructed: the height of each column and the width of each row.
    std::vector<int> height_, width_;
    std::array<std::vector<int64_t>, 4> base_values_;
    std::array<std::array<std::array<int, 2>, 2>, 2>
        displacement_{}; // [direction][last, second to last]
    bool predicted_tile_ = false;
    std::array<std::vector<int64_t>, 4> plane_values_; // indexed by place() in the tile
    // Per plane, by place(): amplitude codes of the coefficients; -1 until a coefficient is
    // decoded.
    std::array<std::vector<int>, 4> amplitude_;
    // Codes in the texel order of part 2, with adjacent channels.
    std::vector<int64_t> codes_;
};

} // namespace tessera_reference::spec
