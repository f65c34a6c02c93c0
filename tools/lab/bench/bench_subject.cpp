#ifdef TESSERA_GPU
#include "tools/lab/bench/bench_subject.h"

#include <algorithm>

namespace tessera {

std::uint64_t BenchFile::tiles() const {
    std::uint64_t sum = 0;
    for (std::size_t i = 0; i < textures(); ++i)
        sum += reader(i).grid().tiles();
    return sum;
}

std::uint64_t BenchFile::decoded_bytes() const {
    std::uint64_t sum = 0;
    for (std::size_t i = 0; i < textures(); ++i)
        sum += tessera::decoded_bytes(reader(i));
    return sum;
}

Result<BenchSubject> BenchSubject::create(const BenchFile& file, const MakeTextures& make) {
    TESSERA_TRY_ASSIGN(auto textures, make());
    BenchSubject subject(file, std::move(textures));
    TESSERA_TRY(subject.check_damage());
    const std::vector<SampledTexture>& own = subject.textures_;
    Result<GlViewRenderer> view = Status();
    if (own.size() > 1) {
        std::vector<ViewLayer> drawn;
        for (std::size_t i = 0; i < own.size(); ++i) {
            const Layers& layers = file.reader(0).layers();
            const Transfer transfer = file.reader(i).description().transfer;
            drawn.push_back(i == 0 ? ViewLayer{LayerRole::diffuse, layers.scale, transfer, &own[i]}
                                   : ViewLayer{file.layers[i - 1].info.role,
                                               file.layers[i - 1].info.scale, transfer, &own[i]});
        }
        view = GlViewRenderer::create(drawn, file.lights, *file.mesh);
    } else {
        view = file.mesh != nullptr ? GlViewRenderer::create(own[0], *file.mesh)
                                    : GlViewRenderer::create(own[0]);
    }
    TESSERA_TRY(view);
    subject.view_.emplace(std::move(*view));
    return subject;
}

Result<BenchSubject::Update> BenchSubject::update(bool wait) {
    Update sum;
    touched_.clear();
    for (std::size_t i = 0; i < textures_.size(); ++i) {
        TESSERA_TRY_ASSIGN(const UpdateReport own, textures_[i].update(wait));
        sum.touched += own.touched;
        sum.decoded += own.decoded;
        sum.waiting += own.waiting;
        const ContainerReader& reader = file_->reader(i);
        sum.texels += own.decoded * (static_cast<double>(texel_count(reader.desc().size)) /
                                     static_cast<double>(reader.grid().tiles()));
        touched_.push_back(own.touched);
    }
    return sum;
}

Status BenchSubject::drop_cache() {
    for (SampledTexture& texture : textures_)
        TESSERA_TRY(texture.drop_cache());
    return {};
}

std::uint64_t BenchSubject::bytes() const {
    std::uint64_t sum = 0;
    for (const SampledTexture& texture : textures_)
        sum += texture.bytes();
    return sum;
}

std::uint64_t BenchSubject::slots() const {
    std::uint64_t sum = 0;
    for (const SampledTexture& texture : textures_)
        sum += texture.cache_slots();
    return sum;
}

Status BenchSubject::check_damage() const {
    for (std::size_t i = 0; i < textures_.size(); ++i)
        if (textures_[i].damaged_tiles() > 0)
            return {ErrorCode::invalid_file,
                    file_->reader(i).name() + ": has damaged tiles; tessera validate lists them"};
    return {};
}

std::uint64_t BenchSubject::roomy_budget() const {
    std::uint64_t most = 0;
    for (std::size_t i = 0; i < touched_.size(); ++i)
        most = std::max(most, textures_[i].budget_for(std::min(touched_[i] + touched_[i] / 4 + 1,
                                                               file_->reader(i).grid().tiles())));
    return most;
}

void BenchSubject::set_stage_hook(const StageHook& hook) {
    for (SampledTexture& texture : textures_)
        texture.set_stage_hook(hook);
}

} // namespace tessera
#endif
