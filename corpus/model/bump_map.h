// The pictures of map_Bump statements: normals, as most exporters write them, or heights.
#pragma once

#include "corpus/model/model_builder.h"

#include <map>

namespace tessera::corpus {

class BumpMaps {
public:
    // Gives the material the normals of the picture. A bluish picture holds normals, of which
    // `scale` is the scale. Others hold heights: where they rise by their whole range over a texel,
    // the surface has the slope `scale`.
    void take(const std::string& picture, double scale, ModelBuilder& builder,
              ModelMaterial& material);
    // Says how many materials were taken to have which.
    void note(std::vector<std::string>& notes) const;

private:
    std::map<std::pair<int, double>, int> of_heights_; // images, from the image and the scale
    std::size_t heights_ = 0, normals_ = 0;            // materials
};

} // namespace tessera::corpus
