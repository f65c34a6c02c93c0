#include "tools/texture_io/png_picture_io.h"

#include "tools/picture/png_file.h"
#include "tools/support/slab_buffer.h"

#include <cstring>

namespace tessera {
namespace {

class PngPictureSource : public TexelSource {
public:
    PngPictureSource(std::unique_ptr<ByteSource> file, const PngShape& shape,
                     const TextureDesc& desc)
        : file_(std::move(file)), shape_(shape), desc_(desc) {}

    const TextureDesc& desc() const override { return desc_; }
    Locality locality() const override { return Locality::spatial_rows; }

    // A PNG begins at the top each time.
    Status begin_slab(const Box4& box) override {
        TESSERA_TRY(slab_.reset(desc_, box).with_context(file_->name()));
        const std::uint32_t first = box.begin[axis_v] * desc_.size[axis_t];
        return read_png(*file_, shape_, box.end[axis_v] * desc_.size[axis_t],
                        [&](std::uint32_t y, std::span<const std::byte> row) {
                            if (y >= first)
                                store_row(y, row);
                        });
    }

    Status read(const Box4& box, std::span<std::byte> out) override {
        return slab_.copy_out(box, out).with_context(file_->name());
    }

private:
    void store_row(std::uint32_t y, std::span<const std::byte> row) {
        const Box4& box = slab_.box();
        const std::uint32_t v = y / desc_.size[axis_t], t = y % desc_.size[axis_t];
        const std::uint32_t s = box.begin[axis_s], count = box.end[axis_s] - s;
        if (t < box.begin[axis_t] || t >= box.end[axis_t])
            return;
        for (std::uint32_t u = box.begin[axis_u]; u < box.end[axis_u]; ++u) {
            const std::size_t x = std::size_t{u} * desc_.size[axis_s] + s;
            std::memcpy(slab_.texel(u, v, s, t), row.data() + x * desc_.channels,
                        std::size_t{count} * desc_.channels);
        }
    }

    std::unique_ptr<ByteSource> file_;
    PngShape shape_;
    TextureDesc desc_;
    SlabBuffer slab_;
};

} // namespace

Result<std::unique_ptr<TexelSource>> open_png_picture(std::unique_ptr<ByteSource> file,
                                                      const TextureHints& hints) {
    const std::string name = file->name();
    TESSERA_TRY_ASSIGN(const auto shape, read_png_shape(*file));
    if (hints.type.value_or(SampleType::unorm8) != SampleType::unorm8)
        return Status(ErrorCode::bad_argument, name + ": a PNG picture is 8-bit");
    TextureDesc desc;
    desc.channels = shape.channels;
    desc.size = hints.size.value_or(Extent4{shape.width, shape.height, 1, 1});
    TESSERA_TRY(check_desc(desc).with_context(name));
    const std::uint64_t width = std::uint64_t{desc.size[axis_u]} * desc.size[axis_s];
    const std::uint64_t height = std::uint64_t{desc.size[axis_v]} * desc.size[axis_t];
    if (width != shape.width || height != shape.height)
        return Status(ErrorCode::bad_argument,
                      name + ": a mosaic of " + to_string(desc.size) + " has " +
                          std::to_string(width) + "x" + std::to_string(height) +
                          " pixels, the picture " + std::to_string(shape.width) + "x" +
                          std::to_string(shape.height));
    return std::unique_ptr<TexelSource>(
        std::make_unique<PngPictureSource>(std::move(file), shape, desc));
}

} // namespace tessera
