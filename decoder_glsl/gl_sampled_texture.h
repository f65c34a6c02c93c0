// A compressed texture on the device that shaders sample: the host's side of shaders/sample.glsl,
// for OpenGL 4.5.
//
// The texels of a file can be resident in two ways, which give the same picture:
//   on load      All tiles are decoded into a plain texture. Fastest to sample, needs most memory.
//   on feedback  Sampling marks the tiles that it touches, and update() decodes missing ones into a
//                tile cache of fixed size. Until then shaders draw the tile's coarse texels.
#pragma once

#include "decoder_glsl/shader_source.h"
#include "format/container_reader.h"
#include "format/surface_mesh.h"

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace TESSERA_PUBLIC tessera {

enum class Residency { on_load, on_feedback };
const char* name_of(Residency residency); // "load", "feedback"

// A coarse level of the file (ContainerReader::levels()) and its texels, which have the level's
// size and the texture's sample type and channels.
struct CoarseTexels {
    LevelEntry level;
    TexelSource* texels = nullptr; // create() reads boxes of it in any order and does not keep it
};

struct SampledTextureOptions {
    Residency residency = Residency::on_feedback;
    std::uint64_t budget = 256ull << 20; // bytes on the device, in all buffers; never exceeded
    // The texture unit mixes angular neighbours, on feedback those of one tile: 4 fetches per
    // sample instead of 16, with weights of 8 bits.
    bool hardware_filter = true;
    bool coarse = true; // on feedback: draw coarse texels where tiles are missing, else background
    // On feedback: the source of the coarse texels. Without texels here, create() reads the whole
    // file and decodes every tile once to compute them.
    CoarseTexels coarse_from{};
    std::uint32_t jobs_per_update = 0; // on feedback: most tiles decoded per update(); 0: no limit
    // Whose atlas the texture is, for layers, whose files have no mesh of their own. Null: the mesh
    // of the file. Only used while the texture is created.
    const SurfaceMesh* mesh = nullptr;
};

// The residency that suits a file and a budget in bytes: on_load if all texels fit, else
// on_feedback.
Residency choose_residency(const ContainerReader& reader, std::uint64_t budget);

// Bytes that all texels of a file take in a plain texture, as on_load holds them.
std::uint64_t decoded_bytes(const ContainerReader& reader);

// What update() found and did.
struct UpdateReport {
    std::uint32_t touched = 0; // tiles that the newest frame with known marks sampled
    std::uint32_t missing =
        0; // those of them that had no slot, so that the frame shows coarse texels
    std::uint32_t decoded = 0; // tiles that this update decoded
    std::uint32_t waiting = 0; // tiles that still have no slot: the cache is full, or see trouble
    bool current = false;      // the known marks are those of the last frame
    // The first error of tiles whose bytes the source could not give now: io, or runtime if it was
    // interrupted. The next frame that touches these tiles tries again. Ok if there is none.
    Status trouble;
};

// Stages of decoding that can be timed separately.
enum class DecodeStage {
    upload,    // the batch to the device
    entropy,   // split trees, levels, corrections
    order,     // dequantisation and sorting
    transform, // inverse transform, copies, filter, colour, and writing texels
};

// Called before (`begins`) and after each stage of a decode.
using StageHook = std::function<void(DecodeStage stage, bool begins)>;

// One of several textures that one program samples, such as the layers of a file.
struct SampledTextureRequest {
    const ContainerReader* reader = nullptr;
    SampledTextureOptions options; // `budget` is not used
};

// Every call and the destructor need a current OpenGL 4.5 context. Not thread-safe.
class SampledTexture {
public:
    // `reader` must outlive the texture. Errors: unsupported (the device lacks something, all of
    // which the message names; or the file is too large for the residency or the budget, and the
    // message says what suffices), invalid_file, io, runtime.
    static Result<SampledTexture> create(const ContainerReader& reader,
                                         const SampledTextureOptions& options);
    // Textures that one program samples (TESSERA_TEXTURES), in the order in which it numbers them.
    // Their options have the same residency and hardware_filter. The budget is for all of them: plain
    // textures take what they need, and tile caches get shares that grow with decoded_bytes().
    // Errors: bad_argument (the options differ, or there are no files or more than 64), and those
    // above.
    static Result<std::vector<SampledTexture>> create(std::span<const SampledTextureRequest> files,
                                                      std::uint64_t budget);
    // The same plain texture as on_load, but of texels from `source`, for comparisons with textures
    // that are not compressed. `source` has the reader's size, type and channels; it is read in
    // boxes of any order and not kept. No budget applies. Errors: difference (the source has
    // another size or type); those of the source; unsupported; runtime.
    static Result<SampledTexture> from_texels(const ContainerReader& reader, TexelSource& source,
                                              bool hardware_filter);
    SampledTexture(SampledTexture&&) noexcept;
    SampledTexture& operator=(SampledTexture&&) noexcept;
    ~SampledTexture();

    // The macros that shaders define before they include sample.glsl.
    std::vector<ShaderDefine> defines() const;
    // Binds the buffers and the texture of sample.glsl at its default bindings. `number` is that of
    // the texture where TESSERA_TEXTURES says that there are several.
    void bind(unsigned number = 0) const;

    // Call it once per frame, after drawing. It has no effect unless the texture is resident on
    // feedback. It reads the marks of finished frames, decodes missing tiles, and clears the marks
    // for the next frame. Without `wait` it reads marks of one or two frames ago and stalls only if
    // three frames are unfinished; with `wait` it waits for the last frame's marks. Tiles that a
    // partial file does not contain stay coarse without an error. Errors: invalid_file (damaged
    // tiles, which stay coarse; everything else was done), runtime. If the source fails, that is
    // not an error but UpdateReport::trouble.
    Result<UpdateReport> update(bool wait);
    // Empties the cache and forgets all marks.
    Status drop_cache();

    std::uint64_t bytes() const; // on the device
    // Number of tiles found damaged so far; they are drawn as background. On feedback, only
    // create(), where it decodes every tile, and updates that wait look for them.
    std::uint64_t damaged_tiles() const;
    std::uint64_t cache_slots() const; // on feedback: tiles that fit the cache; else 0
    // On feedback: a budget in bytes whose cache has a slot for each of `tiles` tiles; else 0. It is
    // the budget of all textures that were created together.
    std::uint64_t budget_for(std::uint64_t tiles) const;
    void set_stage_hook(StageHook hook);

private:
    struct State;
    explicit SampledTexture(std::unique_ptr<State> state);
    static Result<std::unique_ptr<State>> prepare(const ContainerReader& reader,
                                                  const SampledTextureOptions& options);
    static Result<std::vector<SampledTexture>>
    create_plain(std::span<const SampledTextureRequest> files, std::uint64_t budget);
    static Result<std::vector<SampledTexture>>
    create_cached(std::span<const SampledTextureRequest> files, std::uint64_t budget);
    std::unique_ptr<State> state_;
};

// Decodes all tiles of a file, as often as the caller likes, for measuring. It holds the compressed
// tiles in memory and decodes every batch into the same texture. Every call and the destructor need
// a current OpenGL 4.5 context.
class WholeFileDecoder {
public:
    // Reads the file and decodes it once. Errors: invalid_file (a tile is damaged), io, runtime,
    // unsupported (more than 1 GiB of compressed tiles).
    static Result<WholeFileDecoder> create(const ContainerReader& reader);
    WholeFileDecoder(WholeFileDecoder&&) noexcept;
    WholeFileDecoder& operator=(WholeFileDecoder&&) noexcept;
    ~WholeFileDecoder();

    std::uint64_t blocks() const;       // in all tiles
    std::uint64_t coefficients() const; // that are not 0, in all tiles
    void set_stage_hook(StageHook hook);
    // Issues the work of all batches. Errors: runtime (also if `cancelled`, which is called before
    // each batch, returns true).
    Status decode(const std::function<bool()>& cancelled = {});

private:
    struct State;
    explicit WholeFileDecoder(std::unique_ptr<State> state);
    std::unique_ptr<State> state_;
};

} // namespace tessera
