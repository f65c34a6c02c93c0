#include "tools/view/outside_colour.h"

#include "format/sampler.h"
#include "format/samples.h"
#include "tools/support/parse.h"

#include <cstddef>

namespace tessera {
namespace {

// The colour of tiles that are not stored.
glm::dvec3 background_of(const ContainerReader& container) {
    const TextureDesc& desc = container.desc();
    const FileFacts facts = container.facts();
    std::byte texel[8];
    for (std::size_t c = 0; c < 4; ++c)
        store_sample(texel + c * sample_bytes(desc.type), facts.background[c], desc.type);
    const glm::dvec4 value = texel_value(desc, texel);
    return desc.channels >= 3 ? glm::dvec3(value) : glm::dvec3(value.x);
}

} // namespace

Result<glm::dvec3> outside_colour(const ContainerReader& container) {
    const auto said = container.metadata().find("Background");
    if (said != container.metadata().end()) {
        glm::dvec3 colour{0.0};
        TESSERA_TRY(parse_point(said->second, colour)
                        .with_context(container.name() + ": the metadata key Background"));
        return colour;
    }
    return container.description().proxy == Proxy::mesh ? glm::dvec3(0.0)
                                                        : background_of(container);
}

} // namespace tessera
