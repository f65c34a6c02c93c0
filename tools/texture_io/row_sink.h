// A sink that receives whole rows of v in ascending order, for files that are written once from
// begin to end.
#pragma once

#include "tools/support/slab_buffer.h"

#include <string>

namespace tessera {

class RowSink : public TexelSink {
public:
    // `name`: of the output, for messages.
    RowSink(const TextureDesc& desc, std::string name) : desc_(desc), name_(std::move(name)) {}

    Locality locality() const final { return Locality::spatial_rows; }

    Status begin_slab(const Box4& box) final {
        if (!spans(box, desc_.size, axis_s, axis_t) || box.begin[axis_u] != 0 ||
            box.end[axis_u] != desc_.size[axis_u] || box.begin[axis_v] != next_v_)
            return {ErrorCode::runtime,
                    name_ + ": slab " + to_string(box) + " is not the next rows of v"};
        return slab_.reset(desc_, box).with_context(name_);
    }

    Status write(const Box4& box, std::span<const std::byte> texels) final {
        return slab_.copy_in(box, texels).with_context(name_);
    }

    Status end_slab() final {
        next_v_ = slab_.box().end[axis_v];
        return write_rows(slab_);
    }

    Status finish() final {
        if (next_v_ != desc_.size[axis_v])
            return {ErrorCode::runtime, name_ + ": rows are missing"};
        slab_.clear();
        return close();
    }

protected:
    virtual Status write_rows(SlabBuffer& slab) = 0;
    virtual Status close() = 0;
    const TextureDesc& desc() const { return desc_; }
    const std::string& name() const { return name_; }

private:
    TextureDesc desc_;
    std::string name_;
    SlabBuffer slab_;
    std::uint32_t next_v_ = 0;
};

} // namespace tessera
