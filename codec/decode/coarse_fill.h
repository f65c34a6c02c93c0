// Shows coarse levels in place of tiles of level 0 that are missing or damaged.
#pragma once

#include "codec/decoder.h"
#include "codec/tile/tile_coding.h"
#include "codec/tile/tile_planes.h"

#include <map>
#include <memory>
#include <mutex>
#include <vector>

namespace tessera {

// The coding parameters of a file's levels, finest first. Errors: invalid_file.
Result<std::vector<std::unique_ptr<TileCoding>>> level_codings(const ContainerReader& container);

// Thread-safe. Keeps up to 32 MiB of decoded tiles of coarse levels.
class CoarseFill {
public:
    // All arguments must outlive it.
    CoarseFill(const ContainerReader& container, const ColourCoding& colour,
               const std::vector<std::unique_ptr<TileCoding>>& codings,
               const DecodeOptions& options)
        : container_(container), colour_(colour), codings_(codings), options_(options) {}

    // Whether the options allow filling `tile` after this error in loading or decoding it.
    bool may_fill(std::uint64_t tile, const Status& error) const;

    // The texels `box` of level 0, interpolated from the finest coarser level that is available, or
    // the background if none is. Errors: those of tiles that may not be filled.
    Status fill(const Box4& box, std::span<std::byte> out) { return interpolate(0, box, out); }

    // The texels `box` of level `level`, which contains it; unavailable tiles are interpolated as
    // in fill(). Fetches tiles together where each request is expensive. Errors: as fill().
    Status texels_of(std::size_t level, const Box4& box, std::span<std::byte> out);

    // Decodes a tile of any level. Errors: those of loading and decoding it, naming the tile.
    Status decode(std::uint64_t tile, std::vector<std::byte>& texels) const;
    // The same errors as decode(), but computes no texels: decoding cannot fail after the levels.
    Status check(std::uint64_t tile) const;

    // Counts a tile of level 0 as filled.
    void note(std::uint64_t tile);
    FillReport report() const;

private:
    // Calls use(decoder, payload, shape) -> Status for a tile and adds its name to errors.
    template <class Use> Status with_payload(std::uint64_t tile, const Use& use) const;
    using Texels = std::shared_ptr<const std::vector<std::byte>>;
    Status interpolate(std::size_t level, const Box4& box, std::span<std::byte> out);
    bool is_kept(std::uint64_t tile) const;
    // Null if the tile is not available and may be filled.
    Result<Texels> tile_texels(std::size_t level, std::uint64_t number);
    void fill_background(std::span<std::byte> out) const;

    const ContainerReader& container_;
    const ColourCoding& colour_;
    const std::vector<std::unique_ptr<TileCoding>>& codings_;
    const DecodeOptions options_;

    mutable std::mutex mutex_; // guards the members below
    std::map<std::uint64_t, Texels> tiles_;
    std::uint64_t bytes_ = 0;              // of tiles_
    std::map<std::uint64_t, bool> filled_; // value: whether the tile had not been received
};

} // namespace tessera
