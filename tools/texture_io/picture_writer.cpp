#include "format/output_file.h"
#include "tools/texture_io/picture_format.h"
#include "tools/texture_io/picture_io.h"
#include "tools/texture_io/picture_layout.h"

#include <vector>

namespace tessera {
namespace {

constexpr std::uint64_t max_held_bytes = 1ull << 30;

// Width and height in pixels.
std::pair<std::uint64_t, std::uint64_t> sides_of(const Extent4& n, const ViewLayout& layout) {
    if (layout.quilt)
        return {std::uint64_t{n[axis_u]} * layout.quilt->s,
                std::uint64_t{n[axis_v]} * layout.quilt->t};
    return {std::uint64_t{n[axis_u]} * n[axis_s], std::uint64_t{n[axis_v]} * n[axis_t]};
}

// Takes boxes in any order and writes the picture at the end. Precondition: check_picture_output().
class PictureSink : public TexelSink {
public:
    PictureSink(OutputFile file, const TextureDesc& desc, const ViewLayout& layout)
        : file_(std::move(file)), desc_(desc), size_(size_of(desc, layout)),
          layout_(desc.size, layout, size_.height),
          pixels_(std::size_t{size_.width} * size_.height * desc.texel_bytes()) {}

    Status write(const Box4& box, std::span<const std::byte> texels) override {
        TESSERA_TRY(check_box(desc_, box, texels.size()));
        const auto [top, bottom] = layout_.rows_of(box);
        const std::size_t texel = desc_.texel_bytes();
        for (std::uint32_t y = top; y < bottom; ++y)
            layout_.visit_row(y, box, [&](const Box4& part, std::uint32_t x) {
                std::byte* to = pixels_.data() + (std::size_t{y} * size_.width + x) * texel;
                copy_box(part, box, texels, part, {to, desc_.box_bytes(part)}, texel);
            });
        return {};
    }

    Status finish() override {
        TESSERA_TRY_ASSIGN(const auto bytes, encode_picture(picture_kind_of_name(file_.path()),
                                                            size_, desc_.type, pixels_)
                                                 .with_context(file_.path()));
        TESSERA_TRY(file_.append(bytes));
        return file_.commit();
    }

private:
    static PixelSize size_of(const TextureDesc& desc, const ViewLayout& layout) {
        const auto [width, height] = sides_of(desc.size, layout);
        return {static_cast<std::uint32_t>(width), static_cast<std::uint32_t>(height),
                desc.channels};
    }

    OutputFile file_;
    TextureDesc desc_;
    PixelSize size_;
    PictureLayout layout_;
    std::vector<std::byte> pixels_;
};

} // namespace

Status check_picture_output(const std::string& path, const TextureDesc& desc,
                            const ViewLayout& layout) {
    const std::uint64_t views = std::uint64_t{desc.size[axis_s]} * desc.size[axis_t];
    if (layout.quilt && layout.quilt->count() != views)
        return {ErrorCode::bad_argument, path + ": a quilt of " + to_string(*layout.quilt) +
                                             " has not one cell for each view of " +
                                             to_string(desc.size) + "; say --quilt"};
    TESSERA_TRY(check_picture_kind(picture_kind_of_name(path), desc.type, desc.channels)
                    .with_context(path));
    const auto [width, height] = sides_of(desc.size, layout);
    if (width > max_extent || height > max_extent ||
        width * height * desc.texel_bytes() > max_held_bytes)
        return {ErrorCode::unsupported, path + ": a picture of " + std::to_string(width) + "x" +
                                            std::to_string(height) +
                                            " pixels is too large; write views/ or .exr instead"};
    return {};
}

Result<std::unique_ptr<TexelSink>> create_picture(const std::string& path, const TextureDesc& desc,
                                                  const ViewLayout& layout) {
    TESSERA_TRY(check_picture_output(path, desc, layout));
    TESSERA_TRY_ASSIGN(auto file, OutputFile::create(path));
    return std::unique_ptr<TexelSink>(std::make_unique<PictureSink>(std::move(file), desc, layout));
}

} // namespace tessera
