// The tables of a file for the shaders: the words of binding 0 (shaders/layout.glsl).
#pragma once

#include "format/container_reader.h"
#include "format/tile/base_picture.h"
#include "format/tile/block.h"
#include "format/tile/code_tables.h"
#include "format/tile/coding_parameters.h"

#include <algorithm>
#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <vector>

namespace tessera {

// How much memory scan tables may take: what the largest tile can need, or 2 MiB if that is less; or
// what all tiles need that are added.
enum class ScanMemory { bounded, unbounded };

// Not thread-safe: add_scans() and forget_scans() change words.
class DecodeTables {
public:
    // Reads section CODE and makes a record of every block shape that tiles of the file can split
    // into, hundreds if all tiles have one shape. Their scan tables, of up to 128 KiB each, could
    // take tens of MB, so add_scans() makes those that tiles need. Errors: invalid_file (section
    // CODE); unsupported (more than tsr_max_shapes shapes).
    static Result<DecodeTables> make(const ContainerReader& reader,
                                     ScanMemory memory = ScanMemory::bounded);

    // Makes the scan tables of block shapes, as far as they do not exist. Returns false if there is
    // no room for all of them, which cannot happen for the blocks of one tile after
    // forget_scans(). Appends words, and changes records of shapes.
    bool add_scans(std::span<const BlockShape> shapes);
    void forget_scans();

    std::span<const std::uint32_t> words() const { return words_; }
    // The number of words before the scan tables. The other words of a generation never change.
    std::size_t words_before_scans() const;
    unsigned generation() const { return generation_; } // number of calls of forget_scans()
    // What words().size() never exceeds; with unbounded memory, what it is now.
    std::size_t most_words() const { return std::max(words_.size(), most_words_); }

    // `shape`: of a tile of the file's grid, or of its base picture.
    std::uint32_t shape_id(const BlockShape& shape) const { return ids_.at(shape); }
    unsigned planes() const { return planes_; }
    const CodeTables& code_tables() const { return *code_tables_; }
    bool has_corrections() const { return has_corrections_; }
    bool has_stored_tiles() const { return has_stored_tiles_; }
    bool predicts() const { return predicts_; }
    bool plane_trees() const { return coding_.plane_trees; }
    const BasePictures& base() const { return base_; }
    bool filters() const { return filters_; }
    // Whether tiles may keep their values in the work buffer, for copies or for the filter.
    bool keeps_values() const { return predicts_ || filters_; }
    // Words per texel of kept values (end of shaders/layout.glsl).
    unsigned value_words() const { return half_ ? planes_ : (planes_ + 1) / 2; }
    unsigned texel_bytes() const { return half_ ? 2 * planes_ : planes_; }

private:
    void add_shapes(const TileGrid& grid);
    std::size_t room_for_scans(const TileGrid& grid) const; // words
    void add_subtree(const BlockShape& shape);
    void add_shape(const BlockShape& shape, std::uint32_t id, SampleType type);
    void put_children(const BlockShape& shape, std::uint32_t* record) const;

    std::vector<std::uint32_t> words_;
    std::size_t most_words_ = 0; // 0: unbounded
    unsigned generation_ = 0;
    std::map<BlockShape, std::uint32_t> ids_;
    CodingParameters coding_;
    std::unique_ptr<const CodeTables> code_tables_;
    unsigned planes_ = 0;
    BasePictures base_;
    bool has_corrections_ = false, has_stored_tiles_ = false, predicts_ = false, filters_ = false,
         half_ = false;
};

} // namespace tessera
