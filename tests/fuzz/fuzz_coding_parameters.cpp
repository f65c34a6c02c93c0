// Section CODE must be refused or give valid parameters, which do not change when written and read
// again.
#include "format/tile/coding_parameters.h"
#include "tests/fuzz/fuzz_target.h"

namespace tessera::fuzz::coding_parameters {

std::vector<Bytes> seeds() {
    CodingParameters changed;
    changed.colour_rotation = true;
    changed.prediction = true;
    changed.smooth_copies = true;
    changed.base = {.on = true, .margin = 4, .v_against_u = true};
    changed.dependent = true;
    changed.correction_error = 3;
    changed.filter.ring[0][1] = {-5, 9};
    for (std::size_t i = 0; i < changed.parameters.size(); i += 7)
        changed.parameters[i] = static_cast<std::uint8_t>(i % 64);
    return {write_coding_parameters({}), write_coding_parameters(changed)};
}

void run(const std::uint8_t* data, std::size_t size) {
    const auto coding = read_coding_parameters({reinterpret_cast<const std::byte*>(data), size});
    if (!coding)
        return;
    const auto again = read_coding_parameters(write_coding_parameters(*coding));
    require(again && again->parameters == coding->parameters && again->step == coding->step &&
                again->filter == coding->filter && again->base == coding->base,
            "coding parameters change when written again");
    const CodeTables tables(coding->parameters);
    for (const std::uint16_t zero : tables.zero)
        require(zero >= 1 && zero <= 4095, "zero frequency out of range");
}

const Registered registered({.name = "fuzz_coding_parameters", .seeds = seeds, .run = run});

} // namespace tessera::fuzz::coding_parameters
