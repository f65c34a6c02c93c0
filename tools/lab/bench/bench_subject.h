// What `tessera bench gpu` draws: the texture of a file, or all of its layers, on the GPU.
#pragma once

#include "codec/decoder.h"
#include "decoder_glsl/gl_view_renderer.h"
#include "tools/view/layer_files.h"

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace tessera {

// The textures of a file: its own and, if it has layers, those. All objects that it refers to
// outlive it.
struct BenchFile {
    const Decoder* first = nullptr;
    std::vector<OpenLayerFile> layers;      // besides the first one
    const SurfaceMesh* mesh = nullptr;      // null: a sphere
    std::span<const DistantLight> lights{}; // of layers

    std::size_t textures() const { return 1 + layers.size(); }
    const Decoder& decoder(std::size_t texture) const {
        return texture == 0 ? *first : *layers[texture - 1].decoder;
    }
    const ContainerReader& reader(std::size_t texture) const {
        return decoder(texture).container();
    }
    std::uint64_t tiles() const;
    std::uint64_t decoded_bytes() const;
};

// The textures of a file on the device, and their renderer. Every call and the destructor need a
// current context.
class BenchSubject {
public:
    using MakeTextures = std::function<Result<std::vector<SampledTexture>>()>;
    // One texture is drawn as it is, several as the layers of the file. Errors: those of `make`;
    // invalid_file (a tile is damaged); runtime.
    static Result<BenchSubject> create(const BenchFile& file, const MakeTextures& make);
    BenchSubject(BenchSubject&&) noexcept = default;
    BenchSubject& operator=(BenchSubject&&) = delete;

    Status draw(const ViewCamera& camera) { return view_->draw(camera); }
    Result<std::vector<float>> read() const { return view_->read(); }

    struct Update {
        std::uint32_t touched = 0, decoded = 0, waiting = 0; // tiles of all textures
        double texels = 0;                                   // of the decoded tiles
    };
    // Calls SampledTexture::update() of all textures.
    Result<Update> update(bool wait);
    Status drop_cache();

    std::uint64_t bytes() const;
    std::uint64_t slots() const; // of all tile caches; 0: there are none
    Status check_damage() const; // invalid_file: a tile is damaged
    // A budget whose caches have a quarter more slots than the tiles that the last update touched.
    std::uint64_t roomy_budget() const;
    void set_stage_hook(const StageHook& hook);

private:
    BenchSubject(const BenchFile& file, std::vector<SampledTexture> textures)
        : file_(&file), textures_(std::move(textures)) {}

    // The order of the members makes the renderer die first.
    const BenchFile* file_;
    std::vector<SampledTexture> textures_;
    std::vector<std::uint64_t> touched_; // tiles of each, by the last update
    std::optional<GlViewRenderer> view_;
};

} // namespace tessera
