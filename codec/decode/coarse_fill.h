// Coarse levels in place of tiles of level 0 that cannot be had.
#pragma once

#include "codec/decoder.h"
#include "codec/tile/tile_coding.h"
#include "codec/tile/tile_planes.h"

#include <map>
#include <memory>
#include <mutex>
#include <vector>

namespace tessera {

// The codings of a file's levels, finest first. Errors: invalid_file.
Result<std::vector<std::unique_ptr<TileCoding>>> level_codings(const ContainerReader& container);

// Thread-safe. Keeps some decoded tiles of coarse levels, at most 32 MiB of them.
class CoarseFill {
public:
    // All outlive it.
    CoarseFill(const ContainerReader& container, const ColourCoding& colour,
               const std::vector<std::unique_ptr<TileCoding>>& codings,
               const DecodeOptions& options)
        : container_(container), colour_(colour), codings_(codings), options_(options) {}

    // Whether `error`, that of loading or decoding `tile`, is one that the options let pass.
    bool may_fill(std::uint64_t tile, const Status& error) const;

    // Texels `box` of level 0, interpolated from the finest level that is there; the background where
    // none is. Errors: those of reading that may not be filled.
    Status fill(const Box4& box, std::span<std::byte> out) { return interpolate(0, box, out); }

    // Texels `box` of level `level`, which lies inside it; tiles that cannot be had are interpolated
    // like those of fill(). Brings the tiles together where requests are dear. Errors: as fill().
    Status texels_of(std::size_t level, const Box4& box, std::span<std::byte> out);

    // The texels of a tile of any level, as stored. Errors: those of loading and decoding it, naming it.
    Status decode(std::uint64_t tile, std::vector<std::byte>& texels) const;
    // The same errors without the texels: what decodes to levels has texels.
    Status check(std::uint64_t tile) const;

    // Remembers a tile of level 0 that was filled.
    void note(std::uint64_t tile);
    FillReport report() const;

private:
    // Calls use(decoder, payload, shape) -> Status for the tile; names it in errors.
    template <class Use> Status with_payload(std::uint64_t tile, const Use& use) const;
    using Texels = std::shared_ptr<const std::vector<std::byte>>;
    Status interpolate(std::size_t level, const Box4& box, std::span<std::byte> out);
    bool is_kept(std::uint64_t tile) const;
    // Null: the tile cannot be had.
    Result<Texels> tile_texels(std::size_t level, std::uint64_t number);
    void fill_background(std::span<std::byte> out) const;

    const ContainerReader& container_;
    const ColourCoding& colour_;
    const std::vector<std::unique_ptr<TileCoding>>& codings_;
    const DecodeOptions options_;

    mutable std::mutex mutex_; // of all below
    std::map<std::uint64_t, Texels> tiles_;
    std::uint64_t bytes_ = 0;              // of tiles_
    std::map<std::uint64_t, bool> filled_; // whether the tile had not been received
};

} // namespace tessera
