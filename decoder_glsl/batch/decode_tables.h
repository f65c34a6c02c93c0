// The tables of a file for the shaders: the words of binding 0 (shaders/layout.glsl).
#pragma once

#include "format/container_reader.h"
#include "format/tile/base_picture.h"
#include "format/tile/block.h"
#include "format/tile/code_tables.h"
#include "format/tile/coding_parameters.h"

#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <vector>

namespace tessera {

// Immutable, so thread-safe.
class DecodeTables {
public:
    // Reads section CODE and computes the scan tables of every block shape that tiles of the file
    // can split into: 36 shapes and 2 MB if all tiles have one shape, at most 672 shapes and some
    // 15 MB. Errors: invalid_file (section CODE); unsupported (more than tsr_max_shapes shapes,
    // tables above 128 MiB).
    static Result<DecodeTables> make(const ContainerReader& reader);

    std::span<const std::uint32_t> words() const { return words_; }
    // `shape`: of a tile of the file's grid, or of its base picture.
    std::uint32_t shape_id(const BlockShape& shape) const { return ids_.at(shape); }
    unsigned planes() const { return planes_; }
    const CodeTables& code_tables() const { return *code_tables_; }
    bool has_corrections() const { return has_corrections_; }
    bool has_stored_tiles() const { return has_stored_tiles_; }
    bool predicts() const { return predicts_; }
    const BasePictures& base() const { return base_; }
    bool filters() const { return filters_; }
    // Whether tiles may keep their values in the work buffer, for copies or for the filter.
    bool keeps_values() const { return predicts_ || filters_; }
    // Words per texel of kept values (end of shaders/layout.glsl).
    unsigned value_words() const { return half_ ? planes_ : (planes_ + 1) / 2; }
    unsigned texel_bytes() const { return half_ ? 2 * planes_ : planes_; }

private:
    void add_shapes(const TileGrid& grid);
    void add_subtree(const BlockShape& shape);
    void add_shape(const BlockShape& shape, std::uint32_t id, const CodingParameters& coding,
                   SampleType type);
    void put_children(const BlockShape& shape, std::uint32_t* record) const;

    std::vector<std::uint32_t> words_;
    std::map<BlockShape, std::uint32_t> ids_;
    std::unique_ptr<const CodeTables> code_tables_;
    unsigned planes_ = 0;
    BasePictures base_;
    bool has_corrections_ = false, has_stored_tiles_ = false, predicts_ = false, filters_ = false,
         half_ = false;
};

} // namespace tessera
