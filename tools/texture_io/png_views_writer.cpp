#include "format/output_file.h"
#include "format/work.h"
#include "tools/picture/png_file.h"
#include "tools/support/description_text.h"
#include "tools/support/parse.h"
#include "tools/support/slab_buffer.h"
#include "tools/texture_io/png_views_io.h"

#include <cstring>
#include <filesystem>
#include <nlohmann/json.hpp>

namespace tessera {
namespace {

namespace fs = std::filesystem;

// Nothing is lost by replacing `folder`: it is not there, empty, or all of it was written by us.
Status check_replaceable(const std::string& folder) {
    std::error_code error;
    const fs::file_status status = fs::status(folder, error);
    if (!fs::exists(status))
        return {};
    if (!fs::is_directory(status))
        return {ErrorCode::io, folder + ": exists and is not a folder"};
    bool ours = false;
    std::string stranger;
    for (fs::directory_iterator i(folder, error), end; !error && i != end; i.increment(error)) {
        const std::string name = i->path().filename().string();
        std::uint32_t s = 0, t = 0;
        if (name == "tessera.json")
            ours = true;
        else if (!parse_view_file_name(name, s, t))
            stranger = name;
    }
    if (error)
        return {ErrorCode::io, folder + ": " + error.message()};
    if (!stranger.empty())
        return {ErrorCode::io, folder + ": holds a file that is no view (" + stranger +
                                   "); choose an empty or a new folder"};
    if (!ours && !fs::is_empty(folder, error))
        return {ErrorCode::io, folder + ": holds views but no tessera.json, so they are not ours "
                                        "to replace; choose an empty or a new folder"};
    return {};
}

class PngViewsSink : public TexelSink {
public:
    PngViewsSink(std::string folder, const TextureDesc& desc, const Description& description,
                 unsigned threads)
        : folder_(std::move(folder)), desc_(desc), description_(description), threads_(threads) {}

    Status open() {
        TESSERA_TRY(check_replaceable(folder_));
        TESSERA_TRY_ASSIGN(output_, OutputFolder::create(folder_));
        return {};
    }

    Locality locality() const override { return Locality::angular_cells; }

    Status begin_slab(const Box4& box) override {
        if (!spans(box, desc_.size, axis_u, axis_v))
            return {ErrorCode::runtime,
                    folder_ + ": slab " + to_string(box) + " does not hold whole views"};
        return slab_.reset(desc_, box).with_context(folder_);
    }

    Status write(const Box4& box, std::span<const std::byte> texels) override {
        return slab_.copy_in(box, texels).with_context(folder_);
    }

    Status end_slab() override {
        const Box4& box = slab_.box();
        const Extent4 e = box.extent();
        const std::uint64_t count = std::uint64_t{e[axis_s]} * e[axis_t];
        TESSERA_TRY(parallel_for(count, threads_, [&](std::uint64_t i) {
            return write_view(box.begin[axis_s] + static_cast<std::uint32_t>(i % e[axis_s]),
                              box.begin[axis_t] + static_cast<std::uint32_t>(i / e[axis_s]));
        }));
        written_ += count;
        return {};
    }

    Status finish() override {
        slab_.clear();
        if (written_ != std::uint64_t{desc_.size[axis_s]} * desc_.size[axis_t])
            return {ErrorCode::runtime, folder_ + ": views are missing"};
        TESSERA_TRY(write_json());
        TESSERA_TRY(check_replaceable(folder_)); // minutes may have passed
        return output_.commit();
    }

private:
    Status write_view(std::uint32_t s, std::uint32_t t) {
        const PngShape shape{desc_.size[axis_u], desc_.size[axis_v], desc_.channels};
        const std::size_t texel = desc_.texel_bytes();
        std::vector<std::byte> pixels(shape.row_bytes() * shape.height);
        std::byte* to = pixels.data();
        for (std::uint32_t v = 0; v < desc_.size[axis_v]; ++v)
            for (std::uint32_t u = 0; u < desc_.size[axis_u]; ++u, to += texel)
                std::memcpy(to, slab_.texel(u, v, s, t), texel);
        TESSERA_TRY_ASSIGN(const auto png, encode_png(shape, pixels).with_context(folder_));
        return output_.add(view_file_name(s, t), png);
    }

    Status write_json() const {
        nlohmann::json json = {{"format", "tessera views"},
                               {"size", to_string(desc_.size)},
                               {"type", name_of(desc_.type)},
                               {"channels", desc_.channels},
                               {"description", description_to_text(description_)}};
        const std::string text = json.dump(2) + "\n";
        return output_.add("tessera.json", std::as_bytes(std::span(text)));
    }

    std::string folder_;
    OutputFolder output_;
    TextureDesc desc_;
    Description description_;
    unsigned threads_;
    std::uint64_t written_ = 0;
    SlabBuffer slab_;
};

} // namespace

Result<std::unique_ptr<TexelSink>> create_png_views(const std::string& folder,
                                                    const TextureDesc& desc,
                                                    const Description& description,
                                                    unsigned threads) {
    TESSERA_TRY(check_desc(desc).with_context(folder));
    if (desc.type != SampleType::unorm8)
        return Status(ErrorCode::unsupported,
                      folder + ": PNG views hold 8 bits, this texture is half float; write EXR "
                               "instead");
    auto sink = std::make_unique<PngViewsSink>(folder, desc, description, threads);
    TESSERA_TRY(sink->open());
    return std::unique_ptr<TexelSink>(std::move(sink));
}

} // namespace tessera
