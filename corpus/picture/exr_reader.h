// One EXR picture as halves or floats.
#pragma once

#include "corpus/exr_stream.h"
#include "corpus/picture/exr_layers.h"
#include "corpus/picture_file.h"

#include <ImfInputPart.h>
#include <ImfMultiPartInputFile.h>
#include <ImfRgbaFile.h>
#include <glm/mat3x3.hpp>
#include <optional>

namespace tessera::corpus {

class ExrReader final : public PictureReader {
public:
    ExrReader(ByteSource& file, unsigned threads)
        : threads_(threads), stream_(file), converted_stream_(file) {}
    // `layer`: as in PictureOptions. Errors, like those of the other members, do not name the file,
    // except for io.
    Status open(const std::string& layer);

    std::string attribute(const std::string& name) const override;

    // The picture as light. Precondition: it has the size that check_size() accepts.
    Status read_light(LightImage& image);

private:
    Status read(SampleType type, std::uint32_t first, std::uint32_t last,
                const PictureRow& row) override;
    // Calls row(y, samples) with width * channels samples; `Sample` is float or holds a half's
    // bits.
    template <class Sample, class Row>
    Status read_as(std::uint32_t first, std::uint32_t last, const Row& row);
    // Lines of the data window, numbered as in the file.
    template <class Sample> void read_chunk(int first, int last, std::vector<Sample>& samples);
    void take_colours(const Imf::Header& header);
    void read_converted(int first, int last, std::vector<float>& samples);

    unsigned threads_;
    ExrInput stream_, converted_stream_;
    std::optional<Imf::MultiPartInputFile> file_;
    std::optional<Imf::InputPart> part_;
    std::optional<Imf::RgbaInputFile> converted_; // from luminance and chroma of lower resolution
    ExrLayer layer_;
    bool is_half_ = false;    // the file holds the samples that we give, as halves
    Imath::V3f luma_weights_; // of red, green and blue
    std::optional<glm::mat3> xyz_to_rgb_;
    glm::mat3 light_to_bt709_{1}; // for light, after xyz_to_rgb_
    Imath::Box2i window_;         // the pixels that the file has, in the coordinates of display_
    Imath::Box2i display_;        // the picture; 0 where window_ has no pixels
};

} // namespace tessera::corpus
