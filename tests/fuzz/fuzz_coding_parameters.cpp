// Section CODE must be refused or give valid parameters, which do not change when written and read
// again.
#include "format/tile/coding_parameters.h"
#include "tests/fuzz/fuzz_target.h"

namespace tessera::fuzz::coding_parameters {

namespace {

// The first byte of an input says which planes and features the file has.
int planes_of(int kind) {
    return 1 + kind % 4;
}
bool has_corrections(int kind) {
    return (kind & 4) != 0;
}

} // namespace

std::vector<Bytes> seeds() {
    CodingParameters changed;
    changed.colour_rotation = true;
    changed.prediction = true;
    changed.leaves_out_transforms = true;
    changed.transforms_any_plane = true;
    changed.smooth_copies = true;
    changed.base = {.on = true, .margin = 4, .v_against_u = true};
    changed.dependent = true;
    changed.correction_error = 3;
    changed.filter.ring[0][1] = {-5, 9};
    for (std::size_t i = 0; i < changed.parameters.size(); i += 7)
        changed.parameters[i] = static_cast<std::uint8_t>(i % 64);
    std::vector<Bytes> all;
    for (const int kind : {0, 1, 2, 7}) {
        changed.plane_trees = planes_of(kind) == 2;
        all.push_back(write_coding_parameters(kind == 0 ? CodingParameters() : changed,
                                              planes_of(kind), has_corrections(kind)));
        all.back().insert(all.back().begin(), static_cast<std::byte>(kind));
    }
    return all;
}

void run(const std::uint8_t* data, std::size_t size) {
    if (size == 0)
        return;
    const int planes = planes_of(data[0]);
    const bool corrections = has_corrections(data[0]);
    const std::span section(reinterpret_cast<const std::byte*>(data) + 1, size - 1);
    const auto coding = read_coding_parameters(section, planes, corrections);
    if (!coding)
        return;
    const auto again = read_coding_parameters(write_coding_parameters(*coding, planes, corrections),
                                              planes, corrections);
    require(again && again->parameters == coding->parameters && again->step == coding->step &&
                again->filter == coding->filter && again->base == coding->base,
            "coding parameters change when written again");
    const CodeTables tables(coding->parameters);
    for (const std::uint16_t zero : tables.zero)
        require(zero >= 1 && zero <= 4095, "zero frequency out of range");
}

const Registered registered({.name = "fuzz_coding_parameters", .seeds = seeds, .run = run});

} // namespace tessera::fuzz::coding_parameters
