// A compressed texture that shaders sample: the host side of shaders/sample.glsl, for OpenGL 4.5.
//
// Two ways to be resident give the same picture:
//   on load      all tiles are decoded into an ordinary texture: fastest to sample, most memory;
//   on feedback  sampling marks the tiles that it touches, and update() decodes the missing ones into
//                a tile cache of fixed size; until then their coarse texels are drawn.
#pragma once

#include "decoder_glsl/shader_source.h"
#include "format/container_reader.h"

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace TESSERA_PUBLIC tessera {

enum class Residency { on_load, on_feedback };
const char* name_of(Residency residency); // "load", "feedback"

// A coarse level of the file (ContainerReader::levels()) and its texels: of that level's size, of the
// texture's type and channels, boxes in any order.
struct CoarseTexels {
    LevelEntry level;
    TexelSource* texels = nullptr; // used by create() only
};

struct SampledTextureOptions {
    Residency residency = Residency::on_feedback;
    std::uint64_t budget = 256ull << 20; // bytes on the device, all buffers; never exceeded
    // Let the texture unit mix angular neighbours; on feedback, those of one tile.
    bool hardware_filter = true;
    bool coarse = true; // on_feedback: draw coarse texels where tiles are missing
    // on_feedback: what the coarse texels are made from. Without texels here every tile is decoded
    // once for them, which reads the whole file.
    CoarseTexels coarse_from{};
    std::uint32_t jobs_per_update = 0; // on_feedback: tiles decoded at a time at most; 0: no limit
};

// The residency that suits a file and a budget: everything decoded where that fits, else a cache.
Residency choose_residency(const ContainerReader& reader, std::uint64_t budget);

// Bytes of all texels of a file in an ordinary texture, as on_load holds them.
std::uint64_t decoded_bytes(const ContainerReader& reader);

struct UpdateReport {
    std::uint32_t touched = 0; // tiles that the newest frame whose marks are known sampled
    std::uint32_t missing = 0; // of these: had no slot before this update, so the frame shows their
                               // coarse texels
    std::uint32_t decoded = 0; // tiles decoded now
    std::uint32_t waiting = 0; // tiles that found no slot, or wait for the next update
    bool current = false;      // the marks of the last frame were looked at, not only older ones
    // Why the bytes of some tiles could not be had now (of the source: io, or runtime when it was
    // interrupted); they wait, and the next frame that touches them asks again. Else ok.
    Status trouble;
};

// Sums over all frames; a tile counts once a frame however often it is touched.
struct TileCacheStats {
    std::uint64_t frames = 0;    // begin_frame()
    std::uint64_t hits = 0;      // tiles that were in a slot when first touched in a frame
    std::uint64_t decodes = 0;   // jobs given out
    std::uint64_t evictions = 0; // tiles that lost their slot to another
    std::uint64_t late = 0;      // tiles without a slot because the frame holds them all
    std::uint64_t deferred = 0;  // tiles without a slot because of max_jobs
    std::uint64_t failures = 0;  // tiles marked as failed
    std::uint64_t put_off = 0;   // tiles that lost their slot for the rest of a frame
};

// The passes, as they are timed apart.
enum class DecodeStage {
    upload,    // batch to the device
    entropy,   // trees, levels, corrections
    order,     // dequantisation and sorting
    transform, // inverse transform, filter, colour and writing the texels
};

// Called around each stage of a decode, for timing.
using StageHook = std::function<void(DecodeStage stage, bool begins)>;

// Needs a current OpenGL 4.5 context at every call, as its destructor does; one thread.
class SampledTexture {
public:
    // `reader` must outlive it. Errors: unsupported (the device lacks something: all of it is named;
    // the file is too large for the residency or the budget: with what would do), invalid_file, io.
    static Result<SampledTexture> create(const ContainerReader& reader,
                                         const SampledTextureOptions& options);
    // As on load, but the texels come from `source` (of the reader's size, type and channels, boxes in
    // any order), which is read here and not kept: what a renderer without this codec holds.
    // `budget` does not count. Errors: difference, where the source is of another kind; its own;
    // unsupported.
    static Result<SampledTexture> from_texels(const ContainerReader& reader, TexelSource& source,
                                              bool hardware_filter);
    SampledTexture(SampledTexture&&) noexcept;
    SampledTexture& operator=(SampledTexture&&) noexcept;
    ~SampledTexture();

    // Macros for shaders that include sample.glsl.
    std::vector<ShaderDefine> defines() const;
    // Binds what sample.glsl declares, at its default bindings.
    void bind() const;

    // Call once a frame after drawing, on feedback; otherwise it does nothing. Reads the marks of
    // finished frames, decodes missing tiles, and has the next frame marked anew. Without `wait` it
    // stalls only when three frames are unfinished: the marks may be those of one or two frames ago.
    // Tiles that a partial file does not hold stay coarse without an error.
    // Errors: invalid_file (tiles that are damaged, which stay coarse from then on; all else was done),
    // runtime. A source that fails is no error but UpdateReport::trouble.
    Result<UpdateReport> update(bool wait);
    // Forgets all cached tiles, as if nothing had been drawn.
    Status drop_cache();

    std::uint64_t bytes() const; // held on the device
    // Tiles found damaged so far; they are drawn as background. On feedback, only
    // updates that wait look for them, and create() where it decodes every tile.
    std::uint64_t damaged_tiles() const;
    std::uint64_t cache_slots() const; // on_feedback; else 0
    // on_feedback: a budget, in bytes, whose cache has a slot for each of `tiles`; else 0.
    std::uint64_t budget_for(std::uint64_t tiles) const;
    const TileCacheStats* cache_stats() const;
    void set_stage_hook(StageHook hook);

private:
    struct State;
    explicit SampledTexture(std::unique_ptr<State> state);
    static Result<std::unique_ptr<State>> prepare(const ContainerReader& reader,
                                                  const SampledTextureOptions& options);
    std::unique_ptr<State> state_;
};

// All tiles of a file in batches, decoded as often as one likes into memory that is used again for
// each batch: what decoding on load does without reading the file. For measuring. Needs a current
// OpenGL 4.5 context at every call, as its destructor does.
class WholeFileDecoder {
public:
    // Reads the file and decodes it once. Errors: invalid_file, where a tile is damaged; io, runtime;
    // unsupported, above 1 GiB of compressed tiles.
    static Result<WholeFileDecoder> create(const ContainerReader& reader);
    WholeFileDecoder(WholeFileDecoder&&) noexcept;
    WholeFileDecoder& operator=(WholeFileDecoder&&) noexcept;
    ~WholeFileDecoder();

    std::uint64_t blocks() const;       // of all tiles
    std::uint64_t coefficients() const; // that are not 0
    void set_stage_hook(StageHook hook);
    // Issues the work of all batches; `cancelled` is asked before each. Errors: runtime.
    Status decode(const std::function<bool()>& cancelled = {});

private:
    struct State;
    explicit WholeFileDecoder(std::unique_ptr<State> state);
    std::unique_ptr<State> state_;
};

} // namespace tessera
